// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/shipped_files.hpp"

#include <array>
#include <cstdlib>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include <dlfcn.h>

#include "gatefly/files/text.hpp"

namespace gatefly::io {
namespace fs = std::filesystem;

namespace {

/// The shared library that this code was linked into, else the program.
fs::path this_binary() {
  static const char kHere = 0;
  std::error_code error;
  Dl_info library{};
  if (dladdr(&kHere, &library) != 0 && library.dli_fname != nullptr) {
    const fs::path path = fs::canonical(library.dli_fname, error);
    if (path.extension() == ".so") return path;
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

fs::path find_toml(const std::string& name, const std::string& folder) {
  std::error_code error;
  if (fs::is_regular_file(name, error)) return name;

  static const fs::path shipped = shipped_dir();
  std::vector<fs::path> places{fs::path{folder}};
  if (!shipped.empty()) {
    if (fs::is_regular_file(shipped / name, error)) return shipped / name;  // cameras/bebop.toml
    places.push_back(shipped / folder);
  }
  std::set<std::string> names;
  for (const fs::path& place : places) {
    const fs::path candidate = place / (name + ".toml");
    if (fs::is_regular_file(candidate, error)) return candidate;
    for (const auto& entry : fs::directory_iterator(place, error))
      if (entry.path().extension() == ".toml") names.insert(entry.path().stem().string());
  }
  // Not a folder: a pipe such as bash's <(...), or a device. A link to nowhere does not exist.
  const fs::file_status status = fs::status(name, error);
  if (fs::is_directory(status)) throw std::runtime_error(name + ": is a folder, not a file");
  if (fs::exists(status)) return name;
  const std::vector<std::string> list{names.begin(), names.end()};
  throw std::runtime_error((name.empty() ? "\"\"" : name) + ": no such file, nor a name in " +
                           folder + "/ (there are: " + joined(list) + ")" + suggestion(name, list) +
                           (shipped.empty() ? "; the files that gatefly comes with are missing: no "
                                              "share/gatefly above " +
                                                  this_binary().string() + " or in $XDG_DATA_DIRS"
                                            : ""));
}

}  // namespace gatefly::io
