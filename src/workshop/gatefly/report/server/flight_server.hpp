// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>

namespace gatefly::server {

/// The regular file or folder that a request names, under `root` even when links are followed;
/// nullopt when there is none, or it is hidden.
/// @param root  canonical.
/// @param path  decoded, "/showroom-1/report.html".
[[nodiscard]] std::optional<std::filesystem::path> served(const std::filesystem::path& root,
                                                          std::string_view path);

/// Shows flights to browsers of this machine.
class FlightServer {
 public:
  /// @param folder  that report::viewable() knows.
  explicit FlightServer(const std::filesystem::path& folder);
  ~FlightServer();
  FlightServer(const FlightServer&) = delete;
  FlightServer& operator=(const FlightServer&) = delete;

  /// From now on it answers, on threads of its own.
  /// @param port  of 127.0.0.1; 0: any that is free.
  /// @return which it is. @throws std::runtime_error one line: it is taken.
  int start(int port);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace gatefly::server
