// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/output.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include "gatefly/drawing/canvas.hpp"
#include "gatefly/files/image_file.hpp"
#include "gatefly/files/text.hpp"

#include "support/temp_folder.hpp"

namespace gatefly::files {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr OutputKind kTable{"table", "a,b\n"};

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

/// One of our own: a fault must not replace the system's. Empty where none may be made.
fs::path full_device(const test::TempFolder& folder) {
  const fs::path path = folder.path() / "full";
  const bool made = mknod(path.c_str(), S_IFCHR | 0666, makedev(1, 7)) == 0;
  return made && std::ofstream{path} ? path : fs::path{};
}

TEST(WriteFile, ALinkKeepsPointingAlsoToWhatIsNotThere) {
  const test::TempFolder folder;
  fs::create_directory(folder.path() / "far");
  fs::create_symlink("far/file", folder.path() / "second");
  fs::create_symlink("second", folder.path() / "first");
  for (const std::string text : {"new", "again"}) {
    write_file(folder.path() / "first", text);
    EXPECT_TRUE(fs::is_symlink(folder.path() / "first"));
    EXPECT_EQ(read_file(folder.path() / "far" / "file"), text);
  }
  EXPECT_EQ(names_in(folder.path() / "far"), std::vector<std::string>{"file"});
}

TEST(WriteFile, APipeIsWrittenThrough) {
  const test::TempFolder folder;
  const fs::path pipe = folder.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::string got;
  std::thread reader{[&] {
    got = std::string{std::istreambuf_iterator<char>{std::ifstream{pipe}.rdbuf()}, {}};
  }};
  write_file(pipe, "through");
  reader.join();
  EXPECT_EQ(got, "through");
  EXPECT_TRUE(fs::is_fifo(pipe));
}

TEST(WriteFile, WhoMayReadItStaysAndNeighboursDo) {
  const test::TempFolder folder;
  const fs::path file = folder.file("f.csv", "");
  (void)folder.file("f.csv.partial", "mine");
  fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
  write_file(file, "a,b\n");
  EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(read_file(folder.path() / "f.csv.partial"), "mine");
}

TEST(WriteFiles, AreAllWrittenOrNone) {
  const test::TempFolder folder;
  const std::array<FileContent, 2> files{
      {{folder.file("a", "old"), "new"}, {folder.path() / "missing" / "b", "new"}}};
  EXPECT_THAT(test::error_of([&] { write_files(files); }),
              HasSubstr("missing/b: cannot be written"));
  EXPECT_EQ(read_file(folder.path() / "a"), "old");
  const fs::path device = full_device(folder);
  if (device.empty()) GTEST_SKIP() << "no device may be made here";
  const std::array<FileContent, 2> to_device{{{folder.path() / "a", "new"}, {device, "new"}}};
  EXPECT_THAT(test::error_of([&] { write_files(to_device); }),
              HasSubstr("full: cannot be written"));
  EXPECT_EQ(read_file(folder.path() / "a"), "old");
}

TEST(WriteFile, AFullDeviceIsSaidAndStaysOne) {
  const test::TempFolder folder;
  const fs::path device = full_device(folder);
  if (device.empty()) GTEST_SKIP() << "no device may be made here";
  EXPECT_THAT(test::error_of([&] { write_file(device, "x"); }),
              HasSubstr("full: cannot be written: No space left"));
  EXPECT_TRUE(fs::is_character_file(device));
}

class CheckOutputs : public ::testing::Test {
 protected:
  std::string error(const fs::path& path, const std::vector<fs::path>& inputs = {},
                    bool force = false) {
    const std::vector<std::string> before = names_in(folder_.path());
    const Output output{"--csv", path, kTable};
    const std::string said = test::error_of([&] { check_outputs({&output, 1}, inputs, force); });
    EXPECT_EQ(names_in(folder_.path()), before);
    return said;
  }
  test::TempFolder folder_;
};

TEST_F(CheckOutputs, AnEarlierOneAnEmptyFileAndANewNameMayBeWritten) {
  EXPECT_EQ(error(folder_.file("old.csv", "a,b\n1,2\n")), "");
  EXPECT_EQ(error(folder_.file("empty", "")), "");
  EXPECT_EQ(error(folder_.path() / "new.csv"), "");
  EXPECT_EQ(error("-"), "");
}

TEST_F(CheckOutputs, AnotherFileIsReplacedByForceOnly) {
  const fs::path file = folder_.file("thesis.tex", "years of work");
  EXPECT_THAT(error(file), HasSubstr("thesis.tex: is there and is no table"));
  EXPECT_EQ(error(file, {}, true), "");
}

TEST_F(CheckOutputs, AnInputIsNeverReplacedWhateverItsName) {
  const fs::path input = folder_.file("a.csv", "a,b\n"), link = folder_.path() / "link",
                 twin = folder_.path() / "twin";
  fs::create_symlink("a.csv", link);
  fs::create_hard_link(input, twin);
  for (const fs::path& path : {input, link, twin})
    EXPECT_THAT(error(path, {input}, true), HasSubstr("would overwrite the input")) << path;
}

TEST_F(CheckOutputs, OfAFolderThatIsReadOnlyEarlierOutputsAreReplaced) {
  EXPECT_EQ(error(folder_.file("found.csv", "a,b\n"), {folder_.path()}), "");
  EXPECT_THAT(error(folder_.file("labels.csv", "c,d\n"), {folder_.path()}, true),
              HasSubstr("a file of the input"));
  EXPECT_THAT(error(folder_.file("a.jpg", ""), {folder_.path()}, true),
              HasSubstr("a file of the input"));
}

TEST_F(CheckOutputs, WhatIsNoPlaceForAFile) {
  EXPECT_THAT(error(folder_.path()), HasSubstr("is a folder"));
  EXPECT_THAT(error(folder_.path() / "no" / "f"), HasSubstr("a folder that is there"));
  EXPECT_THAT(error(folder_.file("f", "") / "below"), HasSubstr("Not a directory"));
  EXPECT_THAT(error(folder_.path() / std::string(300, 'x')), HasSubstr("name too long"));
  fs::create_symlink("loop", folder_.path() / "loop");
  EXPECT_THAT(error(folder_.path() / "loop"), HasSubstr("Too many levels"));
  EXPECT_THAT(error("/proc/f.csv"), HasSubstr("cannot be written"));
}

TEST_F(CheckOutputs, TwoOutputsAreTwoFiles) {
  fs::create_symlink("a", folder_.path() / "b");
  const std::array<Output, 2> outputs{
      {{"--out", folder_.path() / "a", kTable}, {"--report", folder_.path() / "b", kTable}}};
  EXPECT_THAT(test::error_of([&] { check_outputs(outputs, {}, false); }),
              HasSubstr("is where --out goes, too"));
}

TEST(RefuseForeignFolder, WhatAKilledProgramLeftIsNobodys) {
  const test::TempFolder folder;
  const auto error = [&] {
    return test::error_of([&] { refuse_foreign_folder(folder.path(), "w", kTable, "go away"); });
  };
  EXPECT_EQ(error(), "");
  (void)folder.file(".gatefly-7-1", "half");
  EXPECT_EQ(error(), "");
  (void)folder.file("thesis", "years of work");
  EXPECT_THAT(error(), HasSubstr("holds no table (w), go away"));
  (void)folder.file("w", "a,b\n");
  EXPECT_EQ(error(), "");
}

TEST(OurPng, IsKnownFromOthersAndStillAPicture) {
  const test::TempFolder folder;
  drawing::Canvas(8, 8).write_png(folder.path() / "a.png");
  EXPECT_TRUE(is_of_kind(folder.path() / "a.png", kOurPng));
  EXPECT_EQ(read_image(folder.path() / "a.png").stored_width, 8);
  EXPECT_FALSE(is_of_kind(folder.file("b.png", "\x89PNG\r\n"), kOurPng));
}

}  // namespace
}  // namespace gatefly::files
