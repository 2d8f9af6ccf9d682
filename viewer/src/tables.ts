// SPDX-License-Identifier: Apache-2.0
import type { Clock } from "./clock";
import type { Flight, Pass } from "./flight";
import { byId, element, seconds } from "./text";

export function head(table: HTMLElement, names: string[]): HTMLTableSectionElement {
  const row = element("tr");
  for (const name of names) {
    const cell = element("th", name);
    cell.scope = "col";
    row.append(cell);
  }
  const top = element("thead"), body = element("tbody");
  top.append(row);
  table.append(top, body);
  return body;
}

const side = (value: number, positive: string, negative: string) =>
  `${(100 * Math.abs(value)).toFixed(0)} cm ${value >= 0 ? positive : negative}`;

function cells(pass: Pass): string[] {
  const seen = pass.seen === undefined ? "never" : seconds(pass.seen) + (pass.seen_from === undefined ? "" : `, ${pass.seen_from.toFixed(1)} m before`);
  if (pass.t === undefined) return ["not passed", "–", "–", "–", seen];
  const [right, down] = pass.offset ?? [NaN, NaN];
  return [seconds(pass.t), pass.speed === undefined ? "–" : `${pass.speed.toFixed(2)} m/s`, pass.offset ? side(right, "right", "left") : "–",
          pass.offset ? side(down, "low", "high") : "–", seen];
}

/** Each gate of the race: a click goes there. */
export function showGates(flight: Flight, clock: Clock): void {
  const body = head(byId("gates"), ["gate", "lap", "passed", "speed", "across", "height", "first fix on it"]);
  const rows = flight.passes.map((pass) => {
    const row = element("tr");
    const link = element("button", String(pass.gate + 1), "link");
    const to = pass.t ?? pass.seen ?? flight.end;
    link.type = "button";
    link.setAttribute("aria-label", `go to gate ${pass.gate + 1}, lap ${pass.lap + 1}`);
    row.addEventListener("click", () => clock.seek(to));
    const first = element("td");
    first.append(link);
    row.append(first, element("td", String(pass.lap + 1)), ...cells(pass).map((text) => element("td", text)));
    if (pass.t === undefined) row.className = "bad";
    body.append(row);
    return row;
  });
  clock.onTime((time) => {
    const next = flight.passes.findIndex((pass) => pass.t === undefined || pass.t > time);
    rows.forEach((row, i) => row.setAttribute("aria-current", String(i === next)));
  });
}

export function showStages(flight: Flight): void {
  const body = head(byId("stages"), ["stage", "median", "99 %", "most"]);
  for (const [stage, cost] of Object.entries(flight.summary.timings)) {
    if (!("p50_us" in cost)) continue;
    const row = element("tr");
    row.append(element("td", stage), ...["p50_us", "p99_us", "max_us"].map((key) => element("td", `${cost[key].toFixed(1)} µs`)));
    body.append(row);
  }
  const whole = flight.summary.timings.whole_flight;
  if (whole) {
    const row = element("tr"), cell = element("td", `${whole.cpu_s.toFixed(1)} s CPU, ${whole.cpu_s_per_flight_s.toFixed(2)} s a second of flight`);
    cell.colSpan = 3;
    row.append(element("td", "whole flight"), cell);
    body.append(row);
  }
  byId("config").textContent = JSON.stringify(flight.summary.config, null, 1);
}
