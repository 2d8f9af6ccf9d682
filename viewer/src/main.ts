// SPDX-License-Identifier: Apache-2.0
import "./style.css";
import { Clock } from "./clock";
import { startControls } from "./controls";
import { moments } from "./events";
import { Flight } from "./flight";
import { showHeader } from "./header";
import { Onboard } from "./onboard";
import { Plots } from "./plots";
import { SceneView } from "./scene";
import { showGates, showStages } from "./tables";
import { startTheme } from "./theme";
import { byId, element } from "./text";

function legend(flight: Flight): void {
  const flown = flight.hasTruth ? "flown, coloured by speed" : "estimated path, coloured by speed";
  for (const [name, text] of [["flown", flown], ["estimate", "estimate, ±3σ"], ["plan", "plan and map"], ["gate", "gate"]]) {
    const entry = element("span", text);
    entry.style.setProperty("--line", `var(--${name})`);
    byId("legend").append(entry);
  }
}

function start(): void {
  const flight = new Flight(byId("flight").textContent!, byId("pictures").textContent!);
  const clock = new Clock(flight.end), found = moments(flight);
  startTheme(byId("theme"));
  legend(flight);
  showHeader(flight, found, clock);
  showGates(flight, clock);
  showStages(flight);
  startControls(flight, found, clock);
  const onboard = new Onboard(flight, clock);
  let scene: SceneView | null = null;
  try {
    scene = new SceneView(flight, clock);
  } catch {
    document.querySelector("#scene canvas")!.replaceWith(element("p", "The scene needs WebGL, which this browser does not offer here.", "none"));
  }
  const plots = new Plots(flight, clock);
  // What went wrong is on the first screen: a lost race opens a second before its end.
  const bad = found.find((moment) => moment.kind === "bad");
  clock.seek(bad ? bad.t - 1 : 0);
  // For tests: what each part shows.
  Object.assign(window, {
    __report: {
      flight, clock, film: onboard.film,
      state: () => ({ time: clock.time, playing: clock.playing, scene: scene?.stamp ?? null, frames: scene?.frames ?? 0, plots: plots.stamp, onboard: onboard.shown }),
    },
  });
}

start();
