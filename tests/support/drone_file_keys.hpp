// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/live/drone_file.hpp"

#include "support/matchers.hpp"
#include "support/temp_folder.hpp"

namespace gatefly::test {

/// Expects that a drone.toml of this text is refused without any of its keys, and with a table more, and that the message names it.
inline void expect_every_key_is_needed(const std::string& text) {
  const TempFolder folder;
  const auto refused_with = [&](const std::string& content, const std::string& name) {
    const auto file = folder.file("drone.toml", content);
    EXPECT_THAT(error_of([&] { (void)live::read_drone(file); }), testing::HasSubstr(name));
  };
  for (std::size_t at = 0; (at = text.find(" = ", at)) != std::string::npos; ++at) {
    const auto begin = text.rfind('\n', at) + 1, end = text.find('\n', at);
    std::string less = text;
    less.replace(begin, end - begin, "");
    refused_with(less, text.substr(begin, at - begin));
  }
  refused_with(text + "\n[rates]\ntype = \"actual\"\n", "rates");
}

}  // namespace gatefly::test
