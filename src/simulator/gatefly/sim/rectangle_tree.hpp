// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "gatefly/sim/scene.hpp"

namespace gatefly::sim {

/// A bounding volume hierarchy over rectangles: boxes within boxes, a few rectangles in each leaf.
///
/// The same lists give the same tree on every machine. Rectangles of no size are left out.
class RectangleTree {
 public:
  /// A box, and what is in it: `count` of `order` from `first` on, or, when count is 0, the two
  /// nodes from `first` on.
  struct Node {
    float low[3];
    int first;
    float high[3];
    int count;
  };

  static constexpr int kDeepest = 64;  ///< No leaf is farther from the root.

  explicit RectangleTree(const std::vector<const Rectangle*>& rectangles);

  /// The root is the first; empty without rectangles.
  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }
  /// Indices into the list given, leaf by leaf.
  [[nodiscard]] const std::vector<int>& order() const { return order_; }

 private:
  struct Box {
    Eigen::Vector3f low, high;
  };
  void split(int node, const std::vector<Box>& boxes, int first, int count, int depth);
  /// Sorts a part of `order_` into two; how many are in the first.
  [[nodiscard]] int parted(const std::vector<Box>& boxes, int first, int count);

  std::vector<Node> nodes_;
  std::vector<int> order_;
};

}  // namespace gatefly::sim
