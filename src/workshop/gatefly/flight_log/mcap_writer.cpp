// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/mcap_writer.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <stdexcept>

#include <zlib.h>
#include <zstd.h>

namespace gatefly::flight_log {
namespace {

constexpr std::string_view kMagic{"\x89MCAP0\r\n", 8};
// A schema of number 0 would be none: they count from 1.
constexpr std::size_t kChunkBytes =
    1 << 20;  // [bytes] unpacked: what a viewer reads to show one moment
// Base64 of pictures and digits hold little that is said twice: 1 is as small as 3, in half the time.
constexpr int kZstdLevel = 1;

enum class Op : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

/// Little-endian numbers and strings with their length, one after the other.
class Bytes {
 public:
  template <class Number>
  Bytes& number(Number value) {
    static_assert(std::endian::native == std::endian::little);
    text_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  Bytes& string(std::string_view text) {
    number(static_cast<std::uint32_t>(text.size()));
    text_.append(text);
    return *this;
  }
  Bytes& raw(std::string_view bytes) {
    text_.append(bytes);
    return *this;
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

std::string record(Op op, std::string_view content) {
  return Bytes{}
      .number(static_cast<std::uint8_t>(op))
      .number(static_cast<std::uint64_t>(content.size()))
      .raw(content)
      .text();
}

std::uint32_t crc(std::uint32_t before, std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

/// A map of pairs has the length of its bytes before it.
template <class Pairs>
std::string map_of(const Pairs& pairs) {
  Bytes content;
  for (const auto& [key, value] : pairs) content.number(key).number(value);
  return Bytes{}.string(content.text()).text();
}

}  // namespace

McapWriter::McapWriter(std::filesystem::path path)
    : path_{std::move(path)}, file_{path_, std::ios::binary} {
  put(kMagic);
  put(record(Op::kHeader, Bytes{}.string("").string("gatefly").text()));
}

McapWriter::Channel McapWriter::add_channel(const std::string& topic, const std::string& schema,
                                            std::string_view json_schema) {
  const auto known = std::find_if(schemas_.begin(), schemas_.end(),
                                  [&](const Schema& other) { return other.name == schema; });
  const auto index = static_cast<std::size_t>(known - schemas_.begin());
  if (known == schemas_.end()) {
    schemas_.push_back({schema, std::string{json_schema}});
    records_ += schema_record(index);
  }
  channels_.push_back({.topic = topic,
                       .schema = static_cast<std::uint16_t>(index + 1),
                       .messages = 0,
                       .index = {}});
  sequence_.push_back(0);
  records_ += channel_record(channels_.size() - 1);
  return static_cast<Channel>(channels_.size() - 1);
}

std::string McapWriter::schema_record(std::size_t index) const {
  return record(Op::kSchema, Bytes{}
                                 .number(static_cast<std::uint16_t>(index + 1))
                                 .string(schemas_[index].name)
                                 .string("jsonschema")
                                 .string(schemas_[index].json)
                                 .text());
}

std::string McapWriter::channel_record(std::size_t index) const {
  return record(Op::kChannel, Bytes{}
                                  .number(static_cast<Channel>(index))
                                  .number(channels_[index].schema)
                                  .string(channels_[index].topic)
                                  .string("json")
                                  .string("")  // no metadata
                                  .text());
}

void McapWriter::write(Channel channel, std::uint64_t time, std::string_view json) {
  const bool first = std::all_of(channels_.begin(), channels_.end(),
                                 [](const ChannelInfo& c) { return c.index.empty(); });
  first_ = first ? time : std::min(first_, time);
  last_ = first ? time : std::max(last_, time);
  ChannelInfo& info = channels_.at(channel);
  info.index.emplace_back(time, records_.size());
  ++info.messages;
  // Header and content apart: no copy of a picture.
  constexpr std::size_t kMessageHead = 2 + 4 + 8 + 8;
  records_ += Bytes{}
                  .number(static_cast<std::uint8_t>(Op::kMessage))
                  .number(static_cast<std::uint64_t>(kMessageHead + json.size()))
                  .number(channel)
                  .number(sequence_[channel]++)
                  .number(time)
                  .number(time)
                  .text();
  records_ += json;
  if (records_.size() >= kChunkBytes) end_chunk();
}

void McapWriter::end_chunk() {
  if (records_.empty()) return;
  std::string packed(ZSTD_compressBound(records_.size()), '\0');
  const std::size_t size =
      ZSTD_compress(packed.data(), packed.size(), records_.data(), records_.size(), kZstdLevel);
  if (ZSTD_isError(size) != 0) throw std::runtime_error(path_.string() + ": zstd failed");
  packed.resize(size);

  Chunk chunk{.first = first_,
              .last = last_,
              .start = offset_,
              .packed = packed.size(),
              .unpacked = records_.size(),
              .index_offsets = {}};
  put(record(Op::kChunk, Bytes{}
                             .number(first_)
                             .number(last_)
                             .number(static_cast<std::uint64_t>(records_.size()))
                             .number(crc(0, records_))
                             .string("zstd")
                             .number(static_cast<std::uint64_t>(packed.size()))
                             .raw(packed)
                             .text()));
  chunk.length = offset_ - chunk.start;
  const std::uint64_t indexes = offset_;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    auto& index = channels_[i].index;
    if (index.empty()) continue;
    std::stable_sort(index.begin(), index.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    chunk.index_offsets.emplace_back(static_cast<Channel>(i), offset_);
    put(record(Op::kMessageIndex,
               Bytes{}.number(static_cast<Channel>(i)).raw(map_of(index)).text()));
    index.clear();
  }
  chunk.indexes_length = offset_ - indexes;
  chunks_.push_back(std::move(chunk));
  records_.clear();
  first_ = last_ = 0;
}

std::string McapWriter::chunk_index(const Chunk& chunk) {
  return record(Op::kChunkIndex, Bytes{}
                                     .number(chunk.first)
                                     .number(chunk.last)
                                     .number(chunk.start)
                                     .number(chunk.length)
                                     .raw(map_of(chunk.index_offsets))
                                     .number(chunk.indexes_length)
                                     .string("zstd")
                                     .number(chunk.packed)
                                     .number(chunk.unpacked)
                                     .text());
}

std::string McapWriter::statistics() const {
  std::uint64_t messages = 0, first = std::numeric_limits<std::uint64_t>::max(), last = 0;
  std::vector<std::pair<Channel, std::uint64_t>> counts;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    messages += channels_[i].messages;
    counts.emplace_back(static_cast<Channel>(i), channels_[i].messages);
  }
  for (const Chunk& chunk : chunks_)
    first = std::min(first, chunk.first), last = std::max(last, chunk.last);
  return record(Op::kStatistics, Bytes{}
                                     .number(messages)
                                     .number(static_cast<std::uint16_t>(schemas_.size()))
                                     .number(static_cast<std::uint32_t>(channels_.size()))
                                     .number(std::uint32_t{0})  // attachments
                                     .number(std::uint32_t{0})  // metadata
                                     .number(static_cast<std::uint32_t>(chunks_.size()))
                                     .number(chunks_.empty() ? 0 : first)
                                     .number(last)
                                     .raw(map_of(counts))
                                     .text());
}

void McapWriter::finish() {
  end_chunk();
  put(record(Op::kDataEnd, Bytes{}.number(crc_).text()));

  // The summary: each kind of record in a group, and where the groups are.
  const std::uint64_t summary_start = offset_;
  std::string summary, offsets;
  const auto add_group = [&](Op op, const std::string& records) {
    if (records.empty()) return;
    offsets += record(Op::kSummaryOffset, Bytes{}
                                              .number(static_cast<std::uint8_t>(op))
                                              .number(summary_start + summary.size())
                                              .number(static_cast<std::uint64_t>(records.size()))
                                              .text());
    summary += records;
  };
  std::string schemas, channels, chunks;
  for (std::size_t i = 0; i < schemas_.size(); ++i) schemas += schema_record(i);
  for (std::size_t i = 0; i < channels_.size(); ++i) channels += channel_record(i);
  for (const Chunk& chunk : chunks_) chunks += chunk_index(chunk);
  add_group(Op::kSchema, schemas);
  add_group(Op::kChannel, channels);
  add_group(Op::kStatistics, statistics());
  add_group(Op::kChunkIndex, chunks);

  // The footer's checksum covers the summary and the footer up to itself.
  constexpr std::uint64_t kFooterBytes = 8 + 8 + 4;
  const std::uint64_t offsets_start = summary_start + summary.size();
  const std::string footer = Bytes{}
                                 .number(static_cast<std::uint8_t>(Op::kFooter))
                                 .number(kFooterBytes)
                                 .number(summary_start)
                                 .number(offsets_start)
                                 .text();
  summary += offsets + footer;
  put(summary);
  put(Bytes{}.number(crc(0, summary)).text());
  put(kMagic);
  file_.close();
  if (!file_) throw std::runtime_error(path_.string() + ": cannot be written (disk full?)");
}

void McapWriter::put(std::string_view bytes) {
  file_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file_) throw std::runtime_error(path_.string() + ": cannot be written (disk full?)");
  offset_ += bytes.size();
  crc_ = crc(crc_, bytes);
}

}  // namespace gatefly::flight_log
