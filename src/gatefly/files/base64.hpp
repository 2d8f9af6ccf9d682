// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace gatefly::io {

/// Bytes as letters, four for each three, as data URIs have them (RFC 4648).
[[nodiscard]] std::string base64(std::string_view bytes);

}  // namespace gatefly::io
