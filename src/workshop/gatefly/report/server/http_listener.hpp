// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "gatefly/report/server/http_request.hpp"

namespace gatefly::server {

/// The answer to a request.
struct Answer {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body{};
  std::filesystem::path file{};  ///< Sent piece by piece instead of `body`; "": none.
  std::string policy{};          ///< Content-Security-Policy; "": nothing is loaded or run.
  std::string location{};        ///< Target of a redirect (301).
};

/// A small HTTP/1.1 server for browsers of this machine: GET and HEAD, a connection a request.
///
/// Everything a client can take is bounded: a head's bytes (kMostHead), seconds to send it, seconds
/// to take the answer, connections at a time. Whoever comes when all are taken is served: the one
/// that has been asking for longest goes.
class HttpListener {
 public:
  using Answerer = std::function<Answer(const Request&)>;

  /// @param answerer  called by several threads; what it throws is a 500.
  explicit HttpListener(Answerer answerer);
  ~HttpListener();
  HttpListener(const HttpListener&) = delete;
  HttpListener& operator=(const HttpListener&) = delete;

  /// From now on it answers.
  /// @param port  of 127.0.0.1; 0: any that is free.
  /// @return which it is. @throws std::runtime_error one line: it is taken.
  int start(int port);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace gatefly::server
