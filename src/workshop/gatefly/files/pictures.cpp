// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/pictures.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <system_error>

#include "gatefly/files/image_file.hpp"
#include "gatefly/files/shipped_files.hpp"
#include "gatefly/files/text.hpp"

namespace gatefly::files {

namespace fs = std::filesystem;

std::vector<fs::path> picture_files(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error))
    throw std::runtime_error((path.empty() ? "\"\"" : path.string()) +
                             ": there is no such file or folder");
  if (!fs::is_directory(path, error)) return {path};

  std::vector<fs::path> files;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(path, error))
    if (is_picture(entry.path()) && !is_raw(entry.path()) &&
        !fs::is_fifo(entry.status(ignored)))  // for a pipe we would wait for ever
      files.push_back(entry.path());
  if (error) throw std::runtime_error(path.string() + ": cannot be read: " + error.message());
  if (files.empty()) {
    const std::string others = left_out_of(path);
    throw std::runtime_error(others.empty() ? path.string() + ": holds no .jpg, .jpeg, .png or .ppm"
                                            : others);
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::string left_out_of(const fs::path& path) {
  static const std::set<std::string> kinds{".avif", ".bmp", ".gif", ".heic", ".heif", ".jp2",
                                           ".pgm",  ".pnm", ".tif", ".tiff", ".webp"};
  constexpr std::size_t kShown = 3;
  std::error_code error;
  if (!fs::is_directory(path, error)) return "";
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(path, error))
    if (kinds.contains(kind_of(entry.path()))) names.push_back(entry.path().filename().string());
  if (names.empty()) return "";
  std::sort(names.begin(), names.end());
  const std::size_t more = names.size() - std::min(names.size(), kShown);
  names.resize(names.size() - more);
  return path.string() + ": left out: " + joined(names) +
         (more > 0 ? " and " + std::to_string(more) + " more" : "") +
         " (a folder means its .jpg, .jpeg, .png and .ppm)";
}

fs::path find_data(const fs::path& path, const std::string& data) {
  std::error_code error;
  if (!data.empty() && !fs::is_directory(data, error))
    throw std::runtime_error("--data " + data + ": there is no such folder");
  if (path.empty() || path.is_absolute() || fs::exists(path, error)) return path;
  const fs::path folder = !data.empty() ? fs::path{data} : data_folder();
  for (const fs::path& candidate : {folder / path, folder / below_shared_data(path)})
    if (fs::exists(candidate, error)) return candidate;
  const fs::path shipped = shipped_dir();
  return !shipped.empty() && fs::exists(shipped / path, error) ? shipped / path : path;
}

fs::path below_shared_data(const fs::path& path) {
  const fs::path shared{"../shared/data"};
  const fs::path inside = path.lexically_normal().lexically_relative(shared);
  return inside.empty() || *inside.begin() == ".." ? path : inside;
}

}  // namespace gatefly::files
