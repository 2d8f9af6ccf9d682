// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace gatefly::foreign_logs {

/// Unusable ULog, and at which byte: "byte 1234: ...".
class UlogError : public std::runtime_error {
 public:
  UlogError(std::size_t byte, const std::string& what)
      : std::runtime_error("byte " + std::to_string(byte) + ": " + what) {}
};

/// PX4's log, a binary file: its header, the formats it defines, the messages of each topic.
///
/// Any bytes may be given. A file that was cut (power off) is read up to its last whole message.
class Ulog {
 public:
  /// A number in each message of a topic.
  struct Field {
    std::size_t offset = 0;  ///< In the message, behind its id [bytes].
    std::string type;        ///< One of the format's numbers: "float", "uint64_t" ...
  };
  struct Topic {
    std::string name;
    int instance = 0;
    std::string format;                 ///< By its name.
    std::vector<std::size_t> messages;  ///< First byte of each one's data in the file.
    std::vector<std::size_t> sizes;     ///< How long they are [bytes].
  };

  /// @throws UlogError
  explicit Ulog(std::string bytes);

  /// "sensor_combined", or "sensor_baro:1" for its second instance; nullptr when it has no message.
  [[nodiscard]] const Topic* topic(std::string_view name) const;
  /// Names as topic() takes them, of topics with messages.
  [[nodiscard]] std::vector<std::string> topics() const;
  /// Names of all numbers in a message of the topic: "q[0]", "esc[1].rpm"; the first 400 of them.
  [[nodiscard]] std::vector<std::string> fields(const Topic& topic) const;
  /// A number by its name; nullptr when there is none. Valid as long as this.
  [[nodiscard]] const Field* field(const Topic& topic, const std::string& name) const;
  /// The number in message `i`. NaN when the message is too short for it.
  [[nodiscard]] double number(const Topic& topic, const Field& field, std::size_t i) const;
  /// The same of a whole number, exactly: a stamp. -1 when it is none.
  [[nodiscard]] std::int64_t whole(const Topic& topic, const Field& field, std::size_t i) const;
  /// Whether the file ends within a message.
  [[nodiscard]] bool cut() const { return cut_; }

 private:
  struct Member {
    std::string type, name;
    std::size_t count = 1;
    bool is_array = false;
  };
  struct Format {
    std::vector<Member> members;
    std::map<std::string, Field> fields;  ///< All numbers, those of formats within it, too.
    std::size_t size = 0;
    bool laid_out = false;
  };

  void read();
  void read_flags(std::size_t at, std::size_t size);
  void add_format(std::size_t at, std::size_t size);
  void subscribe(std::size_t at, std::size_t size);
  void add_data(std::size_t at, std::size_t size);
  [[nodiscard]] Member member_in(std::string_view text, std::size_t at) const;
  /// Finds where the numbers of a format are. @param depth  of formats within formats.
  void lay_out(const std::string& name, std::size_t at, int depth);
  [[nodiscard]] std::uint64_t little(std::size_t at, std::size_t bytes) const;

  std::string bytes_;
  std::map<std::string, Format> formats_;
  std::map<unsigned, std::size_t> by_id_;  ///< Into topics_.
  std::vector<Topic> topics_;
  std::vector<std::size_t> appended_;  ///< Offsets of data appended after a crash, ascending.
  std::size_t fields_ = 0;             ///< Fields of all laid-out formats.
  bool cut_ = false;
};

}  // namespace gatefly::foreign_logs
