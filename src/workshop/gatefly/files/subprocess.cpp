// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/subprocess.hpp"

#include <cerrno>
#include <utility>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace gatefly::files {

int start(std::vector<std::string> words, Streams streams, pid_t& pid) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&files);
  posix_spawnattr_init(&attributes);
  const auto connect = [&](int from, int to) {
    if (from >= 0)
      posix_spawn_file_actions_adddup2(&files, from, to);
    else
      posix_spawn_file_actions_addopen(&files, to, "/dev/null", O_RDWR, 0);
  };
  connect(streams.input, STDIN_FILENO);
  connect(streams.output, STDOUT_FILENO);
  connect(streams.errors, STDERR_FILENO);
  if (streams.third >= 0) posix_spawn_file_actions_adddup2(&files, streams.third, 3);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  const int error =
      posix_spawnp(&pid, arguments[0], &files, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  return error;
}

int wait_for(pid_t pid) {
  int status = 0;
  while (waitpid(pid, &status, 0) < 0)
    if (errno != EINTR) return -1;
  return status;
}

std::string last_line(std::FILE* file) {
  std::rewind(file);
  std::string line, last;
  for (int c = std::fgetc(file); c != EOF; c = std::fgetc(file)) {
    if (c != '\n')
      line += static_cast<char>(c);
    else if (!line.empty())
      last = std::exchange(line, {});
  }
  return line.empty() ? last : line;
}

}  // namespace gatefly::files
