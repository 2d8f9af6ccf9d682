// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/rectangle_tree.hpp"

#include <algorithm>
#include <array>

#include <Eigen/Geometry>

namespace gatefly::sim {
namespace {

constexpr int kMostInLeaf = 6;
constexpr int kHalvedFrom = 40;  // splits by chance of a hit; deeper ones halve
constexpr int kBins = 16;        // places where a node may be split, along its longest side

/// Half the surface of a box: how likely a ray meets it.
float half_surface(const Eigen::Vector3f& low, const Eigen::Vector3f& high) {
  const Eigen::Vector3f d = (high - low).cwiseMax(0.0f);
  return d.x() * d.y() + d.y() * d.z() + d.z() * d.x();
}

/// A box that grows, and how many are in it.
struct Bin {
  Eigen::Vector3f low = Eigen::Vector3f::Constant(1e30f), high = -low;
  int count = 0;
  void add(const Eigen::Vector3f& other_low, const Eigen::Vector3f& other_high, int more) {
    low = low.cwiseMin(other_low);
    high = high.cwiseMax(other_high);
    count += more;
  }
  [[nodiscard]] float cost() const {
    return count == 0 ? 0.0f : half_surface(low, high) * static_cast<float>(count);
  }
};

/// After which bin to split so that a ray meets the fewest rectangles (surface area heuristic).
int best_split(const std::array<Bin, kBins>& bins) {
  std::array<float, kBins> above{};
  Bin all;
  for (int i = kBins - 1; i > 0; --i) {
    const Bin& bin = bins[static_cast<std::size_t>(i)];
    all.add(bin.low, bin.high, bin.count);
    above[static_cast<std::size_t>(i)] = all.cost();
  }
  int best = 0;
  float least = 1e30f;
  all = {};
  for (int i = 0; i + 1 < kBins; ++i) {
    const Bin& bin = bins[static_cast<std::size_t>(i)];
    all.add(bin.low, bin.high, bin.count);
    const float cost = all.cost() + above[static_cast<std::size_t>(i + 1)];
    if (cost < least) least = cost, best = i;
  }
  return best;
}

}  // namespace

RectangleTree::RectangleTree(const std::vector<const Rectangle*>& rectangles) {
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < rectangles.size(); ++i) {
    const Rectangle& r = *rectangles[i];
    const Eigen::Vector3f a = r.corner, b = a + r.edge_u, c = a + r.edge_v, d = b + r.edge_v;
    boxes.push_back({a.cwiseMin(b).cwiseMin(c.cwiseMin(d)), a.cwiseMax(b).cwiseMax(c.cwiseMax(d))});
    if (r.edge_u.cross(r.edge_v).squaredNorm() > 0.0f) order_.push_back(static_cast<int>(i));
  }
  if (order_.empty()) return;
  nodes_.reserve(2 * order_.size());
  nodes_.emplace_back();
  split(0, boxes, 0, static_cast<int>(order_.size()), 0);
}

void RectangleTree::split(int node, const std::vector<Box>& boxes, int first, int count,
                          int depth) {
  Bin all;
  for (int i = first; i < first + count; ++i) {
    const Box& box = boxes[static_cast<std::size_t>(order_[static_cast<std::size_t>(i)])];
    all.add(box.low, box.high, 1);
  }
  Node result{};
  Eigen::Map<Eigen::Vector3f>{result.low} = all.low;
  Eigen::Map<Eigen::Vector3f>{result.high} = all.high;
  if (count <= kMostInLeaf) {
    result.first = first;
    result.count = count;
    nodes_[static_cast<std::size_t>(node)] = result;
    return;
  }
  const int left = depth < kHalvedFrom ? parted(boxes, first, count) : count / 2;
  result.first = static_cast<int>(nodes_.size());
  nodes_[static_cast<std::size_t>(node)] = result;
  nodes_.resize(nodes_.size() + 2);
  split(result.first, boxes, first, left, depth + 1);
  split(result.first + 1, boxes, first + left, count - left, depth + 1);
}

int RectangleTree::parted(const std::vector<Box>& boxes, int first, int count) {
  const auto centre2 = [&](int index) -> Eigen::Vector3f {
    const Box& box = boxes[static_cast<std::size_t>(index)];
    return box.low + box.high;
  };
  const auto begin = order_.begin() + first, end = begin + count;
  Eigen::Vector3f low = centre2(*begin), high = low;
  for (auto i = begin; i != end; ++i)
    low = low.cwiseMin(centre2(*i)), high = high.cwiseMax(centre2(*i));
  int axis = 0;
  const float longest = (high - low).maxCoeff(&axis);
  const auto bin_of = [&](int index) {
    const float at = (centre2(index)[axis] - low[axis]) / longest * kBins;
    return std::clamp(static_cast<int>(at), 0, kBins - 1);
  };
  if (longest > 0.0f) {
    std::array<Bin, kBins> bins;
    for (auto i = begin; i != end; ++i) {
      const Box& box = boxes[static_cast<std::size_t>(*i)];
      bins[static_cast<std::size_t>(bin_of(*i))].add(box.low, box.high, 1);
    }
    const int last = best_split(bins);
    const auto middle = std::stable_partition(begin, end, [&](int i) { return bin_of(i) <= last; });
    if (middle != begin && middle != end) return static_cast<int>(middle - begin);
  }
  return count / 2;  // all in one place
}

}  // namespace gatefly::sim
