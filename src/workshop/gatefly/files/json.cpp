// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/json.hpp"

#include <cstddef>

#include "gatefly/files/text.hpp"

namespace gatefly::files {
namespace {

/// Beginning of a value, as JSON, until `room` bytes are full: the rest is not looked at.
template <class Json>
void add_shown(const Json& value, std::size_t room, std::string& text) {
  if (value.is_array()) {
    text += "[";
    for (const auto& part : value) {
      if (text.size() > room) break;
      if (&part != &value.front()) text += ", ";
      add_shown(part, room, text);
    }
    text += "]";
  } else if (value.is_object()) {
    text += "{";
    for (auto part = value.begin(); part != value.end() && text.size() <= room; ++part) {
      if (part != value.begin()) text += ",";
      text += '"' + one_line(part.key(), room) + "\":";
      add_shown(part.value(), room, text);
    }
    text += "}";
  } else if (value.is_string()) {
    const auto& whole = value.template get_ref<const std::string&>();
    text += Json(whole.substr(0, room)).dump(-1, ' ', false, Json::error_handler_t::replace);
  } else if (value.is_number_float()) {
    text += text_of(value.template get<double>(), 12);
  } else {
    text += value.dump();
  }
}

template <class Json>
std::string one_line_of(const Json& value) {
  if (value.is_null()) return "nothing";
  const std::size_t most = value.is_array() ? 200 : 60;
  std::string text;
  add_shown(value, most, text);
  return one_line(text, most);
}

}  // namespace

std::string shown(const nlohmann::json& value) { return one_line_of(value); }
std::string shown(const nlohmann::ordered_json& value) { return one_line_of(value); }

std::string json_text(const nlohmann::json& value) {
  return value.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}
std::string json_text(const nlohmann::ordered_json& value) {
  return value.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace gatefly::files
