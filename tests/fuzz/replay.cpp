// SPDX-License-Identifier: Apache-2.0
// Runs a fuzz target without libFuzzer: every file of a corpus, then mutations of them, the same
// ones each time. usage: TARGET CORPUS MUTATIONS       An input that fails is written to
// fuzz_failure.bin.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <vector>

#include <sanitizer/common_interface_defs.h>

#include "gatefly/geometry/rng.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using Input = std::vector<char>;
Input current;

void write_current() {
  std::ofstream{"fuzz_failure.bin", std::ios::binary}.write(
      current.data(), static_cast<std::streamsize>(current.size()));
  std::cerr << "the input is in fuzz_failure.bin\n";
}

void run(const Input& input) {
  current = input;
  (void)LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(current.data()),
                               current.size());
}

Input mutated(Input input, const std::vector<Input>& corpus, gatefly::Rng& rng) {
  const auto place = [&] {
    return static_cast<std::size_t>(rng.uniform_index(static_cast<int>(input.size())));
  };
  for (int changes = 1 + rng.uniform_index(4); changes > 0; --changes) {
    if (input.empty()) input.push_back(0);
    switch (rng.uniform_index(5)) {
      case 0:
        input[place()] = static_cast<char>(rng.next());
        break;
      case 1:
        input[place()] ^= static_cast<char>(1 << rng.uniform_index(8));
        break;
      case 2:
        input.resize(place());
        break;
      case 3:
        input.insert(input.begin() + static_cast<std::ptrdiff_t>(place()),
                     static_cast<char>(rng.next()));
        break;
      default: {  // the head of this one, the tail of another
        const Input& other =
            corpus[static_cast<std::size_t>(rng.uniform_index(static_cast<int>(corpus.size())))];
        const std::size_t cut = std::min(place(), other.size());
        input.resize(cut);
        input.insert(input.end(), other.begin() + static_cast<std::ptrdiff_t>(cut), other.end());
      }
    }
  }
  return input;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  __sanitizer_set_death_callback(write_current);
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(argv[1]))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<Input> corpus;
  for (const auto& file : files) {
    std::ifstream in{file, std::ios::binary};
    corpus.emplace_back(std::istreambuf_iterator<char>{in}, std::istreambuf_iterator<char>{});
    run(corpus.back());
  }
  if (corpus.empty()) return 2;
  gatefly::Rng rng{1};
  const int mutations = std::atoi(argv[2]);
  for (int i = 0; i < mutations; ++i)
    run(mutated(
        corpus[static_cast<std::size_t>(rng.uniform_index(static_cast<int>(corpus.size())))],
        corpus, rng));
  std::cout << corpus.size() << " inputs and " << mutations << " mutations of them\n";
}
