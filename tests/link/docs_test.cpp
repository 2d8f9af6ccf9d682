// SPDX-License-Identifier: Apache-2.0
// The tables of docs/link.md are what the layouts say.
#include <array>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <tuple>

#include <gtest/gtest.h>

#include "gatefly/link/jpeg_slices.hpp"
#include "gatefly/link/layout.hpp"
#include "gatefly/link/mavlink_commands.hpp"
#include "gatefly/link/mavlink_hil.hpp"
#include "gatefly/link/mavlink_telemetry.hpp"
#include "gatefly/link/msp_messages.hpp"

namespace gatefly::link {
namespace {

/// uint16_t is u16 in a table.
std::string short_name(std::string_view type) {
  if (type == "float") return "f32";
  if (type == "char") return "char";
  std::string name{type.starts_with('u') ? "u" : "i"};
  for (const char c : type)
    if (c >= '0' && c <= '9') name += c;
  return name;
}

class Row {
 public:
  template <WireNumber T>
  void operator()(std::string_view name, const T&, std::string_view meaning) {
    add(name, short_name(wire_name<T>()), meaning);
  }
  template <WireNumber T, std::size_t N>
  void operator()(std::string_view name, const std::array<T, N>&, std::string_view meaning) {
    add(name, short_name(wire_name<T>()) + "[" + std::to_string(N) + "]", meaning);
  }
  void later() { text_ += " · *not always:*"; }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  void add(std::string_view name, const std::string& type, std::string_view meaning) {
    if (!text_.empty()) text_ += text_.ends_with(":*") ? " " : " · ";
    text_ += "`" + std::string{name} + "` " + type;
    if (!meaning.empty()) text_ += ", " + std::string{meaning};
  }
  std::string text_;
};

template <class Message>
std::string fields_of() {
  Row row;
  const Message message{};
  Message::layout(message, row);
  return row.text();
}

template <class... Message>
std::string table_of(const std::tuple<Message...>*) {
  std::string table =
      "| message | id | bytes | fields in their order: type, unit, axis or sign |\n| --- | --- | "
      "--- | --- |\n";
  const auto add = [&]<class M>(const M*) {
    table += "| " + std::string{M::kName} + " | " + std::to_string(M::kId) + " | " +
             std::to_string(sizes_of<M>().all()) + " | " + fields_of<M>() + " |\n";
  };
  (add(static_cast<const Message*>(nullptr)), ...);
  return table;
}

std::string page() {
  const char* root = std::getenv("GATEFLY_SOURCE_DIR");
  std::ifstream file{std::string{root != nullptr ? root : "."} + "/docs/link.md"};
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

void expect_on_page(const std::string& table) {
  EXPECT_NE(page().find("\n\n" + table + "\n"), std::string::npos) << "docs/link.md should have\n"
                                                                   << table;
}

TEST(LinkPage, HasTheTableOfMsp) {
  expect_on_page(table_of(static_cast<const msp::Messages*>(nullptr)));
}

TEST(LinkPage, HasTheTablesOfMavlink) {
  expect_on_page(table_of(static_cast<const mavlink::Telemetry*>(nullptr)));
  expect_on_page(table_of(static_cast<const mavlink::Commands*>(nullptr)));
  expect_on_page(table_of(static_cast<const mavlink::HardwareInLoop*>(nullptr)));
}

TEST(LinkPage, HasTheHeaderOfASlice) {
  EXPECT_NE(page().find(fields_of<jpeg_slices::Header>() + "\n"), std::string::npos)
      << fields_of<jpeg_slices::Header>();
}

}  // namespace
}  // namespace gatefly::link
