// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/bench/stage.hpp"

#include <algorithm>
#include <chrono>
#include <numeric>
#include <utility>

namespace gatefly::bench {
namespace {

double microseconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start)
      .count();
}

// Quantile of sorted numbers, one at least.
double quantile(std::span<const double> sorted, double part) {
  return sorted[static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1))];
}

// @param times  round after round, so many inputs each; the last round may have been stopped.
Cost cost_of(std::vector<double>& times, std::size_t inputs) {
  if (times.empty()) return {};
  std::vector<double> least(
      times.begin(), times.begin() + static_cast<std::ptrdiff_t>(std::min(inputs, times.size())));
  for (std::size_t i = least.size(); i < times.size(); ++i)
    least[i % inputs] = std::min(least[i % inputs], times[i]);
  std::sort(times.begin(), times.end());
  return {quantile(times, 0.5), quantile(times, 0.99), times.back(), std::move(least)};
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
  for (std::size_t s = 0; s < stages.size(); ++s)
    costs.push_back(cost_of(times[s], stages[s].inputs / stages[s].at_once));
  return costs;
}

Ratios ratios(const Cost& cost, const Cost& baseline) {
  std::vector<double> of_input;
  for (std::size_t i = 0; i < std::min(cost.least.size(), baseline.least.size()); ++i)
    if (baseline.least[i] > 0.0) of_input.push_back(cost.least[i] / baseline.least[i]);
  if (of_input.empty()) return {};
  std::sort(of_input.begin(), of_input.end());
  const double sum = std::accumulate(of_input.begin(), of_input.end(), 0.0);
  return {quantile(of_input, 0.5), sum / static_cast<double>(of_input.size()),
          quantile(of_input, 0.99), of_input.back()};
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
