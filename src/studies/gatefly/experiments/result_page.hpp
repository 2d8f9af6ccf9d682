// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "gatefly/experiments/experiment.hpp"

namespace gatefly::experiments {

/// A picture as a page shows it: small, and where it lies in full.
struct PagePicture {
  std::string file;  ///< Beside the page: "roc-length/plot.png".
  int width = 0, height = 0;
  std::string data_uri;  ///< The smaller of PNG and JPEG.
};

/// One experiment of a page.
struct PageEntry {
  std::string name, what, command;
  bool quick = false;
  std::vector<Comparison> table;
  std::vector<Deviation> deviations;
  std::vector<PagePicture> pictures;
};

/// @param command  the one that makes this result again.
[[nodiscard]] PageEntry entry_of(const Experiment& experiment, const Result& result,
                                 const std::string& command);

/// Pages say so in their head.
inline constexpr const char* kPageMark = "content=\"gatefly reproduce\"";
inline constexpr std::size_t kMostPageBytes = 5'000'000;

/// "paper | ours | command | deviation" for every quantity of every experiment, each with its
/// pictures: one page without network or scripts. Pictures that would make it larger than
/// kMostPageBytes, the largest first, are named only.
[[nodiscard]] std::string result_page(std::span<const PageEntry> entries);

}  // namespace gatefly::experiments
