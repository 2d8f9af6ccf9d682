// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace gatefly::link_sim {

/// Lines that are added to a file from now on; also of a named pipe, or of a terminal. It never waits.
class NewLines {
 public:
  /// A file that is not there is made, empty. @throws std::runtime_error one line.
  explicit NewLines(const std::string& path);
  ~NewLines();
  NewLines(const NewLines&) = delete;
  NewLines& operator=(const NewLines&) = delete;

  /// Whole ones, without their ends. A file that has become shorter was begun anew.
  [[nodiscard]] std::vector<std::string> read();

 private:
  void begin_anew_if_shorter();

  int fd_ = -1;
  bool regular_ = false;
  std::string begun_;  ///< Part of a line.
};

}  // namespace gatefly::link_sim
