// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/bench/worst_picture.hpp"

#include <algorithm>

#include "gatefly/experiments/bench/stage.hpp"

namespace gatefly::bench {
namespace {

constexpr int kCalls = 3;

WorstPicture timed(const Pattern& pattern, const std::function<void(const Picture&)>& look) {
  const Picture picture = drawn(pattern);
  return {pattern, least_time([&] { look(picture); }, kCalls)};
}

Pattern anywhere(const PatternKind& kind, Rng& rng) {
  Pattern pattern{.kind = kind.kind};
  for (std::size_t i = 0; i < 3; ++i) pattern.numbers[i] = rng.uniform(kind.least[i], kind.most[i]);
  return pattern;
}

Pattern near(Pattern pattern, const PatternKind& kind, double part, Rng& rng) {
  for (std::size_t i = 0; i < 3; ++i) {
    const double reach = part * (kind.most[i] - kind.least[i]);
    pattern.numbers[i] =
        std::clamp(pattern.numbers[i] + rng.uniform(-reach, reach), kind.least[i], kind.most[i]);
  }
  return pattern;
}

}  // namespace

WorstPicture worst_picture(const std::function<void(const Picture&)>& look, int tries, Rng& rng,
                           const std::function<bool()>& stopped) {
  WorstPicture worst;
  for (const PatternKind& kind : pattern_kinds()) {
    WorstPicture here;
    for (int i = 0; i < tries && !stopped(); ++i) {
      // The second half goes in ever smaller steps.
      const double part = 0.4 * (1.0 - static_cast<double>(i) / tries);
      const WorstPicture next =
          timed(2 * i < tries ? anywhere(kind, rng) : near(here.pattern, kind, part, rng), look);
      if (next.time_us > here.time_us) here = next;
    }
    if (here.time_us > worst.time_us) worst = here;
  }
  return worst;
}

}  // namespace gatefly::bench
