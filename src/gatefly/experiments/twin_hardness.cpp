// SPDX-License-Identifier: Apache-2.0
// Are rendered pictures as hard as real ones? The same detectors on both, through the same
// recording, by apparent size.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <sstream>

#include "gatefly/experiments/gate_appearance.hpp"
#include "gatefly/experiments/twin_rates.hpp"
#include "gatefly/files/quantile.hpp"

namespace gatefly::experiments {
namespace {}

Result twin_hardness(const Options& options) {
  std::vector<std::string> settings;
  if (const char* s = std::getenv("GATEFLY_TWIN")) {
    std::stringstream in{s};
    for (std::string one; std::getline(in, one, ';');) settings.push_back(one);
  }
  const TwinRoom basement{"basement580", {"basement580"},          "showroom",
                          "showroom",    io::Recording::kMjpegLow, 4.0,
                          "basement"};
  const TwinRoom hq{"basement32_hq", {"basement32_hq"},    "showroom",
                    "showroom",      io::Recording::kJpeg, 4.0,
                    "basement"};
  for (const TwinRoom& room : {basement, hq}) {
    const auto real = real_pictures(room, options);
    const auto rendered =
        rendered_pictures(room, 1001, options.quick ? 30 : 100, 20, settings, options);
    for (const TwinMode mode : kTwinModes) {
      const auto of_real = outcomes(real, mode, room.config, 4),
                 of_rendered = outcomes(rendered, mode, room.config, 1);
      const TwinRates a = rates(real, of_real), b = rates(rendered, of_rendered);
      std::cout << room.name << " " << name_of(mode) << "\n";
      for (std::size_t i = 0; i < kTwinBinCount; ++i)
        std::cout << "  " << kTwinBins[i] << "-" << kTwinBins[i + 1]
                  << " m: " << fixed(a.bins[i].mean, 2) << " [" << fixed(a.bins[i].low, 2) << " "
                  << fixed(a.bins[i].high, 2) << "] of " << a.bins[i].count << " | "
                  << fixed(b.bins[i].mean, 2) << " of " << b.bins[i].count << "\n";
      for (const auto& [x, y] :
           {std::pair{a.false_positives_with_gate, b.false_positives_with_gate},
            std::pair{a.false_positives_without, b.false_positives_without}})
        std::cout << "  fp " << fixed(x.mean, 3) << " [" << fixed(x.low, 3) << " "
                  << fixed(x.high, 3) << "] | " << fixed(y.mean, 3) << "\n";
      for (const auto* o : {&of_real, &of_rendered}) {
        std::vector<double> e;
        for (const auto& p : *o) e.insert(e.end(), p.corner_errors.begin(), p.corner_errors.end());
        std::sort(e.begin(), e.end());
        std::cout << "  corner error median " << fixed(io::quantile(e, .5), 2) << " p95 "
                  << fixed(io::quantile(e, .95), 2) << "\n";
      }
    }
    for (const Feature& f : features()) {
      std::cout << "  " << f.key << ":";
      for (const auto* set : {&real, &rendered}) {
        std::vector<double> values;
        for (const TwinPicture& p : *set) {
          if (!p.gate || bin_of(*p.gate) < 0) continue;
          const double v = appearance_of(p).*f.value;
          if (std::isfinite(v)) values.push_back(v);
        }
        std::sort(values.begin(), values.end());
        std::cout << "  | " << fixed(io::quantile(values, .1), 3) << " "
                  << fixed(io::quantile(values, .25), 3) << " "
                  << fixed(io::quantile(values, .5), 3) << " "
                  << fixed(io::quantile(values, .75), 3) << " "
                  << fixed(io::quantile(values, .9), 3);
      }
      std::cout << "\n";
    }
  }
  return {.table = {}, .json = {}, .csv = "", .picture = io::Canvas(10, 10)};
}

}  // namespace gatefly::experiments
