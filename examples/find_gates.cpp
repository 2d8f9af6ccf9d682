// SPDX-License-Identifier: Apache-2.0
// find_gates PICTURE: the corners of every orange gate in a picture, clockwise from top-left [px].
#include <iostream>

#include <gatefly/detection/gate_detector.hpp>
#include <gatefly/files/image_file.hpp>

int main(int argc, char** argv) try {
  const auto file = gatefly::files::read_image(argc > 1 ? argv[1] : "photo.jpg");
  const auto orange = gatefly::ColorModel::described({1.0, 0.4, 0.0});
  gatefly::GateDetector detector;
  const auto view = detector.look(file.view(0), orange, {gatefly::LookFor::Gates::kAll});
  for (const auto& gate : view.gates) {
    std::cout << "fitness " << gate.fitness << ':';
    for (const auto& corner : gate.corners_px) std::cout << ' ' << corner.transpose() << ';';
    std::cout << '\n';
  }
} catch (const std::exception& error) {
  return std::cerr << error.what() << '\n', 2;
}
