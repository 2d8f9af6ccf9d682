// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/calibration/boards.hpp"

#include <gtest/gtest.h>

#include "gatefly/tasks/calibration/with_sigma.hpp"

#include "support/temp_folder.hpp"

namespace gatefly::calibration {
namespace {

using gatefly::test::error_of;
using gatefly::test::TempFolder;

constexpr const char* kList = "image,X_m,Y_m,u_px,v_px\na,0,0,10,20\na,0.03,0,30,20\n";

TEST(Boards, CornersOfAStoredPictureAreTurnedUpright) {
  const TempFolder folder;
  Boards boards;
  boards.add_list(folder.file("c.csv", kList), {.size = "320x240", .rotate_deg = 90});
  EXPECT_EQ(boards.size_px, Eigen::Vector2i(240, 320));
  ASSERT_EQ(boards.views.size(), 1u);
  EXPECT_EQ(boards.views[0].corners[0].px, Eigen::Vector2d(20, 309));
  EXPECT_TRUE(boards.listed);
}

TEST(Boards, AListThatContradictsWhatIsSaidOfItIsRefusedByName) {
  const TempFolder folder;
  const auto path = folder.file("c.csv", kList);
  const auto refusal = [&](const BoardArguments& said) {
    return error_of([&] {
      Boards boards;
      boards.add_list(path, said);
    });
  };
  EXPECT_NE(refusal({}).find("add --size WxH"), std::string::npos);
  EXPECT_NE(refusal({.size = "20x240"}).find("corner at (30, 20), outside"), std::string::npos);
  EXPECT_NE(refusal({.pattern = "9x6", .size = "320x240"}).find("has 2 corners, --pattern 9x6"),
            std::string::npos);
  EXPECT_NE(refusal({.size = "320"}).find("--size 320: must be two numbers in 16..4096"),
            std::string::npos);
}

TEST(Boards, APatternThatMostPicturesContradictIsNamed) {
  Boards boards;
  boards.pictures = 6;
  boards.views.resize(2);
  boards.other_patterns = {{"7x5", 3}, {"8x6", 1}};
  EXPECT_EQ(error_of([&] { expect_enough(boards, {.pattern = "9x6"}); }),
            "--pattern 9x6: 3 of 6 pictures show a board of 7x5 inner corners: --pattern 7x5?");
  boards.views.resize(5);
  EXPECT_EQ(error_of([&] { expect_enough(boards, {.pattern = "9x6"}); }), "");
}

TEST(WithSigma, HasAsManyDigitsAsTheSigmaDeserves) {
  EXPECT_EQ(with_sigma(169.2345, 0.02), "169.234 ± 0.020");
  EXPECT_EQ(with_sigma(169.2345, 3.0), "169.2 ± 3.0");
  EXPECT_EQ(with_sigma(1.0, 0.0), "1.0000");
}

}  // namespace
}  // namespace gatefly::calibration
