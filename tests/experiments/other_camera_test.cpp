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

  explicit DrawnGate(double bar = 0.05) {
    const CameraRig rig = test::bebop_rig();
    const View view{{-3.0, 0.1, 0.1}, {}};
    canvas.draw_gate(view, rig, 1.0, bar, {140, 80, 180});
    bytes = canvas.yuv444();
    corners_px = test::corners_of(1.0, view, rig).value();
  }
  [[nodiscard]] std::string cause(const GateDetectorParams& params,
                                  const std::array<double, 3>& rgb = {1.0, 0.4, 0.0}) const {
    return cause_of_miss({bytes.data(), PixelFormat::kYuv444, 315, 160}, corners_px,
                         ColorModel::described(rgb), params);
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
  EXPECT_EQ(DrawnGate{}.cause({}, {0.0, 0.3, 1.0}), "no place tried");
}

TEST(HallDay, IsThatCamerasAndLabelsWhatCanBeAskedFor) {
  const HallDay day = hall_day({}, 1001, 4, {}),
                straight = hall_day({.straight = true}, 1001, 4, {});
  ASSERT_EQ(day.pictures.size(), 4u);
  EXPECT_EQ(straight.config.camera.model, "pinhole");
  EXPECT_EQ(day.config.camera.focal_px, straight.config.camera.focal_px);
  for (const HallPicture& picture : day.pictures) {
    EXPECT_EQ(picture.view().width(), 640);
    EXPECT_EQ(picture.view().height(), 480);
    EXPECT_EQ(picture.file.bytes.size(), 640u * 480u * 2u);
    for (const Quad& gate : picture.truth.gates)
      EXPECT_GE(io::polygon_area(gate), HallPicture::kLeastSide * HallPicture::kLeastSide);
  }
  EXPECT_EQ(day.pictures[3].file.bytes, hall_day({}, 1001, 4, {}).pictures[3].file.bytes);
  EXPECT_NE(day.pictures[3].file.bytes, straight.pictures[3].file.bytes);
}

}  // namespace
}  // namespace gatefly::experiments
