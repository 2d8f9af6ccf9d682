// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "gatefly/link/msp_messages.hpp"

namespace gatefly::msp {

/// Throttle over stick: Betaflight's curve up to version 4.5 (API 1.46).
///
/// Source: Betaflight's throttle curve of `thr_mid` and `thr_expo`: with t the stick from min_check to
/// 2000 µs as 0 … 100, m and e these two and d = t − m, every tenth of it is
///   m + d (100 − e + e d² / y²) / 100   with y = 100 − m above, m below,
/// and straight between them, all in whole numbers, as the controller counts.
class ThrottleCurve {
 public:
  /// nullopt when the drone has another curve (throttle_hover) or its throttle is limited.
  [[nodiscard]] static std::optional<ThrottleCurve> from(const RcTuning& tuning,
                                                         const RxConfig& receiver);

  /// Throttle with the stick at `stick` [µs]: 0 … 1000.
  [[nodiscard]] int throttle(int stick) const;
  /// The least stick, min_check … 2000 µs, that gives `throttle` (0 … 1000) or more; 2000 where none does.
  [[nodiscard]] int stick(int throttle) const;

 private:
  ThrottleCurve(int mid, int expo, int min_check);
  std::array<int, 11> tenths_{};
  int min_check_ = 1050;  ///< [µs]
};

}  // namespace gatefly::msp
