// SPDX-License-Identifier: Apache-2.0
// The fake ArduCopter as a program, for tests of the command line.
//   fake_arducopter [--log FILE] [--height M] [--hover-error PART] [--port N] [--calls UDP_PORT]
//     prints "port N", then obeys the words on its standard input, a line each, until that ends
#include "support/fake_arducopter.hpp"

#include <iostream>
#include <string>
#include <vector>

namespace {

int fake(const std::vector<std::string>& words) {
  gatefly::test::FakeArduSettings settings;
  for (std::size_t i = 0; i + 1 < words.size(); i += 2) {
    if (words[i] == "--log") settings.log = words[i + 1];
    if (words[i] == "--height") settings.start_height = std::stod(words[i + 1]);
    if (words[i] == "--hover-error") settings.hover_error = std::stod(words[i + 1]);
    if (words[i] == "--port") settings.port = std::stoi(words[i + 1]);
    if (words[i] == "--calls") settings.calls = std::stoi(words[i + 1]);
  }
  gatefly::test::FakeArduCopter drone{settings};
  std::cout << "port " << drone.port() << std::endl;
  std::string line;
  for (;;) {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (poll(&input, 1, 1) > 0) {
      std::array<char, 256> room{};
      const ssize_t got = read(STDIN_FILENO, room.data(), room.size());
      if (got <= 0) return drone.meddled();
      for (const char c : std::string(room.data(), static_cast<std::size_t>(got))) {
        if (c != '\n') {
          line += c;
          continue;
        }
        if (!drone.obey(line)) std::cerr << "fake_arducopter: what is '" << line << "'?\n";
        line.clear();
      }
    }
    drone.serve();
  }
}

}  // namespace

int main(int argc, char** argv) try {
  return fake({argv + 1, argv + argc});
} catch (const std::exception& error) {
  std::cerr << "fake_arducopter: " << error.what() << '\n';
  return 2;
}
