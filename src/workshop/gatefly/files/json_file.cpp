// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/json_file.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <system_error>

#include "gatefly/files/json.hpp"
#include "gatefly/files/text.hpp"

namespace gatefly::files {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uintmax_t kMostJsonBytes = std::uintmax_t{32} << 20;
constexpr std::size_t kDeepest = 64, kMostMembers = 10'000;  // looked for one by one
constexpr std::size_t kMostValues = 2'000'000;  // twice the seeds of the longest campaign

/// Goes through a text before values are made of it.
class Bounds : public nlohmann::json_sax<Json> {
 public:
  /// Both must live as long.
  Bounds(const std::string& text, const std::string& name) : text_{text}, name_{name} {}

  bool null() override { return counted(); }
  bool boolean(bool) override { return counted(); }
  bool number_integer(number_integer_t) override { return counted(); }
  bool number_unsigned(number_unsigned_t) override { return counted(); }
  bool number_float(number_float_t, const string_t&) override { return counted(); }
  bool string(string_t&) override { return counted(); }
  bool binary(binary_t&) override { return counted(); }
  bool start_object(std::size_t) override { return opened(); }
  bool end_object() override { return closed(); }
  bool start_array(std::size_t) override { return opened(); }
  bool end_array() override { return closed(); }
  bool key(string_t&) override {
    if (++keys_.back() > kMostMembers)
      refuse("has an object of more than " + std::to_string(kMostMembers) + " members");
    return true;
  }
  bool parse_error(std::size_t byte, const std::string&, const Json::exception&) override {
    const auto end = text_.begin() + static_cast<std::ptrdiff_t>(std::min(byte, text_.size()));
    const auto line = 1 + std::count(text_.begin(), end, '\n');
    throw std::runtime_error(name_ + ": is damaged, not valid JSON from line " +
                             std::to_string(line) + " on" +
                             (byte >= text_.size() ? ", where it ends early" : ""));
  }

 private:
  bool counted() {
    if (++values_ > kMostValues)
      refuse("holds more than " + std::to_string(kMostValues) + " values");
    return true;
  }
  bool opened() {
    keys_.push_back(0);
    if (keys_.size() > kDeepest)
      refuse("is nested more than " + std::to_string(kDeepest) + " levels deep");
    return counted();
  }
  bool closed() {
    keys_.pop_back();
    return true;
  }
  [[noreturn]] void refuse(const std::string& what) const {
    throw std::runtime_error(name_ + ": " + what + ", which no file of gatefly does");
  }

