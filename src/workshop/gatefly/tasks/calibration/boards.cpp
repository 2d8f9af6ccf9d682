// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/calibration/boards.hpp"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <stdexcept>

#include "gatefly/files/image_file.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/tasks/calibration/board_finder.hpp"
#include "gatefly/tasks/calibration/corner_list.hpp"

namespace gatefly::calibration {
namespace {

namespace fs = std::filesystem;

/// "9x6" as two numbers. @throws naming the flag.
Eigen::Vector2i pair_of(const std::string& text, const std::string& flag, int low, int high) {
  Eigen::Vector2i pair{0, 0};
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, pair.x());
  if (first.ec == std::errc{} && first.ptr != end && *first.ptr == 'x') {
    const auto second = std::from_chars(first.ptr + 1, end, pair.y());
    if (second.ec == std::errc{} && second.ptr == end && pair.minCoeff() >= low &&
        pair.maxCoeff() <= high)
      return pair;
  }
  throw std::runtime_error(flag + " " + files::one_line(text) + ": must be two numbers in " +
                           std::to_string(low) + ".." + std::to_string(high) +
                           " with an x between them");
}

Eigen::Vector2i inner_corners(const std::string& pattern) {
  return pair_of(pattern, "--pattern", 3, 100);
}

std::string text_of(const Eigen::Vector2i& size_px) {
  return std::to_string(size_px.x()) + "x" + std::to_string(size_px.y());
}

/// @throws for a corner outside a stored picture of the size that was said.
void expect_inside(const BoardViews& views, const Eigen::Vector2i& size_px, const fs::path& path,
                   const std::string& size) {
  for (const BoardView& view : views)
    for (const BoardCorner& corner : view.corners)
      if ((corner.px.array() < -0.5).any() ||
          (corner.px.array() > size_px.cast<double>().array() - 0.5).any())
        throw std::runtime_error(path.string() + ": " + view.image + " has a corner at (" +
                                 files::text_of(corner.px.x(), 6) + ", " +
                                 files::text_of(corner.px.y(), 6) +
                                 "), outside a picture of --size " + size);
}

/// @throws for a view with another number of corners than the pattern that was said has.
void expect_pattern(const BoardViews& views, const fs::path& path, const std::string& pattern) {
  const int corners = inner_corners(pattern).prod();
  for (const BoardView& view : views)
    if (view.corners.size() != static_cast<std::size_t>(corners))
      throw std::runtime_error(path.string() + ": " + view.image + " has " +
                               std::to_string(view.corners.size()) + " corners, --pattern " +
                               pattern + " has " + std::to_string(corners));
}

/// The pattern that most pictures show instead; its count 0 when none does.
std::pair<std::string, int> most_frequent_other(const Boards& boards) {
  std::pair<std::string, int> most{"", 0};
  for (const auto& [pattern, count] : boards.other_patterns)
    if (count > most.second) most = {pattern, count};
  return most;
}

}  // namespace

bool is_corner_list(const fs::path& path) {
  return path.extension() == ".csv" || path.extension() == ".CSV";
}

BoardPattern pattern_of(const BoardArguments& arguments) {
  if (arguments.pattern.empty())
    throw std::runtime_error(
        "--pattern is missing: inner corners of the checkerboard, 9x6 for one of 10x7 squares");
  if (!(arguments.square > 0.0))
    throw std::runtime_error("--square-m is missing: the side of one square in metres, 0.03");
  const Eigen::Vector2i size = inner_corners(arguments.pattern);
  return {size.x(), size.y(), arguments.square};
}

void Boards::add_picture(const fs::path& path, const BoardPattern& pattern, int rotate_deg) {
  const files::ImageFile file = files::read_image(path);
  const Image image = file.view(rotate_deg);
  const Eigen::Vector2i size{image.width(), image.height()};
  if (size_px.x() == 0) size_px = size;
  if (size != size_px)
    throw std::runtime_error(path.string() + ": is " + text_of(size) + ", must be " +
                             text_of(size_px) + " as the pictures before it");
  ++pictures;
  const BoardSearch search = find_board(image, path.filename().string(), pattern);
  if (search.view)
    views.push_back(*search.view);
  else
    without.emplace_back(path.filename().string(), search.reason);
  if (search.other) ++other_patterns[search.other->text()];
}

void Boards::add_list(const fs::path& path, const BoardArguments& arguments) {
  if (arguments.size.empty())
    throw std::runtime_error(
        path.string() +
        ": corner lists do not know their picture's size: add --size WxH (of the stored picture)");
  Eigen::Vector2i size = pair_of(arguments.size, "--size", 16, 4096);
  BoardViews found = read_corner_list(path);
  expect_inside(found, size, path, arguments.size);
  if (!arguments.pattern.empty()) expect_pattern(found, path, arguments.pattern);
  turn_upright(found, size, arguments.rotate_deg);
  if (arguments.rotate_deg % 180 != 0) std::swap(size.x(), size.y());
  if (size_px.x() != 0 && size != size_px)
    throw std::runtime_error(path.string() + ": --size " + arguments.size +
                             " is not the size of the pictures before it");
  size_px = size;
  listed = true;
  pictures += static_cast<int>(found.size());
  views.insert(views.end(), std::make_move_iterator(found.begin()),
               std::make_move_iterator(found.end()));
}

void expect_enough(const Boards& boards, const BoardArguments& arguments) {
  const auto [other, count] = most_frequent_other(boards);
  const std::string all = std::to_string(boards.pictures);
  if (count > static_cast<int>(boards.views.size()))
    throw std::runtime_error("--pattern " + arguments.pattern + ": " + std::to_string(count) +
                             " of " + all + " pictures show a board of " + other +
                             " inner corners: --pattern " + other + "?");
  constexpr std::size_t kNeeded = 5;
  if (boards.views.size() >= kNeeded || boards.without.empty()) return;
  std::string reasons;
  for (std::size_t i = 0; i < std::min<std::size_t>(boards.without.size(), 3); ++i)
    reasons += "; " + boards.without[i].first + ": " + boards.without[i].second;
  throw std::runtime_error("a board in " + std::to_string(boards.views.size()) + " of " + all +
                           " pictures, at least " + std::to_string(kNeeded) + " are needed" +
                           reasons);
}

}  // namespace gatefly::calibration
