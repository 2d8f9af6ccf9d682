// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/results/result_card.hpp"

#include <algorithm>
#include <sstream>
#include <vector>

#include "gatefly/files/text.hpp"
#include "gatefly/simulated_race/results/loss_report.hpp"

namespace gatefly::simulated_race {
namespace {

/// Words on lines that are not wider than that.
std::vector<std::string> wrapped(drawing::Canvas& canvas, const std::string& text,
                                 const drawing::Lettering& lettering, double width) {
  std::vector<std::string> lines;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const std::string longer = lines.empty() ? word : lines.back() + " " + word;
    if (lines.empty() || canvas.text_width(longer, lettering) > width)
      lines.push_back(word);
    else
      lines.back() = longer;
  }
  return lines;
}

/// In letters as large as fit.
void draw_fitted(drawing::Canvas& canvas, const Eigen::Vector2d& at, const std::string& line,
                 drawing::Lettering lettering, double width) {
  // Letters have whole pixels: their width does not follow their size exactly.
  for (double wide = canvas.text_width(line, lettering); wide > width && lettering.size > 1.0;
       wide = canvas.text_width(line, lettering))
    lettering.size *= std::min(0.98, width / wide);
  canvas.text(at, line, lettering);
}

struct CardLine {
  std::string name, text;
};

std::vector<CardLine> card_lines(const RaceResult& r) {
  std::string laps;
  for (const double lap : r.lap_times)
    laps += (laps.empty() ? "" : ", ") + files::fixed(lap, 1) + " s";
  std::vector<CardLine> lines{
      {"gates", std::to_string(r.gates_passed) + " of " + std::to_string(r.gates_total)},
      {"laps", laps.empty() ? "none" : laps}};
  if (r.finished) lines.push_back({"race time", files::fixed(r.race_time, 1) + " s"});
  if (r.gates_passed > 1)
    lines.push_back({"mean speed", files::fixed(r.mean_speed, 2) + " m/s, at most " +
                                       files::fixed(r.max_speed, 2) + " m/s"});
  if (r.gates_passed > 0)
    lines.push_back({"estimation error", files::fixed(r.estimation_rmse.x(), 2) + ", " +
                                             files::fixed(r.estimation_rmse.y(), 2) + ", " +
                                             files::fixed(r.estimation_rmse.z(), 2) +
                                             " m RMS (north, east, down)"});
  return lines;
}

}  // namespace

void draw_result_card(drawing::Canvas& canvas, const RaceResult& result,
                      const std::string& verdict) {
  constexpr double kCard = 860.0, kLine = 50.0, kInside = 48.0;  // [px]
  constexpr double kWhyLine = 28.0;
  const drawing::Lettering why_letters{.color = drawing::kDark.ink, .size = 19};
  const std::vector<CardLine> lines = card_lines(result);
  const auto why = wrapped(canvas, loss_line(result), why_letters, kCard - 2 * kInside);
  const double why_height = why.empty() ? 0.0 : kWhyLine * static_cast<double>(why.size()) + 18.0;
  const double height = 170.0 + why_height + kLine * static_cast<double>(lines.size());
  const drawing::Box card{0.5 * (canvas.width() - kCard), 0.5 * (canvas.height() - height), kCard,
                          height};
  canvas.fill({0, 0, 1.0 * canvas.width(), 1.0 * canvas.height()}, drawing::kDark.well.faded(0.72));
  const drawing::Color& color = result.finished ? drawing::kDark.good : drawing::kDark.bad;
  canvas.fill({card.x - 2, card.y - 2, card.width + 4, card.height + 4}, drawing::kDark.rule, 14.0);
  canvas.fill(card, drawing::kDark.panel, 12.0);
  canvas.fill({card.x + kInside, card.y + 36, 8, 76}, color, 4.0);
  const double text = card.x + kInside + 26, width = card.right() - kInside - text;
  canvas.text({text, card.y + 66}, result.finished ? "Finished" : "Not finished",
              {.color = color, .size = 36, .bold = true});
  draw_fitted(canvas, {text, card.y + 104}, verdict, {.color = drawing::kDark.ink, .size = 20},
              width);
  double y = card.y + 126;
  for (const std::string& line : why)
    canvas.text({card.x + kInside, y += kWhyLine}, line, why_letters);
  y = card.y + 122 + why_height;
  for (const CardLine& line : lines) {
    y += kLine;
    canvas.line({card.x + kInside, y - 34}, {card.right() - kInside, y - 34},
                {.color = drawing::kDark.rule, .width = 1.0});
    canvas.text({card.x + kInside, y}, line.name, {.color = drawing::kDark.muted, .size = 21});
    draw_fitted(canvas, {card.x + 270, y}, line.text,
                {.color = drawing::kDark.ink, .size = 23, .bold = true},
                card.right() - kInside - card.x - 270);
  }
}

}  // namespace gatefly::simulated_race
