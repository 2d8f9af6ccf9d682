// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace gatefly::server {

/// Bytes that a request may have, from its first line to the empty one.
inline constexpr std::size_t kMostHead = 8192;

/// Bytes that are asked for of a file: "bytes=100-199", "bytes=100-", "bytes=-100".
struct ByteRange {
  std::optional<std::uint64_t> first, last;  ///< Without a first: the last so many.
};

/// GET or HEAD of something on this machine.
struct Request {
  bool head_only = false;  ///< HEAD.
  std::string target;      ///< As it was sent, without what follows "?".
  std::string path;        ///< The same decoded: "/a flight/report.html".
  std::optional<ByteRange> range;
};

/// A request that gets no more than a status and a line.
struct Refusal {
  int status = 400;
  const char* why = "";
};

/// Reads a request's head; it has no body.
///
/// A page in another site's name must not read flights (DNS rebinding): its Host must be 127.0.0.1
/// or localhost.
/// @param head  all before the empty line, at most kMostHead bytes of anything.
[[nodiscard]] std::variant<Request, Refusal> parsed_request(std::string_view head);

}  // namespace gatefly::server
