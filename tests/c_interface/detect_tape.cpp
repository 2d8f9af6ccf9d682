// SPDX-License-Identifier: Apache-2.0
// detect_tape TAPE: every gate in the raw pictures of a tape (pack_flight.cpp), with its corners to the last bit.
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <vector>

#include "gatefly/detection/gate_detector.hpp"

namespace {

constexpr std::size_t kTick = 16 * sizeof(double);

std::uint64_t bits(double value) {
  std::uint64_t pattern = 0;
  std::memcpy(&pattern, &value, sizeof pattern);
  return pattern;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace gatefly;
  std::ifstream tape{argc == 2 ? argv[1] : "", std::ios::binary};
  char magic[8];
  std::uint32_t head[4];
  tape.read(magic, sizeof magic).read(reinterpret_cast<char*>(head), sizeof head);
  if (!tape || std::memcmp(magic, "GFTAPE1", 8) != 0)
    return std::fprintf(stderr, "detect_tape: not a tape\n"), 2;
  const auto [ticks, pictures, width, height] = head;
  tape.seekg(static_cast<std::streamoff>(kTick * ticks), std::ios::cur);
  std::vector<std::uint8_t> bytes(std::size_t{2} * width * height);
  const auto orange = ColorModel::described({1.0, 0.4, 0.0});
  GateDetector detector;
  for (std::uint32_t i = 0; i < pictures; ++i) {
    if (!tape.read(reinterpret_cast<char*>(bytes.data()),
                   static_cast<std::streamsize>(bytes.size())))
      return std::fprintf(stderr, "detect_tape: the tape is short\n"), 2;
    const Image image{bytes.data(), PixelFormat::kUyvy, static_cast<int>(width),
                      static_cast<int>(height), 90};
    const auto view = detector.look(image, orange, {LookFor::Gates::kAll});
    for (const auto& gate : view.gates) {
      std::printf("%" PRIu32 " %016" PRIx64, i, bits(gate.fitness));
      for (const auto& corner : gate.corners_px)
        std::printf(" %.6f %016" PRIx64 " %.6f %016" PRIx64, corner.x(), bits(corner.x()),
                    corner.y(), bits(corner.y()));
      std::printf("\n");
    }
  }
}
