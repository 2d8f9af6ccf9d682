// SPDX-License-Identifier: Apache-2.0
// The fake controller as a program, for tests of the command line.
//   fake_betaflight [--log FILE] [--height M] [--hover-error PART] [--baud N]
//     prints "port N", then obeys the words on its standard input, a line each, until that ends
//   fake_betaflight --sign DRONE.toml PROGRAM    prints what a passed hand-over test would have left
#include "support/fake_betaflight.hpp"

#include <atomic>
#include <iostream>
#include <string>
#include <vector>

#include "gatefly/live/drone_file.hpp"
#include "gatefly/live/hand_over_mark.hpp"

namespace {

int fake(const std::vector<std::string>& words) {
  gatefly::test::FakeSettings settings;
  for (std::size_t i = 0; i + 1 < words.size(); i += 2) {
    if (words[i] == "--log") settings.log = words[i + 1];
    if (words[i] == "--height") settings.start_height = std::stod(words[i + 1]);
    if (words[i] == "--hover-error") settings.hover_error = std::stod(words[i + 1]);
    if (words[i] == "--baud") settings.baud = std::stoi(words[i + 1]);
  }
  gatefly::test::FakeBetaflight drone{settings};
  std::cout << "port " << drone.port() << std::endl;
  std::string line;
  for (;;) {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (poll(&input, 1, 1) > 0) {
      std::array<char, 256> room{};
      const ssize_t got = read(STDIN_FILENO, room.data(), room.size());
      if (got <= 0) return 0;
      for (const char c : std::string(room.data(), static_cast<std::size_t>(got))) {
        if (c != '\n') {
          line += c;
          continue;
        }
        if (!drone.obey(line)) std::cerr << "fake_betaflight: what is '" << line << "'?\n";
        line.clear();
      }
    }
    drone.serve();
  }
}

}  // namespace

int main(int argc, char** argv) try {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() == 3 && words[0] == "--sign") {
    std::cout << gatefly::live::hand_over_mark(gatefly::live::read_drone(words[1]),
                                               gatefly::live::program_mark(words[2]))
              << '\n';
    return 0;
  }
  return fake(words);
} catch (const std::exception& error) {
  std::cerr << "fake_betaflight: " << error.what() << '\n';
  return 2;
}
