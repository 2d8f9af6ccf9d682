// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/printed.hpp"

#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/files/text.hpp"

namespace gatefly::files {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

TEST(Printable, LeavesTextInAnyAlphabetAsItIs) {
  for (const char* text : {"", "oval", "a\tb\nc", "Zürich · 東京 🚁", "- … –"}) {
    EXPECT_TRUE(is_printable(text)) << text;
    EXPECT_EQ(printable(text), text);
  }
}

TEST(Printable, HasNothingThatATerminalObeys) {
  EXPECT_EQ(printable("a\x1b[2Jb\rc\x7f"), "a [2Jb c ");
  EXPECT_EQ(printable("a\xc2\x9b"
                      "2J"),
            "a 2J");  // CSI as one letter of Latin-1
  EXPECT_EQ(printable("a\x9b"
                      "2J\xff"),
            "a?2J?");                      // and as the byte that it is there
  EXPECT_EQ(printable("\xe2\x82"), "??");  // a letter cut off
  EXPECT_EQ(printable("\xc0\xaf"), "??");
  for (int byte = 0; byte < 256; ++byte)
    EXPECT_TRUE(is_printable(printable(std::string(3, static_cast<char>(byte))))) << byte;
}

TEST(OneLine, IsPrintableAndWholeLetters) {
  EXPECT_EQ(one_line("a\nb\tc\x1b"), "a b c ");
  std::string name(100, 'x');
  name += "東京東京東京";
  const std::string cut = one_line(name, 105);
  EXPECT_TRUE(is_printable(cut));
  EXPECT_LE(cut.size(), 105u);
  EXPECT_THAT(cut, EndsWith("..."));
}

TEST(Readable, KeepsBothEndsOfALongName) {
  const std::string name = "begin" + std::string(5000, 'A') + "end";
  const std::string said =
      reason_of(std::runtime_error(name + ": no such file, nor a name in tracks/"));
  EXPECT_LT(said.size(), 400u);
  EXPECT_THAT(said, StartsWith("beginA"));
  EXPECT_THAT(said, EndsWith("Aend: no such file, nor a name in tracks/"));
}

TEST(Readable, EndsALongMessageOfManyWords) {
  std::string words;
  for (int i = 0; i < 3000; ++i) words += "word ";
  const std::string said = readable(words + "must be 3");
  EXPECT_LE(said.size(), 2000u);
  EXPECT_THAT(said, EndsWith("must be 3"));
}

TEST(Suggestion, OfAWordThatNobodyMeantThereIsNone) {
  const std::vector<std::string> known{"speed_mps"};
  EXPECT_THAT(suggestion("sped_mps", known), HasSubstr("speed_mps"));
  EXPECT_EQ(suggestion(std::string(101, 's'), known), "");
  EXPECT_EQ(nearest(std::string(10'000'000, 's'), known), "speed_mps");  // at once
}

}  // namespace
}  // namespace gatefly::files
