// SPDX-License-Identifier: Apache-2.0
import type { Clock } from "./clock";
import type { Moment } from "./events";
import type { Flight } from "./flight";
import { byId, element, seconds } from "./text";

const SHOWN = 8;  // more are behind a button

/** Did it finish, how fast, what went wrong and when. */
export function showHeader(flight: Flight, moments: Moment[], clock: Clock): void {
  const s = flight.summary;
  const title = `${s.track}, seed ${s.seed}${s.vision === "ideal" ? ", ideal vision" : ""}`;
  document.title = `${title}: ${s.finished ? "finished" : s.stop_reason} · gatefly`;
  byId("title").textContent = title;
  byId("version").textContent = `gatefly ${s.version}`;

  const verdict = byId("verdict");
  verdict.textContent = flight.verdict.charAt(0).toUpperCase() + flight.verdict.slice(1);
  verdict.className = s.finished ? "good" : "bad";

  const figures = byId("figures");
  const figure = (name: string, value: string) => {
    const box = element("div");
    box.append(element("dt", name), element("dd", value));
    figures.append(box);
  };
  figure("gates", `${s.gates_passed} of ${s.gates_total}`);
  figure("race time", s.finished ? seconds(s.race_time_s) : "–");
  figure(s.lap_times_s.length === 1 ? "lap" : "laps", s.lap_times_s.map((t) => t.toFixed(1)).join(" · ") + (s.lap_times_s.length ? " s" : "none"));
  if (s.mean_speed_mps > 0) figure("speed", `${s.mean_speed_mps.toFixed(2)} mean, ${s.max_speed_mps.toFixed(2)} m/s max`);
  if (s.gates_passed > 1) figure("estimate", `${(100 * Math.hypot(...s.estimation_rmse_m)).toFixed(0)} cm rms`);
  if (s.detection.with_gate_visible > 0)
    figure("gate found in", `${((100 * s.detection.true_positives) / s.detection.with_gate_visible).toFixed(0)} % of ${s.detection.with_gate_visible} views`);
  figure("searches", String(s.searches));

  const list = byId("events");
  const chips = moments.map((moment) => {
    const chip = element("button", "", `chip ${moment.kind}`);
    chip.type = "button";
    chip.append(element("b", seconds(moment.t)), ` ${moment.text}`);
    // A second earlier: what led to it.
    chip.addEventListener("click", () => clock.seek(moment.t - (moment.kind === "bad" ? 1 : 0)));
    return chip;
  });
  const late = chips.length > SHOWN ? chips.slice(0, chips.length - SHOWN) : [];
  for (const chip of late) chip.hidden = true;
  if (late.length) {
    const more = element("button", `${late.length} earlier`, "chip plain");
    more.type = "button";
    more.addEventListener("click", () => { late.forEach((chip) => (chip.hidden = false)); more.remove(); });
    list.append(more);
  }
  list.append(...chips);
}
