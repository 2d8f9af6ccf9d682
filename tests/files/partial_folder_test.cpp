// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/partial_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/files/text.hpp"

#include "support/temp_folder.hpp"

namespace gatefly::files {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using Grows = PartialFolder::Grows;

bool is_ours(const std::string& name) { return name.starts_with("our"); }
bool keep_nothing(const std::string&) { return false; }

TEST(PartialFolder, WhatIsNotPutInPlaceGoesWithAllThatWasMadeForIt) {
  const test::TempFolder folder;
  for (const Grows grows : {Grows::kBeside, Grows::kInside}) {
    const PartialFolder partial(folder.path() / "a" / "b", grows, is_ours);
    write_file(partial.path() / "ours", "half");
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(PartialFolder, TakesThePlaceOfAnEarlierOneAndKeepsWhatIsNotOurs) {
  const test::TempFolder folder;
  const fs::path out = folder.path() / "out";
  fs::create_directories(out / "mine");
  fs::create_directory(folder.path() / "out.replaced");
  write_file(out / "our old", "old");
  write_file(out / "mine" / "notes", "mine");
  fs::permissions(out, fs::perms::owner_all);
  PartialFolder partial(out, Grows::kBeside, is_ours);
  write_file(partial.path() / "ours", "new");
  partial.replace(keep_nothing);
  EXPECT_EQ(read_file(out / "ours"), "new");
  EXPECT_EQ(read_file(out / "mine" / "notes"), "mine");
  EXPECT_FALSE(fs::exists(out / "our old"));
  EXPECT_FALSE(fs::exists(partial.path()));
  EXPECT_TRUE(fs::exists(folder.path() / "out.replaced"));
  EXPECT_EQ(std::distance(fs::directory_iterator(out), {}), 2);
  EXPECT_EQ(fs::status(out).permissions(), fs::perms::owner_all);
}

TEST(PartialFolder, IsAddedToWhatIsThere) {
  const test::TempFolder folder;
  write_file(folder.path() / "our old", "old");
  {
    PartialFolder partial(folder.path() / "", Grows::kInside, is_ours);
    write_file(partial.path() / "ours", "new");
    partial.pour();
  }
  EXPECT_EQ(read_file(folder.path() / "ours"), "new");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 2);
}

TEST(PartialFolder, IsAddedWholeOrNotAtAll) {
  const test::TempFolder folder;
  fs::create_directory(folder.path() / "ours z");
  {
    PartialFolder partial(folder.path(), Grows::kInside, is_ours);
    for (const char* name : {"ours a", "ours z"}) partial.write(name, "new");
    EXPECT_THAT(test::error_of([&] { partial.pour(); }), HasSubstr("ours z: cannot be written"));
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);
}

TEST(PartialFolder, ALinkToAFolderKeepsPointing) {
  const test::TempFolder folder;
  fs::create_directory(folder.path() / "far");
  fs::create_symlink("far", folder.path() / "out");
  PartialFolder partial(folder.path() / "out", Grows::kBeside, is_ours);
  write_file(partial.path() / "ours", "new");
  partial.replace(keep_nothing);
  EXPECT_TRUE(fs::is_symlink(folder.path() / "out"));
  EXPECT_EQ(read_file(folder.path() / "far" / "ours"), "new");
}

TEST(PartialFolder, IsForOneProgramAtATime) {
  const test::TempFolder folder;
  const PartialFolder first(folder.path() / "out", Grows::kBeside, is_ours);
  EXPECT_THAT(
      test::error_of([&] { PartialFolder(folder.path() / "out", Grows::kBeside, is_ours); }),
      HasSubstr("out: cannot be written: another gatefly is writing it now"));
  EXPECT_TRUE(fs::exists(first.path()));
}

TEST(PartialFolder, LeftoversAreClearedAndAForeignOneIsKept) {
  const test::TempFolder folder;
  const fs::path partial = folder.path() / "out.partial";
  fs::create_directory(partial);
  write_file(partial / "our leftover", "");
  { const PartialFolder cleared(folder.path() / "out", Grows::kBeside, is_ours); }
  EXPECT_FALSE(fs::exists(partial));

  fs::create_directory(partial);
  write_file(partial / "our leftover", "");
  write_file(partial / "thesis", "years of work");
  EXPECT_THAT(
      test::error_of([&] { PartialFolder(folder.path() / "out", Grows::kBeside, is_ours); }),
      HasSubstr("holds thesis"));
  EXPECT_EQ(std::distance(fs::directory_iterator(partial), {}), 2);
}

}  // namespace
}  // namespace gatefly::files
