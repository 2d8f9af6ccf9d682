// SPDX-License-Identifier: Apache-2.0
// Where a test finds the sources and the real data, which do not ship with them.
#pragma once

#include <cstdlib>
#include <filesystem>

namespace gatefly::support {

inline std::filesystem::path source_folder() {
  const char* source = std::getenv("GATEFLY_SOURCE_DIR");
  return source == nullptr ? "." : source;
}

/// $GATEFLY_DATA, else the sibling folder of the sources.
inline std::filesystem::path real_data() {
  if (const char* data = std::getenv("GATEFLY_DATA")) return data;
  return source_folder() / "../shared/data";
}

}  // namespace gatefly::support
