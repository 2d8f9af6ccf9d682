// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/gzip.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/files/text.hpp"

#include "support/temp_folder.hpp"

namespace gatefly::flight_log {
namespace {

using ::testing::HasSubstr;

std::string rows() {
  std::string text;
  for (int i = 0; i < 100'000; ++i) text += std::to_string(0.1 * i) + ",\n";
  return text;
}

std::filesystem::path packed(const test::TempFolder& folder, const std::string& name,
                             const std::string& text, std::size_t piece) {
  GzipFile file;
  file.open(folder.path() / name);
  for (std::size_t i = 0; i < text.size(); i += piece) file.write(text.substr(i, piece));
  file.close();
  EXPECT_TRUE(file.good());
  return folder.path() / name;
}

TEST(Gzip, ReadsBackWhatWasWrittenPieceByPiece) {
  const test::TempFolder folder;
  const std::string text = rows();
  const auto path = packed(folder, "a.gz", text, 77'777);
  EXPECT_EQ(read_gzip(path), text);
  EXPECT_LT(std::filesystem::file_size(path), text.size() / 2);
  EXPECT_EQ(read_gzip(packed(folder, "empty.gz", "", 1)), "");
  EXPECT_EQ(files::read_file(packed(folder, "b.gz", text, 77'777)), files::read_file(path));
}

TEST(Gzip, WhatIsNoWholeFileIsOneLine) {
  const test::TempFolder folder;
  const std::string whole = files::read_file(packed(folder, "a.gz", rows(), 1 << 20));
  const auto said = [&](const std::string& content) {
    return test::error_of([&] { (void)read_gzip(folder.file("x.gz", content)); });
  };
  EXPECT_THAT(said(""), HasSubstr("x.gz: is cut off"));
  EXPECT_THAT(said(whole.substr(0, whole.size() / 2)), HasSubstr("x.gz: is cut off"));
  EXPECT_THAT(said(whole.substr(0, whole.size() - 1)), HasSubstr("x.gz: is cut off"));
  EXPECT_THAT(said("t_s\n1\n"), HasSubstr("x.gz: is no gzip file"));
  std::string damaged = whole;
  damaged[damaged.size() - 6] ^= 1;  // its checksum
  EXPECT_THAT(said(damaged), HasSubstr("x.gz: is damaged"));
  EXPECT_THAT(test::error_of([&] { (void)read_gzip(folder.path() / "a.gz", 1000); }),
              HasSubstr("is longer than"));
}

TEST(Gzip, EveryMemberIsRead) {
  const test::TempFolder folder;
  const std::string one = files::read_file(packed(folder, "a.gz", "t_s\n1\n", 9)),
                    other = files::read_file(packed(folder, "b.gz", rows(), 1 << 20)),
                    none = files::read_file(packed(folder, "c.gz", "", 1));
  EXPECT_EQ(read_gzip(folder.file("x.gz", one + none + other)), "t_s\n1\n" + rows());
  EXPECT_THAT(test::error_of([&] {
                (void)read_gzip(folder.file("x.gz", one + other.substr(0, other.size() - 1)));
              }),
              HasSubstr("x.gz: is cut off"));
  EXPECT_THAT(test::error_of([&] { (void)read_gzip(folder.file("x.gz", one + "t_s\n1\n")); }),
              HasSubstr("x.gz: is damaged"));
}

TEST(Gzip, WhatUnpacksToFarMoreThanALogIsRefused) {
  const test::TempFolder folder;
  const auto path = packed(folder, "a.gz", std::string(std::size_t{64} << 20, '0'), 1 << 20);
  EXPECT_THAT(test::error_of([&] { (void)read_gzip(path); }),
              HasSubstr("a.gz: unpacks to more than 32 times its size"));
}

}  // namespace
}  // namespace gatefly::flight_log
