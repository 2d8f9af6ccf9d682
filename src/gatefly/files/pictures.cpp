// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/pictures.hpp"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <system_error>

#include "gatefly/files/image_file.hpp"

namespace gatefly::io {

namespace fs = std::filesystem;

std::vector<fs::path> picture_files(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error))
    throw std::runtime_error(path.string() + ": there is no such file or folder");
  if (!fs::is_directory(path, error)) return {path};

  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(path, error))
    if (is_picture(entry.path()) && !is_raw(entry.path())) files.push_back(entry.path());
  if (error) throw std::runtime_error(path.string() + ": cannot be read: " + error.message());
  if (files.empty())
    throw std::runtime_error(path.string() + ": holds no .jpg, .jpeg, .png or .ppm");
  std::sort(files.begin(), files.end());
  return files;
}

fs::path find_data(const fs::path& path, const std::string& data) {
  std::error_code error;
  if (!data.empty() && !fs::is_directory(data, error))
    throw std::runtime_error("--data " + data + ": there is no such folder");
  if (path.is_absolute() || fs::exists(path, error)) return path;
  const char* variable = std::getenv("GATEFLY_DATA");
  const fs::path folder = !data.empty() ? data : variable != nullptr ? variable : "../shared/data";
  return fs::exists(folder / path, error) ? folder / path : path;
}

}  // namespace gatefly::io
