// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/foreign_logs/imported_folder.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <regex>

#include "gatefly/files/image_file.hpp"
#include "gatefly/files/output.hpp"
#include "gatefly/files/partial_folder.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/flight_log/flight_folder.hpp"

namespace gatefly::foreign_logs {
namespace {

namespace fs = std::filesystem;

constexpr files::OutputKind kImported{"imported log", "\"kind\": \"import\""};

bool is_of_an_import(const std::string& name) {
  static const std::regex kNames{
      "log_si\\.csv|images\\.csv|summary\\.json|report\\.html|onboard\\.webm|track\\.toml|"
      "config-[0-9]+\\.toml|colors\\.toml|settings\\.txt|img_[0-9]+\\.(jpg|png|ppm)"};
  return std::regex_match(name, kNames);
}

void append(std::string& text, double value) {
  std::array<char, 32> digits{};
  if (!std::isfinite(value)) return;
  // The shortest that reads back as the same number.
  text.append(digits.data(),
              std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
}

/// log_si.csv, written piece by piece: a long one need not be in memory twice.
void write_log(const ForeignFlight& flight, const fs::path& path) {
  constexpr std::size_t kPiece = 1 << 20;
  std::ofstream file{path, std::ios::binary};
  std::string text = "t_ns";
  for (const auto& [name, values] : flight.columns) text += "," + name;
  if (!flight.lifted.empty()) text += std::string{","} + flight_log::kLiftedColumn;
  text += '\n';
  for (std::size_t row = 0; row < flight.times.size(); ++row) {
    text += std::to_string(flight.times[row].count());
    for (const auto& [name, values] : flight.columns) text += ',', append(text, values[row]);
    if (!flight.lifted.empty()) text += flight.lifted[row] ? ",1" : ",0";
    text += '\n';
    if (text.size() < kPiece && row + 1 < flight.times.size()) continue;
    file.write(text.data(), static_cast<std::streamsize>(text.size()));
    text.clear();
  }
  file.close();
  if (!file) throw files::CannotWrite(path, "disk full?");
}

}  // namespace

void check_import_folder(const fs::path& out) {
  files::check_output_folder("--out", out);
  files::refuse_foreign_folder(out, "summary.json", kImported, "choose another --out");
}

CopiedPictures write_imported(const ForeignFlight& flight, const fs::path& out,
                              const std::map<std::string, std::string>& files,
                              const std::function<std::string(const CopiedPictures&)>& summary,
                              const std::function<void()>& on_picture) {
  check_import_folder(out);
  files::PartialFolder folder{out, files::PartialFolder::Grows::kBeside, is_of_an_import};
  write_log(flight, folder.path() / "log_si.csv");
  CopiedPictures pictures;
  std::string list = "image,t_ns,log_row\n";
  for (const ForeignPicture& picture : flight.pictures) {
    on_picture();
    std::string bytes;
    try {
      (void)files::read_image(picture.path);
      bytes = files::read_file(picture.path);
    } catch (const std::exception& error) {
      pictures.unreadable.push_back(files::reason_of(error));
      continue;
    }
    const std::string kind = files::kind_of(picture.path);
    std::array<char, 32> name{};
    std::snprintf(name.data(), name.size(), "img_%05zu%s", pictures.copied,
                  kind == ".jpeg" ? ".jpg" : kind.c_str());
    folder.write(name.data(), bytes);
    list += std::string{name.data()} + "," + std::to_string(flight.times[picture.row].count()) +
            "," + std::to_string(picture.row) + "\n";
    ++pictures.copied;
  }
  folder.write("images.csv", list);
  for (const auto& [name, content] : files) folder.write(name, content);
  folder.write("summary.json", summary(pictures));
  folder.replace([](const std::string&) { return false; });
  return pictures;
}

}  // namespace gatefly::foreign_logs
