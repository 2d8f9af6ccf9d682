// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "gatefly/experiments/hall_pictures.hpp"
#include "gatefly/experiments/miss_cause.hpp"

#include "support/draw_gate.hpp"

namespace gatefly::experiments {
namespace {

using test::View;

/// A gate of an orange frame, three metres off, and where its corners are.
struct DrawnGate {
  test::Canvas canvas{315, 160};
  std::vector<std::uint8_t> bytes;
  Quad corners_px;

  DrawnGate() {
    const CameraRig rig = test::bebop_rig();
    const View view{{-3.0, 0.1, 0.1}, {}};
    canvas.draw_gate(view, rig, 1.0, 0.05, {140, 80, 180});
    bytes = canvas.yuv444();
    corners_px = test::corners_of(1.0, view, rig).value();
  }
  [[nodiscard]] std::string cause(const GateDetectorParams& params) const {
    return cause_of_miss({bytes.data(), PixelFormat::kYuv444, 315, 160}, corners_px,
                         ColorModel::described({1.0, 0.4, 0.0}), params);
  }
};

TEST(MissCause, SaysHowFarTheSearchCame) {
  GateDetectorParams strict;
  strict.min_score = 6.0;
  EXPECT_EQ(DrawnGate{}.cause(strict), "score");
  strict.min_score = 20.0;
  EXPECT_EQ(DrawnGate{}.cause(strict), "rough score");
  GateDetectorParams empty;
  empty.max_inside = -2.0;
  EXPECT_EQ(DrawnGate{}.cause(empty), "opening not empty");
}

TEST(HallSeed, IsThatCamerasAndLabelsWhatCanBeAskedFor) {
  const HallSeed hall = hall_seed({}, 1001, 4, {}),
                 straight = hall_seed({.straight = true}, 1001, 4, {});
  ASSERT_EQ(hall.pictures.size(), 4u);
  EXPECT_EQ(straight.config.camera.model, "pinhole");
  EXPECT_EQ(hall.config.camera.focal_px, straight.config.camera.focal_px);
  for (const HallPicture& picture : hall.pictures) {
    EXPECT_EQ(picture.view().width(), 640);
    EXPECT_EQ(picture.view().height(), 480);
    EXPECT_EQ(picture.file.bytes.size(), 640u * 480u * 2u);
    for (const Quad& gate : picture.truth.gates)
      EXPECT_GE(files::polygon_area(gate), HallPicture::kLeastSide * HallPicture::kLeastSide);
  }
  EXPECT_EQ(hall.pictures[3].file.bytes, hall_seed({}, 1001, 4, {}).pictures[3].file.bytes);
  EXPECT_NE(hall.pictures[3].file.bytes, straight.pictures[3].file.bytes);
  const HallSeed hard = hall_seed({.level = HallCamera::Level::kHard}, 1001, 4, {});
  EXPECT_NE(hall.pictures[3].file.bytes, hard.pictures[3].file.bytes);
}

}  // namespace
}  // namespace gatefly::experiments
