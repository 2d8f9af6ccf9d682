// SPDX-License-Identifier: Apache-2.0
import "./style.css";
import "./report.css";
import { Clock } from "./clock";
import { startControls } from "./controls";
import { ending, moments, opening } from "./events";
import { Flight } from "./flight";
import { showHeader } from "./header";
import { showHeadline } from "./headline";
import { Onboard } from "./onboard";
import { Plots } from "./plots";
import { Range } from "./range";
import { SceneView } from "./scene";
import { fastest, speedColor } from "./scene_parts";
import { startSecond, type Second } from "./second";
import { showGates, showStages } from "./tables";
import { onTheme, startTheme } from "./theme";
import { byId, element } from "./text";
import { startZoomKeys } from "./zoom";

function legend(flight: Flight): void {
  const scale = element("span", "", "scale"), colours = element("i");
  scale.append(flight.hasTruth ? "flown at 0 " : "estimated path at 0 ", colours, ` ${fastest(flight).toFixed(1)} m/s`);
  const paint = () => {
    const stops = Array.from({ length: 17 }, (_, i) => `#${speedColor(i / 16).getHexString()}`);
    colours.style.background = `linear-gradient(90deg, ${stops.join(", ")})`;
  };
  paint();
  onTheme(paint);
  byId("legend").append(scale);
  for (const [name, text] of [["estimate", "estimate, ±3σ"], ["plan", "plan and map"], ["gate", "gate"], ["second", "second flight"], ["bad", "lost here"]]) {
    const entry = element("span", text);
    entry.style.setProperty("--line", `var(--${name})`);
    entry.hidden = name === "second" || (name === "bad" && ending(flight).kind !== "bad");
    entry.dataset.entry = name;
    byId("legend").append(entry);
  }
}

function start(): void {
  const flight = new Flight(byId("flight").textContent!, byId("pictures").textContent!);
  const clock = new Clock(flight.end), range = new Range(clock), found = moments(flight);
  startTheme(byId("theme"));
  legend(flight);
  showHeader(flight, found, clock);
  showGates(flight, clock);
  showStages(flight);
  startControls(flight, found, clock, range);
  startZoomKeys(range);
  const onboard = new Onboard(flight, clock);
  let scene: SceneView | null = null;
  try {
    scene = new SceneView(flight, clock);
  } catch {
    document.querySelector("#scene canvas")!.replaceWith(element("p", "The scene needs WebGL, which this browser does not offer here.", "none"));
  }
  const plots = new Plots(flight, clock, range);
  showHeadline(flight, clock, () => {
    scene?.look("follow");
    byId("scene").scrollIntoView({ block: "nearest" });
  });
  let compared: Second | null = null;
  startSecond(flight, clock, (second) => {
    compared = second;
    scene?.show(second);
    plots.show(second);
    document.querySelector<HTMLElement>("[data-entry=second]")!.hidden = !second;
  });
  clock.seek(opening(flight));
  // For tests: what each part shows.
  Object.assign(window, {
    __report: {
      flight, clock, range, scene, plots, film: onboard.film, second: () => compared,
      state: () => ({ time: clock.time, playing: clock.playing, scene: scene?.stamp ?? null, frames: scene?.frames ?? 0, plots: plots.stamp, onboard: onboard.shown }),
    },
  });
}

start();
