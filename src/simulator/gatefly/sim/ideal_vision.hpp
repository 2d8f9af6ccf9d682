// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "gatefly/sim/camera.hpp"
#include "gatefly/sim/correlated_draw.hpp"
#include "gatefly/sim/detector_statistics.hpp"
#include "gatefly/sim/gates_in_view.hpp"
#include "gatefly/sim/lookalikes.hpp"
#include "gatefly/sim/random.hpp"
#include "gatefly/sim/sight.hpp"
#include "gatefly/world/world.hpp"

namespace gatefly::sim {

/// An ideal detector's answer for one picture.
struct SeenPicture {
  struct Gate {
    std::array<Eigen::Vector2d, 4> corners_px;
    double fitness = 1.0;
  };
  struct Pair {
    Eigen::Vector2d left_px, right_px;
  };
  std::vector<Gate> gates;    ///< Best first, what is no gate among them.
  std::optional<Pair> lower;  ///< The outer lower corners of a gate cut off above.
  std::optional<Pair> bars;   ///< A near gate's side bars.
  /// A wide gate that the border cuts: its corners, and which of them are seen.
  struct Cut {
    std::array<Eigen::Vector2d, 4> corners_px;
    std::array<bool, 4> seen{};
  };
  std::optional<Cut> cut;
};

/// Detections without pictures: what is in view, with the misses, errors and false alarms of a
/// detector.
///
/// A detection's fitness says as much about it as the real detector's does, and nothing else of it
/// says more. Misses, errors and false alarms stay for a while, and with a seed. Blind to gates of
/// a colour that the pilot does not look for. [docs/simulation.md]
class IdealVision {
 public:
  /// @param sight  must live as long.
  IdealVision(const world::World& world, const world::CameraTruth& camera,
              const world::IdealVisionParams& params, std::uint64_t seed, const Sight& sight);

  /// @param t_start  when the first column begins its exposure [s]; pictures in order.
  /// @param history  body poses, ascending in t, covering the exposure.
  [[nodiscard]] SeenPicture look(double t_start, std::span<const BodyPose> history);

 private:
  using Corners = std::array<Eigen::Vector2d, 4>;
  /// A pair that is none, kept while it lasts.
  struct FalsePair {
    const char* where;  ///< Name of the stream that places it.
    CorrelatedDraws draws;
    std::optional<SeenPicture::Pair> pair;
  };

  [[nodiscard]] std::vector<GateView> with_outliers(std::vector<GateView> views, double t_start,
                                                    std::span<const BodyPose> history);
  [[nodiscard]] Corners with_errors(const GateView& view, double t);
  [[nodiscard]] Corners crooked(const GateView& view, double t);
  [[nodiscard]] Corners square_at(const Eigen::Vector2d& middle_px, double size, int which,
                                  Draws draw);
  /// Random numbers for one purpose and one thing, now.
  [[nodiscard]] Draws draws(const char* purpose, int which, double t) const;
  void add_wrong_frame(const GateView& view, double missed, double t, SeenPicture& seen);
  void add_gates(const std::vector<GateView>& views, double t, SeenPicture& seen);
  void add_frames_of_gates(const std::vector<GateView>& views, double t, SeenPicture& seen);
  void add_alarms(double t, std::span<const BodyPose> history, SeenPicture& seen);
  void add_parts(const std::vector<GateView>& views, double t, SeenPicture& seen);
  void add_cut(const std::vector<GateView>& views, double t, SeenPicture& seen);
  void add_false_pair(FalsePair& kind, double rate, double t,
                      std::optional<SeenPicture::Pair>& pair);
  /// A part of this gate counts within so many metres, of a gate of 1 m [m].
  [[nodiscard]] double reach(double of_1_m, const GateView& view) const;

  world::World world_;
  world::CameraTruth camera_;
  GateBuild build_;
  DetectorStatistics statistics_;
  bool one_answer_;  ///< As the paper's flown detector gives.
  double outliers_;
  const Sight& sight_;
  std::uint64_t seed_;
  std::vector<Place> places_;
  CorrelatedDraws gates_, aslant_, hidden_, crooked_, two_gates_, decoys_, at_places_, lower_,
      bars_, cut_;
  CorrelatedDraws right_, down_, size_;  ///< The error that a gate's corners share.
  FalsePair false_lower_, false_bars_, false_cut_;
};

}  // namespace gatefly::sim
