// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include <sys/types.h>

namespace gatefly::files {

/// Open files that become a program's stdin, stdout and stderr, -1: nothing; and its file 3, -1: as it comes.
struct Streams {
  int input = -1, output = -1, errors = -1, third = -1;
};

/// Starts a program of PATH in a process group of its own: Ctrl-C is for us to handle.
/// @return errno, 0 when it runs; then `pid` is for wait_for().
[[nodiscard]] int start(std::vector<std::string> words, Streams streams, pid_t& pid);

/// Waits until the program has ended; 0 when it ended well.
int wait_for(pid_t pid);

/// The last line of an open file that says something.
[[nodiscard]] std::string last_line(std::FILE* file);

}  // namespace gatefly::files
