// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <string>
#include <string_view>

#include "gatefly/files/image_file.hpp"

// The part of image_file.hpp that takes a picture's name alone: also there without a picture
// library.
namespace gatefly::files {

std::string kind_of(const std::filesystem::path& path) {
  std::string kind = path.extension().string();
  std::transform(kind.begin(), kind.end(), kind.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return kind;
}

bool is_picture(const std::filesystem::path& path) {
  const std::string kind = kind_of(path);
  return kind == ".jpg" || kind == ".jpeg" || kind == ".png" || kind == ".ppm" || kind == ".uyvy";
}

bool is_raw(const std::filesystem::path& path) { return kind_of(path) == ".uyvy"; }

}  // namespace gatefly::files
