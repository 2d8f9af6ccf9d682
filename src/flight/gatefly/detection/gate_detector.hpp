// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "gatefly/detection/color_model.hpp"
#include "gatefly/detection/gate_detection.hpp"
#include "gatefly/detection/gate_detector_params.hpp"
#include "gatefly/detection/quad.hpp"
#include "gatefly/detection/search_window.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly {

/// Which detector looks.
enum class DetectorMode {
  kOurs,     ///< The default: the fast search, then the careful one where that is not sure.
  kFast,     ///< The fast search alone.
  kCareful,  ///< The careful search alone.
  kPaper,    ///< Li18's as its ROC study ran it, with the study's colours.
  kFlown,    ///< Li18's as it flew, with that day's colours.
};

/// The request to a detector. Narrower requests run faster.
struct LookFor {
  enum class Gates {
    kNone,
    kStandingOut,  ///< Those that stand out; all where none does. For callers that expect a certain gate.
    kBest,         ///< One. For callers that know nothing about the picture.
    kAll,
  };
  enum class Part {
    kNo,
    kWithoutGate,  ///< Only if no gate was found.
    kToo,          ///< Beside the gates as well.
  };
  Gates gates = Gates::kStandingOut;
  Part part = Part::kNo;  ///< A gate that the border cuts. Li18's two: the side bars.
  /// Middle lines of the bars of a gate that the caller expects: less evidence suffices there, and
  /// once it is found there is no careful search. kOurs.
  const Quad* expected_bars = nullptr;
  /// No careful search, whatever is found. kOurs.
  bool quick = false;
  /// Only this part of the picture is searched carefully; not at all where the expected gate is found
  /// and sure, unless `gates` is kAll. kOurs.
  const SearchWindow* within = nullptr;
  /// Another request for the last picture and the same colour: reuses the tone measured then.
  /// kOurs, kFast, kCareful.
  bool again = false;
  /// The last picture's gate, which kFlown tries again where it finds none.
  const Quad* previous = nullptr;
};

/// A detector's answer for one picture.
struct GatesInView {
  /// Distinct, best first. Valid until the detector looks again.
  std::span<const GateDetection> gates;
  std::optional<GatePart> part;  ///< Part of a gate that is not in `gates`.
  Openings openings;             ///< Of gates made of boards; asked for with `part`.
  bool careful = false;          ///< Whether the careful search ran, too.
};

/// Finds gates: the one door to all detectors. Every mode answers the corners that `corner_scale` means.
class GateDetector {
 public:
  explicit GateDetector(const GateDetectorParams& params = {},
                        DetectorMode mode = DetectorMode::kOurs);
  GateDetector(GateDetector&&) noexcept;
  GateDetector& operator=(GateDetector&&) noexcept;
  ~GateDetector();

  /// Gates, in microseconds where they stand out, else by looking everywhere. Of several that are
  /// certain the first is the one nearest to the middle of the picture.
  ///
  /// Keeps nothing from picture to picture. Allocates nothing.
  [[nodiscard]] GatesInView look(const Image& image, const ColorModel& color,
                                 const LookFor& look_for = {}) &;

  /// False of the paper's detectors: a part is two columns of a picture, without corners to answer with.
  [[nodiscard]] bool parts_have_corners() const { return !is_paper(); }

 private:
  struct Searches;

  void list_gates(const Image& image, const LookFor& look_for);
  [[nodiscard]] std::optional<GatePart> part(const Image& image);
  [[nodiscard]] bool is_paper() const;
  [[nodiscard]] GateDetections ours(const Image& image, const LookFor& look_for);
  bool add_expected(const Quad& bars_px, const Image& image, GateDetections& gates) const;
  [[nodiscard]] GateDetections everywhere(const Image& image);
  [[nodiscard]] GateDetections with_gates_beside(const GateDetections& quick, const Image& image,
                                                 const SearchWindow* within);
  [[nodiscard]] bool is_sure(const GateDetection& gate) const;
  [[nodiscard]] GateDetections in_order(GateDetections gates, const Image& image) const;

  GateDetectorParams params_;
  DetectorMode mode_;
  std::unique_ptr<Searches> searches_;
  std::vector<GateDetection> gates_;  // of the picture that was looked at last
  bool careful_ = false;              // asked about it
};

}  // namespace gatefly
