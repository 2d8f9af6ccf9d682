// SPDX-License-Identifier: Apache-2.0
#include "gatefly/report/flight_page.hpp"

#include <utility>

#include "gatefly/files/base64.hpp"
#include "gatefly/report/page.hpp"

namespace gatefly::report {
namespace {

using Json = nlohmann::ordered_json;

Json phase_names() {
  return Json::array({gatefly::name_of(OnGround{}), gatefly::name_of(TakeOff{}),
                      gatefly::name_of(Straight{}), gatefly::name_of(Turn{}),
                      gatefly::name_of(Search{}), gatefly::name_of(Land{}),
                      gatefly::name_of(Landed{})});
}

std::string script(const std::string& type, const std::string& id, const std::string& content) {
  return "<script type=\"" + type + "\" id=\"" + id + "\">" + content + "</script>\n";
}

PageTick page_tick(const flight_log::Tick& tick) {
  return {.sensors = tick.sensors,
          .command = tick.command,
          .pilot = tick.pilot,
          .p_EB = tick.truth.p_EB,
          .v_E = tick.truth.v_E,
          .attitude = tick.truth.attitude,
          .wind_E = tick.truth.wind_E,
          .exposed = tick.exposed,
          .battery_v = tick.truth.battery_v,
          .took = tick.took};
}

double seconds_of(const PageTick& tick) {
  return 1e-9 * static_cast<double>(tick.sensors.time.count());
}

}  // namespace

FlightPage::FlightPage(std::string page, PageCourse course, std::filesystem::path film)
    : page_{std::move(page)}, course_{std::move(course)}, looks_{std::move(film)} {}

void FlightPage::record(const flight_log::Tick& tick) { record(page_tick(tick)); }
void FlightPage::end(const flight_log::Tick& tick) { end(page_tick(tick)); }

void FlightPage::record(const PageTick& tick) {
  const double now = seconds_of(tick);
  if (!plan_) plan_ = tick.pilot.plan();
  passes_.add(tick, course_, now);
  if (tick.sensors.image || tick.sensors.seen) looks_.add(tick, course_, *plan_, now);
  columns_.add(tick, course_, now);
}

void FlightPage::end(const PageTick& tick) { columns_.end(tick, course_, seconds_of(tick)); }

std::string FlightPage::html(const Json& summary, const std::string& verdict) {
  const std::string film = looks_.film().finish();
  Json flight{{"format", 2},
              {"verdict", verdict},
              {"why", summary.value("why_lost", Json{})},
              {"summary", summary},
              {"phases", phase_names()},
              {"camera", {looks_.picture_width(), looks_.picture_height()}},
              {"course", as_json(course_, plan_)},
              {"passes", passes_.json(course_, looks_.all(), summary)}};
  if (!film.empty())
    flight["film"] = {{"rate", OnboardFilm::kRate}, {"pictures", looks_.film().pictures()}};
  if (looks_.film().failed()) flight["film_failed"] = true;
  std::string html = filled(flight, film, 1);
  for (std::size_t step = 2; html.size() > kMostBytes && step <= looks_.all().size(); step *= 2)
    html = filled(flight, film, step);
  return html;
}

/// The page with every `step`-th picture, or, where those are a film, row.
std::string FlightPage::filled(const Json& flight, const std::string& film,
                               std::size_t step) const {
  Json with_looks = flight;
  with_looks["looks"] = looks_.json(step);
  std::string told = in_a_script(with_looks);
  told.pop_back();  // the brace: columns are the largest part, and written by hand
  told += ",\"columns\":" + columns_.json(film.empty() ? 1 : step) + "}";
  return with_elements(page_,
                       script("application/json", "flight", told) +
                           script("application/json", "pictures", looks_.jpegs(step)) +
                           (film.empty() ? "" : script("text/plain", "film", files::base64(film))));
}

}  // namespace gatefly::report
