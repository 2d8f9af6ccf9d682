// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/calibration/calibration_report.hpp"

#include <algorithm>
#include <iomanip>
#include <ostream>
#include <sstream>

#include "gatefly/files/json.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/tasks/calibration/with_sigma.hpp"

namespace gatefly::calibration {
namespace {

using files::fixed;
using files::number;
using Json = nlohmann::ordered_json;

constexpr double kWideCoverage = 0.7;  // below: the lens is extrapolated in the corners [estimate]

void write_parameters(std::ostream& out, const ModelResult& result) {
  const auto names = parameter_names(result.fit.model);
  for (std::size_t p = 0; p < names.size(); ++p) {
    const auto at = static_cast<Eigen::Index>(p);
    out << (p > 0 ? ", " : "") << names[p] << ' '
        << with_sigma(result.fit.parameters[at],
                      result.fit.sigma.size() > at ? result.fit.sigma[at] : 0.0);
  }
}

void write_models(std::ostream& out, const Calibration& answer) {
  out << std::left << std::setw(17) << "model" << std::right << std::setw(8) << "RMS px"
      << std::setw(13) << "held-out px"
      << "  parameters ± one standard deviation\n";
  for (std::size_t i = 0; i < answer.models.size(); ++i) {
    const ModelResult& result = answer.models[i];
    out << std::left << std::setw(17)
        << (i == answer.recommended ? "* " : "  ") + name_of(result.fit.model) << std::right
        << std::setw(8) << fixed(result.rms_px, 3) << std::setw(13) << fixed(result.held_out_px, 3)
        << "  ";
    if (result.fit.sigma.size() == 0) {
      out << "cannot be used: " << result.failure << '\n';
      continue;
    }
    write_parameters(out, result);
    if (!result.failure.empty()) out << "; not recommended: " << result.failure;
    out << '\n';
  }
}

void write_views(std::ostream& out, const Calibration& answer, const Boards& boards) {
  std::size_t width = 7;
  for (const ViewResult& view : answer.views) width = std::max(width, view.image.size());
  const int name = static_cast<int>(width) + 2;
  out << '\n'
      << std::left << std::setw(name) << "picture" << std::right
      << "corners  dropped  RMS px  max px\n";
  for (const ViewResult& view : answer.views) {
    out << std::left << std::setw(name) << view.image << std::right << std::setw(7) << view.corners
        << std::setw(9) << view.dropped;
    if (view.reason.empty())
      out << std::setw(8) << fixed(view.rms_px, 3) << std::setw(8) << fixed(view.max_px, 2) << '\n';
    else
      out << "  left out: " << view.reason << '\n';
  }
  for (const auto& [image, reason] : boards.without)
    out << std::left << std::setw(name) << image << std::right << std::setw(7) << 0
        << "           no board: " << reason << '\n';
}

void write_counts(std::ostream& out, const Calibration& answer, const Boards& boards) {
  std::size_t corners = 0, dropped = 0;
  for (const ViewResult& view : answer.views) {
    corners += view.corners;
    dropped += view.dropped;
  }
  out << files::amount(boards.pictures, "picture") << " of " << answer.size_px.x() << "x"
      << answer.size_px.y() << ", a board in " << answer.views.size() << ", " << answer.kept.size()
      << " of them used; " << corners << " corners, " << dropped << " dropped; they reach "
      << fixed(100.0 * answer.coverage, 0) << " % of the way to the picture's corners\n\n";
}

Json parameters_json(const ModelResult& result) {
  Json parameters = Json::object();
  const auto names = parameter_names(result.fit.model);
  for (std::size_t p = 0; p < names.size(); ++p) {
    const auto at = static_cast<Eigen::Index>(p);
    parameters[names[p]] = {
        {"value", number(result.fit.parameters[at])},
        {"sigma", result.fit.sigma.size() > at ? number(result.fit.sigma[at]) : Json()}};
  }
  return parameters;
}

Json models_of(const Calibration& answer) {
  Json models = Json::array();
  for (const ModelResult& result : answer.models)
    models.push_back({{"model", name_of(result.fit.model)},
                      {"rms_px", number(result.rms_px)},
                      {"held_out_px", number(result.held_out_px)},
                      {"parameters", parameters_json(result)},
                      {"failure", result.failure}});
  return models;
}

Json pictures_of(const Calibration& answer, const Boards& boards) {
  Json pictures = Json::array();
  for (const ViewResult& view : answer.views)
    pictures.push_back({{"image", view.image},
                        {"corners", view.corners},
                        {"dropped", view.dropped},
                        {"rms_px", view.rms_px},
                        {"max_px", view.max_px},
                        {"left_out", view.reason}});
  for (const auto& [image, reason] : boards.without)
    pictures.push_back({{"image", image}, {"corners", 0}, {"left_out", reason}});
  return pictures;
}

}  // namespace

std::string text_of(const Calibration& answer, const Boards& boards) {
  std::ostringstream out;
  write_counts(out, answer, boards);
  write_models(out, answer);
  write_views(out, answer, boards);
  out << "\n* recommended: the fewest parameters within one standard error of the best "
         "held-out residual\n";
  const std::string chosen = name_of(answer.best().fit.model);
  if (answer.chosen != answer.recommended) out << "asked for: " << chosen << '\n';
  if (!answer.best().failure.empty())
    out << "warning: " << chosen << ": " << answer.best().failure << '\n';
  if (answer.coverage < kWideCoverage)
    out << "warning: beyond the outermost corners the lens is extrapolated: hold the board "
           "into the picture's corners too\n";
  return out.str();
}

Json as_json(const Calibration& answer, const Boards& boards, int stored_rotation_deg,
             const std::string& doubt) {
  return {{"size_px", {answer.size_px.x(), answer.size_px.y()}},
          {"pictures", pictures_of(answer, boards)},
          {"models", models_of(answer)},
          {"recommended", name_of(answer.models[answer.recommended].fit.model)},
          {"chosen", name_of(answer.best().fit.model)},
          {"coverage", answer.coverage},
          {"unusable", boards.unusable},
          {"stored_rotation_deg", stored_rotation_deg},
          {"stored_rotation_doubt", doubt}};
}

std::vector<std::string> provenance(const Calibration& answer) {
  const ModelResult& best = answer.best();
  std::vector<std::string> lines{"Made by gatefly calibrate from " +
                                 files::amount(answer.kept.size(), "picture") +
                                 " of a board: RMS " + fixed(best.rms_px, 3) + " px, " +
                                 fixed(best.held_out_px, 3) + " px in pictures held out."};
  std::string sigmas;
  const auto names = parameter_names(best.fit.model);
  for (std::size_t p = 0; p < names.size() && static_cast<Eigen::Index>(p) < best.fit.sigma.size();
       ++p)
    sigmas += (p > 0 ? ", " : "") + names[p] + " " +
              files::text_of(best.fit.sigma[static_cast<Eigen::Index>(p)], 2);
  if (!sigmas.empty()) lines.push_back("One standard deviation: " + sigmas + ".");
  return lines;
}

}  // namespace gatefly::calibration
