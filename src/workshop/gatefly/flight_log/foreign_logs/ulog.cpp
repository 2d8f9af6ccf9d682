// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/foreign_logs/ulog.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <limits>
#include <utility>

namespace gatefly::foreign_logs {
namespace {

constexpr std::string_view kMagic{"ULog\x01\x12\x35"};
constexpr std::size_t kHeader = 16, kMessageHeader = 3;  // [bytes]
constexpr std::size_t kMostMessage = 65535;              // of a message, by its size's two bytes
constexpr std::size_t kMostFormats = 4096, kMostTopics = 4096, kMostMembers = 512;
constexpr std::size_t kMostFields = 100'000;  // of all formats
constexpr int kDeepest = 8;                   // formats within formats
constexpr std::uint8_t kAppended = 1;         // the only incompatible flag there is

struct Type {
  std::string_view name;
  std::size_t size;
};
constexpr std::array kTypes{Type{"int8_t", 1},   Type{"uint8_t", 1},  Type{"int16_t", 2},
                            Type{"uint16_t", 2}, Type{"int32_t", 4},  Type{"uint32_t", 4},
                            Type{"int64_t", 8},  Type{"uint64_t", 8}, Type{"float", 4},
                            Type{"double", 8},   Type{"bool", 1},     Type{"char", 1}};

std::size_t size_of(std::string_view type) {
  for (const Type& known : kTypes)
    if (known.name == type) return known.size;
  return 0;
}

bool is_name(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '/' || c == '-';
  });
}

/// A text of the file, for an error: no control characters.
std::string shown(std::string_view text) {
  std::string result{text.substr(0, 40)};
  std::replace_if(
      result.begin(), result.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return "'" + result + "'";
}

}  // namespace

Ulog::Ulog(std::string bytes) : bytes_{std::move(bytes)} { read(); }

std::uint64_t Ulog::little(std::size_t at, std::size_t bytes) const {
  std::uint64_t value = 0;
  for (std::size_t i = bytes; i-- > 0;)
    value = value << 8U | static_cast<std::uint8_t>(bytes_[at + i]);
  return value;
}

void Ulog::read() {
  if (bytes_.size() < kHeader || !bytes_.starts_with(kMagic))
    throw UlogError(0, "is no ULog, which begins with 'ULog'");
  if (const int version = static_cast<std::uint8_t>(bytes_[7]); version > 1)
    throw UlogError(7, "ULog version " + std::to_string(version) + ", must be 0 or 1");
  std::size_t next_appended = 0;
  for (std::size_t at = kHeader; at < bytes_.size();) {
    // Appended data begins at its offset, whatever stands there: the message before may be cut.
    const std::size_t end =
        next_appended < appended_.size() ? appended_[next_appended] : bytes_.size();
    if (end - at < kMessageHeader || end - at - kMessageHeader < little(at, 2)) {
      if (end == bytes_.size()) {
        cut_ = true;
        break;
      }
      at = end, ++next_appended;
      continue;
    }
    const std::size_t size = little(at, 2), payload = at + kMessageHeader;
    switch (bytes_[at + 2]) {
      case 'B':
        read_flags(payload, size);
        break;
      case 'F':
        add_format(payload, size);
        break;
      case 'A':
        subscribe(payload, size);
        break;
      case 'R':
        if (size >= 2) by_id_.erase(static_cast<unsigned>(little(payload, 2)));
        break;
      case 'D':
        add_data(payload, size);
        break;
      case 'I':
      case 'M':
      case 'P':
      case 'Q':
      case 'L':
      case 'C':
      case 'S':
      case 'O':
        break;  // information, parameters, texts, drop-outs: nothing that flies
      default:
        throw UlogError(at + 2, "a message of type " + shown({&bytes_[at + 2], 1}) +
                                    ", which there is not: damaged");
    }
    at = payload + size;
    while (next_appended < appended_.size() && at >= appended_[next_appended]) ++next_appended;
  }
}

