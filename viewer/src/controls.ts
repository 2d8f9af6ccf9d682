// SPDX-License-Identifier: Apache-2.0
import type { Clock } from "./clock";
import { stretches, type Moment } from "./events";
import type { Flight } from "./flight";
import type { Range } from "./range";
import { color, onTheme } from "./theme";
import { byId } from "./text";

/** Colour of a phase's band; none for straights. */
export function bandOf(phase: string): string {
  return phase === "turn" ? color("turn") : phase === "search" ? color("search") : phase === "straight" ? "" : color("ground");
}

/** The bar at the foot: play, slider, clock, keyboard. */
export function startControls(flight: Flight, moments: Moment[], clock: Clock, range: Range): void {
  const play = byId<HTMLButtonElement>("play"), slider = byId<HTMLInputElement>("time");
  const rate = byId<HTMLSelectElement>("rate"), output = byId("clock"), strip = byId<HTMLCanvasElement>("strip");
  slider.min = "0";
  slider.step = "0.01";
  const ends = () => (slider.max = String(clock.end));
  ends();
  play.addEventListener("click", () => clock.play());
  slider.addEventListener("input", () => clock.seek(slider.valueAsNumber));
  rate.addEventListener("change", () => (clock.rate = Number(rate.value)));
  clock.onState(() => {
    play.textContent = clock.playing ? "❚❚" : "▶";
    play.setAttribute("aria-label", clock.playing ? "pause" : "play");
  });
  clock.onTime((time) => {
    slider.value = String(time);
    slider.setAttribute("aria-valuetext", `${time.toFixed(1)} seconds, ${flight.phase(flight.row(time))}`);
    output.textContent = `${time.toFixed(2)} s`;
  });

  document.addEventListener("keydown", (event) => {
    const on = event.target as HTMLElement;
    if (event.ctrlKey || event.altKey || event.metaKey || on.tagName === "SELECT") return;
    // It is for the button or the box.
    if (event.key === " " && (["BUTTON", "SUMMARY"].includes(on.tagName) || (on as HTMLInputElement).type === "checkbox")) return;
    const step = event.shiftKey ? 1 : 0.1;
    if (event.key === " ") clock.play();
    else if (event.key === "ArrowLeft") clock.seek(clock.time - step);
    else if (event.key === "ArrowRight") clock.seek(clock.time + step);
    else if (event.key === "Home") clock.seek(0);
    else if (event.key === "End") clock.seek(clock.end);
    else return;
    event.preventDefault();
  });

  const draw = () => {
    const ratio = devicePixelRatio || 1, width = strip.clientWidth, height = strip.clientHeight;
    strip.width = width * ratio;
    strip.height = height * ratio;
    const context = strip.getContext("2d")!;
    context.scale(ratio, ratio);
    const at = (t: number) => (t / clock.end) * width;
    flight.phases.forEach((phase) => {
      context.fillStyle = bandOf(phase) || color("panel");
      for (const [first, last] of stretches(flight.t.length, (row) => flight.phase(row) === phase))
        context.fillRect(at(flight.t[first]), 0, at(flight.t[last]) - at(flight.t[first]) + 1, height);
    });
    const mark = (t: number, name: string, half = 1) => {
      context.fillStyle = color(name);
      context.fillRect(Math.min(at(t) - half, width - 2 * half), 0, 2 * half, height);
    };
    flight.passes.forEach((pass) => pass.t !== undefined && mark(pass.t, "gate"));
    moments.forEach((moment) => moment.kind === "bad" && mark(moment.t, "bad", 2));
    if (!range.zoomed) return;
    context.strokeStyle = color("ink");
    context.lineWidth = 2;
    context.strokeRect(at(range.from) + 1, 1, at(range.to) - at(range.from) - 2, height - 2);
  };
  new ResizeObserver(draw).observe(strip);
  onTheme(draw);
  range.onChange(draw);
  clock.onEnd(() => { ends(); draw(); });
}
