// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/mcap_writer.hpp"

#include <cstring>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>
#include <zstd.h>

#include "gatefly/files/text.hpp"

#include "support/temp_folder.hpp"

namespace gatefly::flight_log {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Reads numbers and strings one after the other.
class Cursor {
 public:
  explicit Cursor(std::string_view bytes) : rest_{bytes} {}
  template <class Number>
  Number number() {
    Number value{};
    EXPECT_LE(sizeof value, rest_.size());
    std::memcpy(&value, rest_.data(), sizeof value);
    rest_.remove_prefix(sizeof value);
    return value;
  }
  std::string_view bytes(std::size_t count) {
    EXPECT_LE(count, rest_.size());
    const std::string_view taken = rest_.substr(0, count);
    rest_.remove_prefix(taken.size());
    return taken;
  }
  std::string string() { return std::string{bytes(number<std::uint32_t>())}; }
  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
};

struct Record {
  int op = 0;
  std::size_t at = 0, length = 0;  ///< In what they are records of.
  std::string_view content;
};

std::vector<Record> records_of(std::string_view bytes) {
  std::vector<Record> records;
  Cursor cursor{bytes};
  while (!cursor.rest().empty() && !cursor.rest().starts_with("\x89MCAP")) {
    const std::size_t at = bytes.size() - cursor.rest().size();
    const int op = cursor.number<std::uint8_t>();
    const auto size = cursor.number<std::uint64_t>();
    records.push_back({op, at, 9 + size, cursor.bytes(size)});
  }
  return records;
}

std::uint32_t crc(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

struct Message {
  int channel = 0;
  std::uint64_t time = 0;
  std::string json;
};

/// All there is to read in a file, by the specification.
struct Mcap {
  explicit Mcap(const std::string& file) {
    EXPECT_EQ(file.substr(0, 8), (std::string{"\x89MCAP0\r\n", 8}));
    EXPECT_EQ(file.substr(file.size() - 8), file.substr(0, 8));
    for (const Record& record : records_of(std::string_view{file}.substr(8))) {
      ops.push_back(record.op);
      if (record.op == 0x06) read_chunk(record);
      if (record.op == 0x08) {
        Cursor index{record.content};
        index.bytes(16);
        const auto start = index.number<std::uint64_t>(), length = index.number<std::uint64_t>();
        EXPECT_EQ(file[start], 0x06);
        EXPECT_EQ(records_of(std::string_view{file}.substr(start, length)).size(), 1u);
        const std::string map = index.string();
        Cursor offsets{map};
        while (!offsets.rest().empty()) {
          const auto channel = offsets.number<std::uint16_t>();
          const auto offset = offsets.number<std::uint64_t>();
          EXPECT_EQ(file[offset], 0x07);
          Cursor message_index{std::string_view{file}.substr(offset + 9)};
          EXPECT_EQ(message_index.number<std::uint16_t>(), channel);
        }
        ++indexed_chunks;
      }
      if (record.op == 0x0B) {
        Cursor statistics{record.content};
        counted = statistics.number<std::uint64_t>();
        statistics.bytes(2 + 4 + 4 + 4 + 4);
        first = statistics.number<std::uint64_t>(), last = statistics.number<std::uint64_t>();
      }
      if (record.op == 0x0F) {
        EXPECT_EQ(Cursor{record.content}.number<std::uint32_t>(),
                  crc(std::string_view{file}.substr(0, 8 + record.at)));
      }
      if (record.op == 0x02) {
        Cursor footer{record.content};
        const auto start = footer.number<std::uint64_t>();
        footer.bytes(8);
        const std::size_t end = file.size() - 8 - 4;
        EXPECT_EQ(footer.number<std::uint32_t>(),
                  crc(std::string_view{file}.substr(start, end - start)));
      }
    }
  }

  void read_chunk(const Record& record) {
    Cursor chunk{record.content};
    const auto from = chunk.number<std::uint64_t>(), to = chunk.number<std::uint64_t>();
    std::string text(chunk.number<std::uint64_t>(), '\0');
    const auto checksum = chunk.number<std::uint32_t>();
    EXPECT_EQ(chunk.string(), "zstd");
    const auto packed = chunk.bytes(chunk.number<std::uint64_t>());
    ASSERT_EQ(ZSTD_decompress(text.data(), text.size(), packed.data(), packed.size()), text.size());
    EXPECT_EQ(crc(text), checksum);
    for (const Record& inner : records_of(text)) {
      Cursor cursor{inner.content};
      if (inner.op == 0x03) {
        EXPECT_EQ(cursor.number<std::uint16_t>(), schemas.size() + 1);
        schemas.push_back(cursor.string());
      } else if (inner.op == 0x04) {
        const auto id = cursor.number<std::uint16_t>();
        EXPECT_LE(cursor.number<std::uint16_t>(), schemas.size());
        channels[id] = cursor.string();
        EXPECT_EQ(cursor.string(), "json");
      } else if (inner.op == 0x05) {
        Message message;
        message.channel = cursor.number<std::uint16_t>();
        EXPECT_EQ(cursor.number<std::uint32_t>(), sequence[message.channel]++);
        message.time = cursor.number<std::uint64_t>();
        EXPECT_EQ(cursor.number<std::uint64_t>(), message.time);
        EXPECT_TRUE(from <= message.time && message.time <= to);
        message.json = cursor.rest();
        messages.push_back(std::move(message));
      }
    }
  }

  std::vector<int> ops;
  std::vector<std::string> schemas;
  std::map<int, std::string> channels;
  std::map<int, std::uint32_t> sequence;
  std::vector<Message> messages;
  std::uint64_t counted = 0, first = 0, last = 0;
  int indexed_chunks = 0;
};

TEST(McapWriter, HasWhatTheSpecificationWantsInItsOrder) {
  const test::TempFolder folder;
  McapWriter writer(folder.path() / "a.mcap");
  const auto a = writer.add_channel("/a", "one", R"({"type":"object"})"),
             b = writer.add_channel("/b", "one", ""), c = writer.add_channel("/c", "two", "{}");
  writer.write(a, 5, R"({"x":1})");
  writer.write(b, 3, "{}");
  writer.write(a, 7, R"({"x":2})");
  writer.finish();
  (void)c;

  const Mcap mcap(files::read_file(folder.path() / "a.mcap"));
  // Header, chunk, an index of each channel that is in it, end of data; schemas, channels,
  // statistics, chunk index, offsets of these four groups, footer.
  EXPECT_THAT(mcap.ops, ElementsAre(0x01, 0x06, 0x07, 0x07, 0x0F, 0x03, 0x03, 0x04, 0x04, 0x04,
                                    0x0B, 0x08, 0x0E, 0x0E, 0x0E, 0x0E, 0x02));
  EXPECT_THAT(mcap.schemas, ElementsAre("one", "two"));
  EXPECT_EQ(mcap.channels.at(2), "/c");
  ASSERT_EQ(mcap.messages.size(), 3u);
  EXPECT_EQ(mcap.messages[2].json, R"({"x":2})");
  EXPECT_EQ(mcap.messages[1].time, 3u);
  EXPECT_EQ(mcap.counted, 3u);
  EXPECT_EQ(mcap.first, 3u);
  EXPECT_EQ(mcap.last, 7u);
}

TEST(McapWriter, ManyMessagesAreManyChunksEachIndexed) {
  const test::TempFolder folder;
  for (const char* name : {"a.mcap", "b.mcap"}) {
    McapWriter writer(folder.path() / name);
    const auto channel = writer.add_channel("/a", "one", "{}");
    for (std::uint64_t i = 0; i < 30; ++i) writer.write(channel, i, std::string(100'000, '7'));
    writer.finish();
  }
  const std::string file = files::read_file(folder.path() / "a.mcap");
  EXPECT_EQ(file, files::read_file(folder.path() / "b.mcap"));
  const Mcap mcap(file);
  EXPECT_EQ(mcap.messages.size(), 30u);
  EXPECT_EQ(mcap.indexed_chunks, 3);
}

TEST(McapWriter, WithoutMessagesItIsStillWhole) {
  const test::TempFolder folder;
  McapWriter writer(folder.path() / "a.mcap");
  writer.finish();
  const Mcap mcap(files::read_file(folder.path() / "a.mcap"));
  EXPECT_THAT(mcap.ops, ElementsAre(0x01, 0x0F, 0x0B, 0x0E, 0x02));
}

TEST(McapWriter, AFolderThatIsNotThereIsOneLine) {
  EXPECT_THAT(test::error_of([] { McapWriter{"/nowhere/a.mcap"}; }),
              HasSubstr("/nowhere/a.mcap: cannot be written"));
}

}  // namespace
}  // namespace gatefly::flight_log