void Ulog::read_flags(std::size_t at, std::size_t size) {
  constexpr std::size_t kSize = 40;
  if (at != kHeader + kMessageHeader || size < kSize)
    throw UlogError(at, "flags must be the first message, of 40 bytes");
  for (std::size_t i = 0; i < 8; ++i) {
    const auto flags = static_cast<std::uint8_t>(bytes_[at + 8 + i]);
    if ((i == 0 ? flags & ~kAppended : flags) != 0)
      throw UlogError(at + 8 + i, "written in a way that came after this program (unknown flag)");
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint64_t offset = little(at + 16 + 8 * i, 8);
    if (offset == 0) continue;
    const std::size_t before = appended_.empty() ? at + size : appended_.back() + 1;
    if (offset < before || offset > bytes_.size())
      throw UlogError(at + 16 + 8 * i,
                      "data appended at " + std::to_string(offset) + ", which is not in the file");
    if (offset < bytes_.size()) appended_.push_back(offset);
  }
}

Ulog::Member Ulog::member_in(std::string_view text, std::size_t at) const {
  const std::size_t blank = text.find(' ');
  if (blank == std::string_view::npos)
    throw UlogError(at, "a format's part " + shown(text) + ", must be 'type name'");
  Member member;
  std::string_view type = text.substr(0, blank);
  const std::string_view name = text.substr(blank + 1);
  if (const std::size_t open = type.find('['); open != std::string_view::npos) {
    const std::string_view count = type.substr(open + 1);
    const char* const end = count.data() + count.size();
    const auto [rest, error] = std::from_chars(count.data(), end, member.count);
    if (error != std::errc{} || end - rest != 1 || *rest != ']' || member.count < 1 ||
        member.count > kMostMessage)
      throw UlogError(at, "a format's part " + shown(text) + ", has no usable length");
    member.is_array = true;
    type = type.substr(0, open);
  }
  if (!is_name(type) || !is_name(name))
    throw UlogError(at, "a format's part " + shown(text) + ", has no usable name");
  member.type = type, member.name = name;
  return member;
}

void Ulog::add_format(std::size_t at, std::size_t size) {
  std::string_view text = std::string_view{bytes_}.substr(at, size);
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos || !is_name(text.substr(0, colon)))
    throw UlogError(at, "a format without a name");
  if (formats_.size() >= kMostFormats) throw UlogError(at, "more formats than any log has");
  Format format;
  const std::string name{text.substr(0, colon)};
  text.remove_prefix(colon + 1);
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(';'), text.size());
    if (end > 0) format.members.push_back(member_in(text.substr(0, end), at));
    if (format.members.size() > kMostMembers)
      throw UlogError(at, "format " + shown(name) + " has more parts than any has");
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  formats_.emplace(name, std::move(format));  // the first one counts
}

void Ulog::lay_out(const std::string& name, std::size_t at, int depth) {
  const auto found = formats_.find(name);
  if (found == formats_.end()) throw UlogError(at, "format " + shown(name) + " is not defined");
  Format& format = found->second;
  if (format.laid_out) return;
  if (depth > kDeepest)
    throw UlogError(at, "format " + shown(name) + " has formats in formats without end");
  for (const Member& member : format.members) {
    std::size_t size = size_of(member.type);
    const Format* within = nullptr;
    if (size == 0) {
      lay_out(member.type, at, depth + 1);
      within = &formats_.at(member.type);
      size = within->size;
    }
    for (std::size_t i = 0; i < member.count; ++i) {
      const std::string own =
          member.name + (member.is_array ? "[" + std::to_string(i) + "]" : std::string{});
      if (within == nullptr)
        format.fields.try_emplace(own, Field{format.size, member.type});
      else
        for (const auto& [part, field] : within->fields)
          format.fields.try_emplace(own + "." + part,
                                    Field{format.size + field.offset, field.type});
      format.size += size;
      if (format.size > kMostMessage || fields_ + format.fields.size() > kMostFields)
        throw UlogError(at, "format " + shown(name) + " is longer than any message");
    }
  }
  if (format.size == 0) throw UlogError(at, "format " + shown(name) + " has no parts");
  fields_ += format.fields.size();
  format.laid_out = true;
}

