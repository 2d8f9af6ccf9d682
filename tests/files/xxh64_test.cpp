// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/xxh64.hpp"

#include <string_view>
#include <vector>

#include <gtest/gtest.h>

namespace gatefly::files {
namespace {

std::uint64_t of(std::string_view text) {
  return xxh64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

// As xxhsum -H1 prints them.
TEST(Xxh64, IsTheKnownOne) {
  EXPECT_EQ(of(""), 0xef46db3751d8e999);
  EXPECT_EQ(of("a"), 0xd24ec4f1a98c6e5b);
  EXPECT_EQ(of("abc"), 0x44bc2cf5ad770999);
  EXPECT_EQ(of("Nobody inspects the spammish repetition"), 0xfbcea83c8a378bf1);
}

TEST(Xxh64, EveryByteCounts) {
  std::vector<std::uint8_t> bytes(101, 7);
  const std::uint64_t hash = xxh64(bytes);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] ^= 1;
    EXPECT_NE(xxh64(bytes), hash) << i;
    bytes[i] ^= 1;
  }
  bytes.push_back(7);
  EXPECT_NE(xxh64(bytes), hash);
}

TEST(Xxh64, ItsTextReadsBack) {
  EXPECT_EQ(text_of_xxh64(0x00bc2cf5ad770999), "00bc2cf5ad770999");
  EXPECT_EQ(xxh64_of_text("00bc2cf5ad770999"), 0x00bc2cf5ad770999);
  for (const char* wrong :
       {"", "1234", "00bc2cf5ad77099x", "00bc2cf5ad7709990", "-0bc2cf5ad770999"})
    EXPECT_FALSE(xxh64_of_text(wrong)) << wrong;
}

}  // namespace
}  // namespace gatefly::files
