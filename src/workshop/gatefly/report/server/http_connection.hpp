// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

#include "gatefly/report/server/http_listener.hpp"

namespace gatefly::server {

/// Reads one request from a socket, answers it, and lets the client read the answer. Whatever the
/// client does, it takes a bounded time; a socket that is shut down ends it at once.
/// @param asking  false once the request is read.
void serve(int socket, const HttpListener::Answerer& answerer, std::atomic<bool>& asking);

}  // namespace gatefly::server
