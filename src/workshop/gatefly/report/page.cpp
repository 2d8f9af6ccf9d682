// SPDX-License-Identifier: Apache-2.0
#include "gatefly/report/page.hpp"

#include <filesystem>
#include <stdexcept>
#include <string_view>

#include "gatefly/files/shipped_files.hpp"
#include "gatefly/files/text.hpp"

namespace gatefly::report {
namespace {

constexpr std::string_view kPlaceOfData = "<!--gatefly:flight-->";

}  // namespace

std::string shipped_page(const std::string& name) {
  const std::filesystem::path path = files::shipped_dir() / "viewer" / name;
  std::string page = files::read_file(path);
  if (page.find(kPlaceOfData) == std::string::npos)
    throw std::runtime_error(path.string() + ": is not the page that data is put into");
  return page;
}

std::string in_a_script(const nlohmann::ordered_json& json) {
  std::string text = json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at))
    text.replace(at, 1, "\\u003c");
  return text;
}

std::string with_elements(const std::string& page, const std::string& elements) {
  const auto place = page.find(kPlaceOfData);
  return page.substr(0, place) + elements + page.substr(place + kPlaceOfData.size());
}

std::string with_data(const std::string& page,
                      const std::vector<std::pair<std::string, nlohmann::ordered_json>>& data) {
  std::string elements;
  for (const auto& [name, json] : data)
    elements += "<script type=\"application/json\" id=\"" + name + "\">" + in_a_script(json) +
                "</script>\n";
  return with_elements(page, elements);
}

}  // namespace gatefly::report