void Ulog::subscribe(std::size_t at, std::size_t size) {
  if (size < 4) throw UlogError(at, "a topic without a name");
  const auto id = static_cast<unsigned>(little(at + 1, 2));
  const std::string name{std::string_view{bytes_}.substr(at + 3, size - 3)};
  if (!is_name(name)) throw UlogError(at + 3, "a topic named " + shown(name));
  const int instance = static_cast<std::uint8_t>(bytes_[at]);
  lay_out(name, at, 0);
  const auto same = std::find_if(topics_.begin(), topics_.end(), [&](const Topic& topic) {
    return topic.name == name && topic.instance == instance;
  });
  by_id_[id] = static_cast<std::size_t>(same - topics_.begin());
  if (same != topics_.end()) return;
  if (topics_.size() >= kMostTopics) throw UlogError(at, "more topics than any log has");
  topics_.push_back(
      {.name = name, .instance = instance, .format = name, .messages = {}, .sizes = {}});
}

void Ulog::add_data(std::size_t at, std::size_t size) {
  if (size < 2) throw UlogError(at, "data without the id of its topic");
  const auto id = static_cast<unsigned>(little(at, 2));
  const auto found = by_id_.find(id);
  if (found == by_id_.end())
    throw UlogError(at, "data of topic " + std::to_string(id) + ", which nobody has named");
  Topic& topic = topics_[found->second];
  topic.messages.push_back(at + 2);
  topic.sizes.push_back(size - 2);
}

const Ulog::Topic* Ulog::topic(std::string_view name) const {
  int instance = 0;
  if (const std::size_t colon = name.find(':'); colon != std::string_view::npos) {
    const std::string_view number = name.substr(colon + 1);
    const auto result = std::from_chars(number.data(), number.data() + number.size(), instance);
    if (result.ec != std::errc{} || result.ptr != number.data() + number.size()) return nullptr;
    name = name.substr(0, colon);
  }
  for (const Topic& topic : topics_)
    if (topic.name == name && topic.instance == instance && !topic.messages.empty()) return &topic;
  return nullptr;
}

std::vector<std::string> Ulog::topics() const {
  std::vector<std::string> names;
  for (const Topic& topic : topics_)
    if (!topic.messages.empty())
      names.push_back(topic.name +
                      (topic.instance > 0 ? ":" + std::to_string(topic.instance) : ""));
  return names;
}

std::vector<std::string> Ulog::fields(const Topic& topic) const {
  constexpr std::size_t kMost = 400;
  std::vector<std::string> names;
  for (const auto& [name, field] : formats_.at(topic.format).fields) {
    if (names.size() == kMost) break;
    names.push_back(name);
  }
  return names;
}

const Ulog::Field* Ulog::field(const Topic& topic, const std::string& name) const {
  const auto& fields = formats_.at(topic.format).fields;
  const auto found = fields.find(name);
  return found == fields.end() ? nullptr : &found->second;
}

double Ulog::number(const Topic& topic, const Field& field, std::size_t i) const {
  const std::size_t size = size_of(field.type);
  if (field.offset + size > topic.sizes[i]) return std::numeric_limits<double>::quiet_NaN();
  const std::uint64_t bits = little(topic.messages[i] + field.offset, size);
  if (field.type == "float") return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
  if (field.type == "double") return std::bit_cast<double>(bits);
  if (field.type.starts_with("int")) {
    const unsigned unused = 64U - 8U * static_cast<unsigned>(size);
    return static_cast<double>(static_cast<std::int64_t>(bits << unused) >> unused);
  }
  return static_cast<double>(bits);
}

std::int64_t Ulog::whole(const Topic& topic, const Field& field, std::size_t i) const {
  const std::size_t size = size_of(field.type);
  if (field.offset + size > topic.sizes[i] || !field.type.starts_with("uint")) return -1;
  const std::uint64_t value = little(topic.messages[i] + field.offset, size);
  constexpr auto kMost = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  return value > kMost ? -1 : static_cast<std::int64_t>(value);
}

}  // namespace gatefly::foreign_logs
