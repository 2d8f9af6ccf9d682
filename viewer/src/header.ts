// SPDX-License-Identifier: Apache-2.0
import type { Clock } from "./clock";
import type { Moment } from "./events";
import type { Flight, Summary } from "./flight";
import { byId, element, seconds } from "./text";

const SHOWN = 8;  // more are behind a button

type Figure = (name: string, value: string) => void;
const centimetres = (error: number[]) => `${(100 * Math.hypot(...error)).toFixed(0)} cm rms`;

function raceFigures(s: Summary, figure: Figure): void {
  figure("gates", `${s.gates_passed} of ${s.gates_total}`);
  figure("race time", s.finished ? seconds(s.race_time_s) : "–");
  figure(s.lap_times_s.length === 1 ? "lap" : "laps", s.lap_times_s.map((t) => t.toFixed(1)).join(" · ") + (s.lap_times_s.length ? " s" : "none"));
  if (s.mean_speed_mps > 0) figure("speed", `${s.mean_speed_mps.toFixed(2)} mean, ${s.max_speed_mps.toFixed(2)} m/s max`);
  if (s.gates_passed > 1) figure("estimate", centimetres(s.estimation_rmse_m));
  if (s.detection.with_gate_visible > 0)
    figure("gate found in", `${((100 * s.detection.true_positives) / s.detection.with_gate_visible).toFixed(0)} % of ${s.detection.with_gate_visible} views`);
  figure("searches", String(s.searches));
}

function replayFigures(s: Summary, figure: Figure): void {
  figure("gates passed, as the pilot counts", String(s.gates_passed));
  figure("pictures", String(s.detection.frames));
  figure("fixes", String(s.fixes));
  figure("position error", s.position_rmse_m ? centimetres(s.position_rmse_m) : "not known");
  if (s.recorded) figure("recorded flight", s.recorded);
}

/** Did it finish, how fast, what went wrong and when. */
export function showHeader(flight: Flight, moments: Moment[], clock: Clock): void {
  const s = flight.summary;
  const replay = s.kind === "replay";
  const title = replay ? `replay of ${s.flight}` + (s.estimator === "imu15" ? ", by the classic inertial filter" : "")
    : `${s.track}, seed ${s.seed}${s.vision === "ideal" ? ", ideal vision" : ""}`;
  document.title = `${title}${replay ? "" : `: ${s.finished ? "finished" : s.stop_reason}`} · gatefly`;
  byId("title").textContent = title;
  byId("version").textContent = `gatefly ${s.version}`;

  const verdict = byId("verdict");
  verdict.textContent = flight.verdict.charAt(0).toUpperCase() + flight.verdict.slice(1);
  if (!replay) verdict.className = s.finished ? "good" : "bad";

  const figures = byId("figures");
  const figure = (name: string, value: string) => {
    const box = element("div");
    box.append(element("dt", name), element("dd", value));
    figures.append(box);
  };
  if (replay) replayFigures(s, figure);
  else raceFigures(s, figure);

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
