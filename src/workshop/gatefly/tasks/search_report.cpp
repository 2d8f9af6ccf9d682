// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/search_report.hpp"

#include <algorithm>
#include <utility>

#include "gatefly/detection/search/careful_search.hpp"
#include "gatefly/detection/search/snake_search.hpp"
#include "gatefly/files/json.hpp"
#include "gatefly/files/text.hpp"

namespace gatefly::tasks {
namespace {

constexpr std::size_t kListed = 8;  // frames; a screen's worth

using files::fixed;

std::string below(const char* what, double value, const char* key, double limit) {
  return std::string{what} + " " + fixed(value, 2) + " < " + key + " " + fixed(limit, 2);
}

std::string fate_of(const SearchTrace::Finished& frame, const GateDetectorParams& params) {
  if (frame.taken) return "taken";
  if (frame.score.total < params.min_score)
    return below("score", frame.score.total, "min_score", params.min_score) +
           (frame.score.filled > 0.0
                ? ", " + fixed(frame.score.filled, 2) + " lost: filled, not what is around it"
                : "");
  if (frame.score.inside > params.max_inside)
    return "inside " + fixed(frame.score.inside, 2) + " > max_inside " +
           fixed(params.max_inside, 2) + ": the opening is not empty";
  return "refused";
}

std::string fate_of(const SearchTrace::Place& place, const SearchTrace& trace) {
  if (!place.has_shape) return "shape: no picture of a square";
  if (place.score.total < trace.least_rough)
    return "too little for a closer look: rough score " + fixed(place.score.total, 2) + " < " +
           fixed(trace.least_rough, 2);
  return trace.finished.full() ? "behind the best ones"
                               : "another frame in its place was preferred";
}

/// Frames that were looked at closely, then the best of the others, one a place.
std::vector<ConsideredFrame> considered_in(const SearchTrace& trace,
                                           const GateDetectorParams& params) {
  std::vector<ConsideredFrame> list;
  for (const SearchTrace::Finished& frame : trace.finished)
    list.push_back({frame.frame_px, frame.score, frame.taken, true, fate_of(frame, params)});
  std::stable_sort(list.begin(), list.end(), [](const auto& a, const auto& b) {
    return std::pair{a.taken, a.score.total} > std::pair{b.taken, b.score.total};
  });
  std::vector<SearchTrace::Place> places(trace.places.begin(), trace.places.end());
  std::stable_sort(places.begin(), places.end(),
                   [](const auto& a, const auto& b) { return a.score.total > b.score.total; });
  for (const SearchTrace::Place& place : places) {
    if (list.size() >= kListed) break;
    const bool known = std::any_of(list.begin(), list.end(), [&](const ConsideredFrame& other) {
      return same_place(other.bars_px, place.frame_px);
    });
    if (!known) list.push_back({place.frame_px, place.score, false, false, fate_of(place, trace)});
  }
  return list;
}

std::string words_of(const SearchReport& report, const GateDetectorParams& params) {
  const double best = report.fast.empty() ? 0.0 : score_of(report.fast[0].fitness);
  const bool sure = !report.fast.empty() && best >= params.sure_score;
  const std::string fast = report.fast.empty() ? "the fast search found no gate"
                                               : "the fast search found one of score " +
                                                     fixed(best, 2) + (sure ? " >= " : " < ") +
                                                     "sure_score " + fixed(params.sure_score, 2);
  if (report.answered.empty()) return fast + "; the careful one found none";
  switch (report.answered[0].method) {
    case DetectionMethod::kSnake:
      return fast + ": its answer stands";
    case DetectionMethod::kFrames:
      return fast + (sure ? ", but all gates were asked for or a bar stands beside it" : "") +
             ": the careful one answered";
    case DetectionMethod::kBars:
    case DetectionMethod::kOpening:
      break;
  }
  return fast + "; the careful one found none; a part of a gate is answered";
}

nlohmann::ordered_json corners_json(const Quad& quad) {
  auto corners = nlohmann::ordered_json::array();
  for (const auto& p : quad) corners.push_back({files::number(p.x()), files::number(p.y())});
  return corners;
}

nlohmann::ordered_json gate_json(const GateDetection& gate) {
  return {{"score", files::number(score_of(gate.fitness))},
          {"corners_px", corners_json(gate.corners_px)}};
}

}  // namespace

SearchReport explained(const Image& image, const PilotConfig& config,
                       const std::vector<GateDetection>& answered) {
  SearchReport report;
  report.answered = answered;
  PictureColor color{config.gate_color};
  if (config.detector.adapts) color.set(config.gate_color, tone_of(image, config.gate_color));
  report.map.fill(image, color);
  SnakeSearch fast{config.detector};
  report.fast = fast.detect(image, color);
  report.bars = fast.bars();
  CarefulSearch careful{config.detector};
  (void)careful.detect(image, color, nullptr, &report.trace);
  report.considered = considered_in(report.trace, config.detector);
  report.in_words = words_of(report, config.detector);
  return report;
}

nlohmann::ordered_json as_json(const SearchReport& report) {
  auto answered = nlohmann::ordered_json::array(), fast = nlohmann::ordered_json::array(),
       considered = nlohmann::ordered_json::array(), places = nlohmann::ordered_json::array();
  for (const GateDetection& gate : report.answered) answered.push_back(gate_json(gate));
  for (const GateDetection& gate : report.fast) fast.push_back(gate_json(gate));
  for (const ConsideredFrame& frame : report.considered) {
    const FrameScore& s = frame.score;
    considered.push_back({{"fate", frame.fate},
                          {"taken", frame.taken},
                          {"closely", frame.closely},
                          {"bars_px", corners_json(frame.bars_px)},
                          {"score",
                           {{"total", files::number(s.total)},
                            {"mean", files::number(s.mean)},
                            {"weakest", files::number(s.weakest)},
                            {"inside", files::number(s.inside)},
                            {"outside", files::number(s.outside)},
                            {"beyond", files::number(s.beyond)},
                            {"filled", files::number(s.filled)},
                            {"sides", {s.side[0], s.side[1], s.side[2], s.side[3]}}}}});
  }
  for (const SearchTrace::Place& place : report.trace.places)
    places.push_back({{"template_px", corners_json(place.template_px)},
                      {"frame_px", corners_json(place.frame_px)},
                      {"score", files::number(place.score.total)},
                      {"has_shape", place.has_shape}});
  return {{"in_words", report.in_words}, {"answered", answered},
          {"bars", report.bars.size()},  {"fast", fast},
          {"considered", considered},    {"places", places}};
}

}  // namespace gatefly::tasks
