// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/tasks/tuning/color_fit.hpp"
#include "gatefly/tasks/tuning/lens_fit.hpp"
#include "gatefly/tasks/tuning/roc.hpp"

namespace gatefly::tuning {

/// Colours from labelled pictures.
/// @param detector  its corner_scale leads from labels to bars, its bar_ratio says how wide those
///     are.
[[nodiscard]] ColorModel fit_to_labels(Pictures pictures, const ColorModel& prior,
                                       const GateDetectorParams& detector);

struct SelfTrainingParams {
  int rounds = 3;
  int least_gates = 6;      ///< Confident ones; with fewer nothing is learnt. [estimate]
  double confident = 0.75;  ///< Fitness of a detection that is learnt from. [estimate]
  double unsure = 0.03;     ///< Above this fitness a detection is not background either. [estimate]
};

/// Outcome of learning from a model's own detections.
struct SelfTraining {
  ColorModel color;
  int confident = 0;    ///< Gates of the last round that colours were learnt from.
  bool learnt = false;  ///< Else `color` is what it began with: too few confident ones.
};

/// Colours without labels: a first model's own confident detections are the examples, round by
/// round.
[[nodiscard]] SelfTraining train_on_own(Pictures pictures, const ColorModel& described,
                                        const GateDetectorParams& detector,
                                        const SelfTrainingParams& params = {});

/// The lens that the gates of a set of pictures show, found with these colours: labelled ones where
/// there are labels, else confident detections. Looks again with what it found, until that stays.
[[nodiscard]] GateLens lens_of(Pictures pictures, const ColorModel& color,
                               const GateDetectorParams& detector);

/// Outcome of tuning.
struct Tuned {
  ColorModel color;
  bool learnt = true;       ///< Else too few gates: `color` is the prior, there is no ROC.
  int gates = 0;            ///< Labelled, or confident detections.
  double confident = 0;     ///< Fitness from which on a detection was learnt from; 0 with labels.
  double gates_to_hit = 0;  ///< Base of true positive rates; an estimate without labels.
  /// The lens that the gates show; kNothing where the detector was told one.
  GateLens lens = {};
  Roc roc = {};  ///< Each half of the pictures searched with colours fitted to the other.
  Operating chosen = {};
};

/// How pictures are to be searched once tuned: fitted colours' scores, the lens that was found.
[[nodiscard]] Judging as_tuned(const Judging& judging, const Tuned& tuned);

/// Colours fitted to all pictures; a threshold from two-fold scores that keeps to
/// `false_per_image`.
[[nodiscard]] Tuned tune_to_labels(Pictures pictures, const ColorModel& prior,
                                   const Judging& judging, double false_per_image);

/// The same without labels. With too few detections to learn from it starts again from less sure
/// ones, down to an even chance. Which detections are gates is estimated from their scores, which have
/// two peaks; on hard pictures, whose gates' scores reach far down, fewer are false than it says.
[[nodiscard]] Tuned tune_to_description(Pictures pictures, const ColorModel& described,
                                        const Judging& judging, double false_per_image);

}  // namespace gatefly::tuning
