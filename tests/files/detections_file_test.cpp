// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/detections_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/files/labels_file.hpp"
#include "gatefly/geometry/rng.hpp"

#include "support/temp_folder.hpp"

namespace gatefly::files {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

const std::string kHeader = "image,gate,tl_u,tl_v,tr_u,tr_v,br_u,br_v,bl_u,bl_v,fitness,method\n";
const std::string kLabelHeader = "image,has_gate,tl_u,tl_v,tr_u,tr_v,br_u,br_v,bl_u,bl_v";

TEST(DetectionsFile, WhatIsWrittenComesBack) {
  Rng rng{1};
  std::vector<DetectionRow> rows(40);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i] = {.image = "f7.avi#" + std::to_string(i),
               .gate = static_cast<int>(i % 3),
               .corners_px = {},
               .fitness = rng.uniform(0, 1),
               .method = i % 5 == 0 ? "bars" : "snake"};
    for (auto& corner : rows[i].corners_px)
      corner = {rng.uniform(-20, 4000), rng.uniform(-20, 300)};
  }
  const test::TempFolder folder;
  const std::string csv = detections_csv(rows);
  EXPECT_TRUE(
      csv.starts_with("image,gate,tl_u,tl_v,tr_u,tr_v,br_u,br_v,bl_u,bl_v,fitness,method,"));
  const auto read = read_detections(folder.file("a.csv", csv));
  ASSERT_THAT(read, SizeIs(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(read[i].image, rows[i].image);
    EXPECT_EQ(read[i].gate, rows[i].gate);
    EXPECT_EQ(read[i].method, rows[i].method);
    EXPECT_NEAR(read[i].fitness, rows[i].fitness, 1e-4);
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_LT((read[i].corners_px[k] - rows[i].corners_px[k]).norm(), 1e-3);
  }
  EXPECT_EQ(detections_csv(read), csv);
  EXPECT_EQ(detections_csv({}), detections_header());
}

TEST(DetectionsFile, OnlyImageAndCornersAreNeeded) {
  const test::TempFolder folder;
  const auto rows = read_detections(folder.file(
      "a.csv", "image,tl_u,tl_v,tr_u,tr_v,br_u,br_v,bl_u,bl_v,mine\na.jpg,1,2,3,2,3,4,1,4,x\n"));
  ASSERT_THAT(rows, SizeIs(1));
  EXPECT_EQ(rows[0].corners_px[2], Eigen::Vector2d(3, 4));
}

TEST(DetectionsFile, ErrorsNameLineColumnAndValue) {
  const test::TempFolder folder;
  const auto error = [&](const std::string& rows) {
    return test::error_of([&] { (void)read_detections(folder.file("a.csv", kHeader + rows)); });
  };
  EXPECT_THAT(error("a.jpg,0,1,2,3,2,3,4,1,4,0.5,snake\na.jpg,1,1,2,wide,2,3,4,1,4,0.5,snake\n"),
              HasSubstr("a.csv:3:5: tr_u = 'wide', must be a number"));
  EXPECT_THAT(error("a.jpg,0,1,2,3,,3,4,1,4,0.5,snake\n"),
              HasSubstr("a.csv:2:6: tr_v = '', must be a number"));
  EXPECT_THAT(error("a.jpg,-1,1,2,3,2,3,4,1,4,0.5,snake\n"),
              HasSubstr("a.csv:2:2: gate = '-1', must be a whole number"));
  EXPECT_THAT(error("a.jpg,0.5,1,2,3,2,3,4,1,4,0.5,snake\n"), HasSubstr("gate = '0.5'"));
  EXPECT_THAT(error(",0,1,2,3,2,3,4,1,4,0.5,snake\n"), HasSubstr("a.csv:2:1: image = ''"));
  EXPECT_THAT(error("a.jpg,0,1,2\n"), HasSubstr("a.csv:2: has 4 cells"));
  EXPECT_EQ(error("a.jpg,0,1,,3,,,,,,0.5,bars\n"), "");  // only the u of two bars
}

TEST(LabelsFile, FlagsDistancesDuplicatesAndDegenerateLabels) {
  const test::TempFolder folder;
  const Labels labels = read_labels(folder.file(
      "labels.csv", kLabelHeader + ",true_distance_m,first_identical_image,degenerate_label\n"
                                   "a.jpg,1,0,0,4,0,4,4,0,4,6,a.jpg,0\n"
                                   "b.jpg,0,,,,,,,,,,a.jpg,0\n"
                                   "c.jpg,1,0,0,0,0,0,0,0,0,2,,1\n"));
  ASSERT_THAT(labels.pictures, SizeIs(2));
  EXPECT_THAT(labels.pictures[0].gates, SizeIs(1));
  EXPECT_EQ(labels.pictures[0].true_distance, 6.0);
  EXPECT_THAT(labels.pictures[1].gates, SizeIs(0));
  EXPECT_EQ(labels.pictures[1].first_identical, "a.jpg");
  EXPECT_THAT(labels.degenerate, ElementsAre("c.jpg"));
}

TEST(LabelsFile, SeveralRowsOfAPictureAreItsGatesInTheirOrder) {
  const test::TempFolder folder;
  const Labels labels = read_labels(folder.file("corners.csv",
                                                "image,tl_u,tl_v,tr_u,tr_v,br_u,br_v,bl_u,bl_v\n"
                                                "a.jpg,0,0,9,0,9,9,0,9\n"
                                                "b.jpg,,,,,,,,\n"
                                                "a.jpg,20,0,24,0,24,4,20,4\n"));
  ASSERT_THAT(labels.pictures, SizeIs(2));
  ASSERT_THAT(labels.pictures[0].gates, SizeIs(2));
  EXPECT_EQ(labels.pictures[0].gates[1][0].x(), 20.0);
  EXPECT_THAT(labels.pictures[1].gates, SizeIs(0));
}

TEST(LabelsFile, ErrorsNameLineColumnAndValue) {
  const test::TempFolder folder;
  const auto error = [&](const std::string& row) {
    return test::error_of(
        [&] { (void)read_labels(folder.file("labels.csv", kLabelHeader + "\n" + row + "\n")); });
  };
  EXPECT_THAT(error("a.jpg,yes,0,0,4,0,4,4,0,4"),
              HasSubstr("labels.csv:2:2: has_gate = 'yes', must be 0 or 1"));
  EXPECT_THAT(error("a.jpg,1,0,0,4,0,4,4,,4"), HasSubstr("labels.csv:2:9: bl_u = ''"));
  EXPECT_THAT(error("a.jpg,1,0,0,0,0,0,0,0,0"),
              HasSubstr("labels.csv:2: its corners enclose no area"));
  EXPECT_THAT(test::error_of([&] { (void)read_labels(folder.file("x.csv", "img,has_gate\n")); }),
              HasSubstr("no column 'image'"));
}

}  // namespace
}  // namespace gatefly::files
