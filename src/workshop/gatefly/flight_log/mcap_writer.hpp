// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gatefly::flight_log {

/// An MCAP file of JSON messages, written in one go: schemas, channels, chunks compressed by zstd,
/// indexes, statistics, summary. The same file for the same messages.
///
/// Source: MCAP format specification, https://mcap.dev/spec; checksums are CRC-32.
class McapWriter {
 public:
  using Channel = std::uint16_t;

  /// @throws std::runtime_error when it cannot be written.
  explicit McapWriter(std::filesystem::path path);
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// @param schema       its name: "foxglove.PoseInFrame"; several channels may share it.
  /// @param json_schema  what a message looks like; of a name that is known, not looked at.
  Channel add_channel(const std::string& topic, const std::string& schema,
                      std::string_view json_schema);

  /// @param time  of log and of publishing [ns]; need not ascend.
  /// @throws std::runtime_error e.g. disk full.
  void write(Channel channel, std::uint64_t time, std::string_view json);

  /// Completes the file. @throws std::runtime_error e.g. disk full.
  void finish();

 private:
  struct ChannelInfo {
    std::string topic;
    std::uint16_t schema = 0;
    std::uint64_t messages = 0;
    std::vector<std::pair<std::uint64_t, std::uint64_t>> index;  ///< Time, offset in the chunk.
  };
  struct Schema {
    std::string name, json;
  };
  struct Chunk {
    std::uint64_t first = 0, last = 0, start = 0, length = 0, indexes_length = 0, packed = 0,
                  unpacked = 0;
    std::vector<std::pair<Channel, std::uint64_t>> index_offsets;
  };

  void put(std::string_view bytes);
  void end_chunk();
  [[nodiscard]] std::string schema_record(std::size_t index) const;
  [[nodiscard]] std::string channel_record(std::size_t index) const;
  [[nodiscard]] std::string statistics() const;
  [[nodiscard]] static std::string chunk_index(const Chunk& chunk);

  std::filesystem::path path_;
  std::ofstream file_;
  std::uint64_t offset_ = 0;  ///< Place of the next byte in the file.
  std::uint32_t crc_ = 0;     ///< Checksum of the data section so far.
  std::vector<Schema> schemas_;
  std::vector<ChannelInfo> channels_;
  std::vector<Chunk> chunks_;
  std::string records_;                  ///< Records of the open chunk.
  std::uint64_t first_ = 0, last_ = 0;   ///< Its times.
  std::vector<std::uint32_t> sequence_;  ///< Number of each channel's messages.
};

}  // namespace gatefly::flight_log
