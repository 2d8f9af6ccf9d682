// SPDX-License-Identifier: Apache-2.0
#include "gatefly/link/jpeg_slices.hpp"

#include <algorithm>
#include <chrono>
#include <map>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/for_all.hpp"

namespace gatefly::jpeg_slices {
namespace {

using namespace std::chrono_literals;
using test::for_all;
using testing::ElementsAre;
using Data = std::vector<std::uint8_t>;

Data some_jpeg(Rng& rng, int size) {
  Data jpeg(static_cast<std::size_t>(size));
  for (std::uint8_t& byte : jpeg) byte = static_cast<std::uint8_t>(rng.next());
  return jpeg;
}

std::vector<Data> slices_of(const Data& jpeg, std::uint32_t frame_id, std::size_t room = 1024) {
  std::vector<Data> slices;
  Data buffer(room);
  EXPECT_TRUE(each_slice(jpeg, frame_id, std::chrono::nanoseconds{frame_id * 1000}, buffer,
                         [&](Bytes bytes) { slices.emplace_back(bytes.begin(), bytes.end()); }));
  return slices;
}

/// The pictures that come of datagrams, by number.
std::vector<std::pair<std::uint32_t, Data>> pictures_of(Assembler& assembler,
                                                        const std::vector<Data>& datagrams) {
  std::vector<std::pair<std::uint32_t, Data>> pictures;
  for (const Data& datagram : datagrams)
    if (const auto picture = assembler.take(datagram))
      pictures.emplace_back(picture->frame_id, Data(picture->jpeg.begin(), picture->jpeg.end()));
  return pictures;
}

// Byte by byte, from the description.
TEST(JpegSlices, ASliceIsAHeaderOf24BytesLittleEndianAndItsPayload) {
  Data room(24 + 3);
  std::vector<Data> sent;
  each_slice(Data{9, 8, 7, 6}, 0x01020304, 0x1122334455ns, room,
             [&](Bytes bytes) { sent.emplace_back(bytes.begin(), bytes.end()); });
  EXPECT_THAT(sent, ElementsAre(Data{4, 3, 2,    1,    0,    0,    2,    0, 4, 0, 0, 0, 3, 0,
                                     0, 0, 0x55, 0x44, 0x33, 0x22, 0x11, 0, 0, 0, 9, 8, 7},
                                Data{4, 3, 2, 1,    1,    0,    2,    0,    4, 0, 0, 0, 1,
                                     0, 0, 0, 0x55, 0x44, 0x33, 0x22, 0x11, 0, 0, 0, 6}));
}

TEST(JpegSlices, APictureComesBackWholeInAnyOrderOfItsSlicesDoubledOrNot) {
  for_all(200, [](Rng& rng) {
    const Data jpeg = some_jpeg(rng, 1 + rng.uniform_index(20'000));
    auto slices = slices_of(jpeg, 7, 25 + static_cast<std::size_t>(rng.uniform_index(1500)));
    if (slices.size() > 1024) return test::not_a_case();
    for (std::size_t i = slices.size(); i-- > 1;)
      std::swap(slices[i],
                slices[static_cast<std::size_t>(rng.uniform_index(static_cast<int>(i + 1)))]);
    for (int doubled = rng.uniform_index(5); doubled > 0; --doubled)
      slices.insert(
          slices.begin(),
          slices[static_cast<std::size_t>(rng.uniform_index(static_cast<int>(slices.size())))]);
    Assembler assembler;
    EXPECT_THAT(pictures_of(assembler, slices), ElementsAre(std::pair{7u, jpeg}));
    EXPECT_EQ(assembler.counts().refused, 0u);
  });
}

TEST(JpegSlices, SlicesNeedNotBeOfOneSize) {
  Data all;
  std::vector<Data> slices;
  const std::vector<Data> payloads{{1, 2, 3}, {4}, {5, 6}};
  for (std::size_t i = 0; i < payloads.size(); ++i) {
    Data bytes(kHeaderSize);
    link::ByteWriter out{bytes};
    link::encode(Header{.frame_id = 1,
                        .chunk_id = std::uint16_t(i),
                        .total_chunks = 3,
                        .jpeg_size = 6,
                        .payload_size = std::uint32_t(payloads[i].size()),
                        .sim_time_ns = 0},
                 out);
    bytes.insert(bytes.end(), payloads[i].begin(), payloads[i].end());
    slices.insert(slices.begin(), bytes);
  }
  Assembler assembler;
  EXPECT_THAT(pictures_of(assembler, slices), ElementsAre(std::pair{1u, Data{1, 2, 3, 4, 5, 6}}));
}

/// Loss and delay of a network: each datagram is lost with `loss`, or arrives up to `late` places later.
std::vector<Data> disturbed(const std::vector<Data>& sent, double loss, int late, Rng& rng) {
  std::multimap<std::size_t, Data> arrival;
  for (std::size_t i = 0; i < sent.size(); ++i)
    if (rng.uniform(0, 1) >= loss)
      arrival.emplace(i + static_cast<std::size_t>(rng.uniform_index(late + 1)), sent[i]);
  std::vector<Data> datagrams;
  for (auto& [at, datagram] : arrival) datagrams.push_back(std::move(datagram));
  return datagrams;
}

TEST(JpegSlices, UnderLossAndReorderingPicturesAreWholeAndInOrderAndThoseWithAllSlicesComeOut) {
  for_all(20, [](Rng& rng) {
    std::map<std::uint32_t, Data> jpegs;
    std::vector<Data> sent;
    const std::uint32_t first = 0xFFFFFFFF - 20;  // the count wraps around
    for (std::uint32_t i = 0; i < 60; ++i) {
      const Data jpeg = some_jpeg(rng, 20'000);
      jpegs[first + i] = jpeg;
      for (const Data& slice : slices_of(jpeg, first + i)) sent.push_back(slice);
    }
    Assembler assembler;
    const auto datagrams = disturbed(sent, 0.02, 10, rng);
    const auto pictures = pictures_of(assembler, datagrams);
    for (const auto& [id, jpeg] : pictures) EXPECT_EQ(jpeg, jpegs.at(id));
    for (std::size_t i = 1; i < pictures.size(); ++i)
      EXPECT_GT(static_cast<std::int32_t>(pictures[i].first - pictures[i - 1].first), 0);
    // 20 slices of a picture are all there with 0.98^20 = 67 %; 60 pictures, five sigmas.
    EXPECT_GT(pictures.size(), 60 * 0.67 - 5 * 3.7);
    EXPECT_EQ(assembler.counts().pictures, pictures.size());
    EXPECT_EQ(assembler.counts().refused, 0u);
  });
}

TEST(JpegSlices, WithoutLossEveryPictureComesOutThoughSlicesOvertakeEachOther) {
  for_all(20, [](Rng& rng) {
    std::vector<Data> sent;
    for (std::uint32_t i = 0; i < 30; ++i)
      for (const Data& slice : slices_of(some_jpeg(rng, 20'000), i)) sent.push_back(slice);
    Assembler assembler;
    EXPECT_EQ(pictures_of(assembler, disturbed(sent, 0, 10, rng)).size(), 30u);
  });
}

TEST(JpegSlices, APictureThatIsNotWholeIsGivenUpWhenALaterOneIs) {
  Rng rng{1};
  const Data jpeg = some_jpeg(rng, 3000);
  auto cut = slices_of(jpeg, 1);
  const Data last = cut.back();
  cut.pop_back();
  Assembler assembler;
  EXPECT_TRUE(pictures_of(assembler, cut).empty());
  EXPECT_THAT(pictures_of(assembler, slices_of(jpeg, 2)), ElementsAre(std::pair{2u, jpeg}));
  EXPECT_FALSE(assembler.take(last));
  EXPECT_EQ(assembler.counts().given_up, 1u);
  EXPECT_EQ(assembler.counts().late, 1u);
}

TEST(JpegSlices, ASenderThatBeginsAnewIsHeard) {
  Rng rng{2};
  const Data jpeg = some_jpeg(rng, 3000);
  Assembler assembler;
  EXPECT_EQ(pictures_of(assembler, slices_of(jpeg, 5000)).size(), 1u);
  EXPECT_EQ(pictures_of(assembler, slices_of(jpeg, 4999)).size(), 0u) << "late";
  EXPECT_EQ(pictures_of(assembler, slices_of(jpeg, 0)).size(), 1u) << "a new sender";
  EXPECT_EQ(pictures_of(assembler, slices_of(jpeg, 1)).size(), 1u);
}

TEST(JpegSlices, NumbersThatAreWrongDoNotBlockThoseThatFollow) {
  Rng rng{3};
  const Data jpeg = some_jpeg(rng, 3000);
  Assembler assembler;
  for (std::uint32_t i = 0; i < 20; ++i) {
    // One slice each of many pictures that never come.
    (void)assembler.take(slices_of(jpeg, 0x10000000u * (i % 15 + 1)).front());
    EXPECT_EQ(pictures_of(assembler, slices_of(jpeg, i + 1)).size(), 1u) << i;
  }
}

TEST(JpegSlices, WhatContradictsItselfIsRefused) {
  Rng rng{4};
  const Data jpeg = some_jpeg(rng, 3000);
  const auto slices = slices_of(jpeg, 1);
  ASSERT_EQ(slices.size(), 3u);
  const auto with = [&](std::size_t at, std::uint8_t value) {
    Data bytes = slices[1];
    bytes[at] = value;
    return bytes;
  };
  Assembler assembler;
  EXPECT_FALSE(assembler.take(slices[0]));
  const std::vector<Data> wrong{
      {},                                               // nothing
      Data(slices[1].begin(), slices[1].begin() + 23),  // not even a header
      Data(slices[1].begin(), slices[1].end() - 1),     // shorter than it says
      with(4, 3),                                       // the fourth of three
      with(6, 4),                                       // the picture has three slices
      with(9, 1),                                       // the picture is longer than this says
      with(11, 255),                                    // 4 GB
      with(16, 77),                                     // another time
  };
  for (const Data& datagram : wrong) EXPECT_FALSE(assembler.take(datagram));
  EXPECT_EQ(assembler.counts().refused, wrong.size());
  // None of them has done any harm.
  EXPECT_FALSE(assembler.take(slices[1]));
  EXPECT_TRUE(assembler.take(slices[2]));
}

}  // namespace
}  // namespace gatefly::jpeg_slices
