// SPDX-License-Identifier: Apache-2.0
#include "gatefly/bench/stage.hpp"

#include <algorithm>
#include <chrono>

namespace gatefly::bench {
namespace {

double microseconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start)
      .count();
}

Cost cost_of(std::vector<double>& times) {
  if (times.empty()) return {};
  std::sort(times.begin(), times.end());
  const auto at = [&](double part) {
    return times[static_cast<std::size_t>(part * static_cast<double>(times.size() - 1))];
  };
  return {at(0.5), at(0.99), at(1.0)};
}

}  // namespace

// A name that callgrind can be told: not inlined, not mangled.
extern "C" [[gnu::noinline]] void gatefly_bench_call(const Stage* stage, std::size_t input) {
  stage->call(input);
}

void call(const Stage& stage, std::size_t input) { gatefly_bench_call(&stage, input); }

std::vector<Cost> measure(std::span<const Stage> stages, int rounds,
                          const std::function<bool()>& stopped) {
  std::vector<std::vector<double>> times(stages.size());
  std::size_t inputs = 0;
  for (const Stage& stage : stages) inputs = std::max(inputs, stage.inputs / stage.at_once);
  for (int round = -1; round < rounds && !stopped(); ++round)
    for (std::size_t i = 0; i < inputs && !stopped(); ++i)
      for (std::size_t s = 0; s < stages.size(); ++s) {
        const Stage& stage = stages[s];
        if ((i + 1) * stage.at_once > stage.inputs) continue;
        const double time = microseconds([&] {
          for (std::size_t k = 0; k < stage.at_once; ++k) stage.call(i * stage.at_once + k);
        });
        if (round >= 0) times[s].push_back(time / static_cast<double>(stage.at_once));
      }
  std::vector<Cost> costs;
  for (auto& of_stage : times) costs.push_back(cost_of(of_stage));
  return costs;
}

double least_time(const std::function<void()>& work, int calls) {
  double least = 1e300;
  for (int i = 0; i < calls; ++i) least = std::min(least, microseconds(work));
  return least;
}

const Stage* find(std::span<const Stage> stages, const std::string& name) {
  const auto found =
      std::find_if(stages.begin(), stages.end(), [&](const Stage& s) { return s.name == name; });
  return found == stages.end() ? nullptr : &*found;
}

}  // namespace gatefly::bench
