// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/shipped_files.hpp"

#include <array>
#include <cstdlib>
#include <optional>
#include <set>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include <dlfcn.h>

#include "gatefly/files/text.hpp"

namespace gatefly::files {
namespace fs = std::filesystem;

namespace {

/// The shared library that this code was linked into, else the program.
fs::path this_binary() {
  static const char kHere = 0;
  std::error_code error;
  Dl_info library{};
  if (dladdr(&kHere, &library) != 0 && library.dli_fname != nullptr) {
    const fs::path path = fs::canonical(library.dli_fname, error);
    if (path.filename().string().find(".so") != std::string::npos) return path;
  }
  return fs::read_symlink("/proc/self/exe", error);
}

/// Folders that may have a gatefly/ in them, nearest first.
std::vector<fs::path> share_folders() {
  std::vector<fs::path> folders;
  for (fs::path above = this_binary(); above.has_relative_path();) {
    above = above.parent_path();
    folders.push_back(above / "share");
  }
  const char* named = std::getenv("XDG_DATA_DIRS");
  std::istringstream others{named != nullptr && *named != '\0' ? named
                                                               : "/usr/local/share:/usr/share"};
  for (std::string folder; std::getline(others, folder, ':');) folders.emplace_back(folder);
  return folders;
}

const fs::path& shipped() {
  static const fs::path folder = shipped_dir();
  return folder;
}

/// Folders in which names are looked for: the first wins.
std::vector<fs::path> places_of(const std::string& folder) {
  std::vector<fs::path> places{fs::path{folder}};
  if (!shipped().empty()) places.push_back(shipped() / folder);
  return places;
}

/// A file by its path, here or in what gatefly comes with ("cameras/bebop.toml").
std::optional<fs::path> by_path(const std::string& name) {
  std::error_code error;
  if (fs::is_regular_file(name, error)) return name;
  if (!shipped().empty() && fs::is_regular_file(shipped() / name, error)) return shipped() / name;
  return std::nullopt;
}

std::optional<fs::path> by_name(const std::string& name, const std::string& folder) {
  std::error_code error;
  for (const fs::path& place : places_of(folder))
    if (const fs::path file = place / (name + ".toml"); fs::is_regular_file(file, error))
      return file;
  return std::nullopt;
}

/// A path that is no regular file: a pipe such as bash's <(...), or a device; a link to nowhere is
/// nothing.
/// @throws std::runtime_error saying which names there are.
fs::path other_file(const std::string& name, std::span<const std::string> folders) {
  std::error_code error;
  const fs::file_status status = fs::status(name, error);
  if (fs::is_directory(status)) throw std::runtime_error(name + ": is a folder, not a file");
  if (fs::exists(status)) return name;
  std::vector<std::string> names;
  for (const std::string& folder : folders) {
    const auto here = toml_names(folder);
    names.insert(names.end(), here.begin(), here.end());
  }
  throw std::runtime_error(
      (name.empty() ? "\"\"" : name) + ": no such file, nor a name in " + joined(folders, "/, ") +
      "/ (there are: " + joined(names) + ")" + suggestion(name, names) +
      (shipped().empty() ? "; the files that gatefly comes with are missing: no "
                           "share/gatefly above " +
                               this_binary().string() + " or in $XDG_DATA_DIRS"
                         : ""));
}

}  // namespace

fs::path shipped_dir() {
  std::error_code error;
  for (const fs::path& folder : share_folders())
    if (fs::is_regular_file(folder / "gatefly" / "configs" / "default.toml", error))
      return folder / "gatefly";
  return {};
}

fs::path cache_dir() {
  const char* cache = std::getenv("XDG_CACHE_HOME");
  if (cache != nullptr && *cache != '\0') return fs::path{cache} / "gatefly";
  const char* home = std::getenv("HOME");
  if (home != nullptr && *home != '\0') return fs::path{home} / ".cache" / "gatefly";
  return fs::temp_directory_path() / "gatefly-cache";
}

fs::path data_folder() {
  const char* variable = std::getenv("GATEFLY_DATA");
  return variable != nullptr ? variable : "../shared/data";
}

std::vector<std::string> toml_names(const std::string& folder) {
  std::error_code error;
  std::set<std::string> names;
  for (const fs::path& place : places_of(folder))
    for (const auto& entry : fs::directory_iterator(place, error))
      if (entry.path().extension() == ".toml") names.insert(entry.path().stem().string());
  return {names.begin(), names.end()};
}

fs::path find_toml(const std::string& name, const std::string& folder) {
  if (const auto file = by_path(name)) return *file;
  if (const auto file = by_name(name, folder)) return *file;
  return other_file(name, std::vector{folder});
}

fs::path find_config(const std::string& name) {
  if (const auto file = by_path(name)) return *file;
  if (const auto file = by_name(name, "configs")) return *file;
  const auto camera = by_name(name, "cameras"), vehicle = by_name(name, "vehicles");
  if (camera && vehicle)
    throw std::runtime_error(name + ": is a camera and a vehicle; say cameras/" + name +
                             ".toml or vehicles/" + name + ".toml");
  if (camera) return *camera;
  if (vehicle) return *vehicle;
  return other_file(name, std::vector<std::string>{"configs", "cameras", "vehicles"});
}

}  // namespace gatefly::files
