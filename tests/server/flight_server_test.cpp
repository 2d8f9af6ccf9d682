// SPDX-License-Identifier: Apache-2.0
#include "gatefly/report/server/flight_server.hpp"

#include <filesystem>

#include <gtest/gtest.h>

#include "support/temp_folder.hpp"

namespace gatefly::server {
namespace {

namespace fs = std::filesystem;

class ServedTest : public ::testing::Test {
 protected:
  ServedTest() {
    fs::create_directories(root_ / "a flight");
    (void)folder_.file("root/a flight/report.html", "page");
    (void)folder_.file("root/.hidden", "no");
    (void)folder_.file("secret", "no");
    (void)folder_.file("root-of-another", "no");
    fs::create_symlink("../secret", root_ / "link_out");
    fs::create_symlink("..", root_ / "folder_out");
    fs::create_symlink("a flight/report.html", root_ / "link_in");
  }
  test::TempFolder folder_;
  fs::path root_ = fs::canonical(folder_.path()) / "root";
};

TEST_F(ServedTest, WhatIsUnderTheFolder) {
  EXPECT_TRUE(fs::equivalent(*served(root_, "/"), root_));
  EXPECT_EQ(served(root_, "/a flight/"), root_ / "a flight");
  EXPECT_EQ(served(root_, "/a flight/report.html"), root_ / "a flight" / "report.html");
  EXPECT_EQ(served(root_, "/link_in"), root_ / "a flight" / "report.html");
}

TEST_F(ServedTest, NothingElse) {
  for (const char* path :
       {"", "secret", "/../secret", "/a flight/../../secret", "/..", "/./link_in", "/.hidden",
        "/link_out", "/folder_out/secret", "/folder_out", "//secret", "//etc/passwd", "/etc/passwd",
        "/../root-of-another", "/nothing", "/a flight/report.html/more"})
    EXPECT_FALSE(served(root_, path)) << path;
  EXPECT_FALSE(served(root_, std::string_view{"/link_in\0x", 10}));
  fs::path device = root_ / "device";
  fs::create_symlink("/dev/zero", device);
  EXPECT_FALSE(served(root_, "/device"));
}

}  // namespace
}  // namespace gatefly::server