  const std::string &text_, &name_;
  std::size_t values_ = 0;
  std::vector<std::size_t> keys_;  ///< Keys of each open object.
};

std::string range_text(std::uint64_t low, std::uint64_t high) {
  return high == std::numeric_limits<std::uint64_t>::max()
             ? std::to_string(low) + " or more"
             : "in " + std::to_string(low) + ".." + std::to_string(high);
}

bool is_whole(const Json& value, std::uint64_t low, std::uint64_t high) {
  if (!value.is_number_unsigned() && !(value.is_number_integer() && value.get<std::int64_t>() >= 0))
    return false;
  return value.get<std::uint64_t>() >= low && value.get<std::uint64_t>() <= high;
}

bool is_number_or_null(const Json& value) { return value.is_number() || value.is_null(); }

double number_in(const Json& value) {
  return value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

Json read_json(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    throw std::runtime_error(path.string() + ": is no regular file");  // a pipe would be waited for
  return json_of(read_file(path, kMostJsonBytes), path.string());
}

Json json_of(const std::string& text, const std::string& name) {
  Bounds bounds{text, name};
  (void)Json::sax_parse(text, &bounds);
  return Json::parse(text);
}

JsonObject::JsonObject(const std::string& file, const Json& value)
    : JsonObject{file, std::string{}, value} {}

JsonObject::JsonObject(std::string file, std::string before, const Json& value)
    : file_{std::move(file)}, before_{std::move(before)}, value_{&value} {
  if (value.is_object()) return;
  const std::string name = before_.substr(0, before_.rfind('.'));
  throw std::runtime_error(file_ + ": " + (name.empty() ? "is " : name + " = ") + shown(value) +
                           ", must be an object");
}

const Json* JsonObject::find(std::string_view key) const {
  const auto found = value_->find(std::string{key});
  return found == value_->end() || found->is_null() ? nullptr : &*found;
}

bool JsonObject::has(std::string_view key) const { return find(key) != nullptr; }

void JsonObject::fail(std::string_view key, const std::string& what) const {
  const Json* const value = find(key);
  throw std::runtime_error(file_ + ": " + before_ + std::string{key} +
                           (value == nullptr ? " is missing" : " = " + shown(*value)) +
                           ", must be " + what);
}

JsonObject JsonObject::object(std::string_view key) const {
  const Json* const value = find(key);
  if (value == nullptr || !value->is_object()) fail(key, "an object");
  return {file_, before_ + std::string{key} + ".", *value};
}

std::vector<JsonObject> JsonObject::objects(std::string_view key, std::size_t most) const {
  const Json* const list = find(key);
  if (list == nullptr || !list->is_array() || list->size() > most ||
      !std::all_of(list->begin(), list->end(), [](const Json& each) { return each.is_object(); }))
    fail(key, "a list of at most " + std::to_string(most) + " objects");
  std::vector<JsonObject> objects;
  for (std::size_t i = 0; i < list->size(); ++i)
    objects.push_back(
        JsonObject{file_, before_ + std::string{key} + "[" + std::to_string(i) + "].", (*list)[i]});
  return objects;
}

bool JsonObject::truth(std::string_view key) const {
  const Json* const value = find(key);
  if (value == nullptr || !value->is_boolean()) fail(key, "true or false");
  return value->get<bool>();
}

double JsonObject::number(std::string_view key) const {
  const Json* const value = find(key);
  if (value == nullptr || !std::isfinite(number_in(*value))) fail(key, "a number");
  return number_in(*value);
}

double JsonObject::number_or_null(std::string_view key) const {
  const auto found = value_->find(std::string{key});
  if (found == value_->end() || !is_number_or_null(*found)) fail(key, "a number or null");
  return number_in(*found);
}

std::vector<double> JsonObject::numbers_or_null(std::string_view key, std::size_t count) const {
  const Json* const list = find(key);
  if (list == nullptr && value_->contains(std::string{key}))  // null
    return std::vector<double>(count, std::numeric_limits<double>::quiet_NaN());
  if (list == nullptr || !list->is_array() || list->size() != count ||
      !std::all_of(list->begin(), list->end(), is_number_or_null))
    fail(key, "a list of " + std::to_string(count) + " numbers");
  std::vector<double> numbers;
  for (const Json& each : *list) numbers.push_back(number_in(each));
  return numbers;
}

std::uint64_t JsonObject::whole(std::string_view key, std::uint64_t low, std::uint64_t high) const {
  const Json* const value = find(key);
  if (value == nullptr || !is_whole(*value, low, high))
    fail(key, "a whole number, " + range_text(low, high));
  return value->get<std::uint64_t>();
}

std::vector<std::uint64_t> JsonObject::wholes(std::string_view key, std::size_t count,
                                              std::uint64_t low, std::uint64_t high) const {
  const Json* const value = find(key);
  if (value == nullptr || !value->is_array() || value->size() != count ||
      !std::all_of(value->begin(), value->end(),
                   [&](const Json& each) { return is_whole(each, low, high); }))
    fail(key, "a list of " + std::to_string(count) + " whole numbers, " + range_text(low, high));
  return value->get<std::vector<std::uint64_t>>();
}

int JsonObject::count(std::string_view key) const {
  constexpr std::uint64_t kMost = 1'000'000'000;
  return static_cast<int>(whole(key, 0, kMost));
}

std::string JsonObject::text(std::string_view key) const {
  const Json* const value = find(key);
  if (value == nullptr || !value->is_string()) fail(key, "text");
  return value->get<std::string>();
}

std::string JsonObject::text(std::string_view key, const std::string& fallback) const {
  return has(key) ? text(key) : fallback;
}

}  // namespace gatefly::files
