// SPDX-License-Identifier: Apache-2.0
import type { Flight } from "./flight";
import { seconds } from "./text";

/** What one wants to jump to. */
export interface Moment { t: number; text: string; kind: "bad" | "warn" | "gate" | "plain" }

const OUTSIDE = 3;         // standard deviations
const OUTSIDE_FOR = 0.4;   // shorter is chance [s]
const BLIND_FOR = 3.0;     // a long turn is 2.5 [s]

/** Each stretch of rows where `is` holds, as first and last row. */
export function stretches(count: number, is: (row: number) => boolean): [number, number][] {
  const found: [number, number][] = [];
  for (let row = 0; row < count; ++row) {
    if (!is(row)) continue;
    const first = row;
    while (row + 1 < count && is(row + 1)) ++row;
    found.push([first, row]);
  }
  return found;
}

const racing = (flight: Flight, row: number) => ["straight", "turn", "search"].includes(flight.phase(row));

function searches(flight: Flight): Moment[] {
  const target = flight.column("target_gate");
  return stretches(flight.t.length, (row) => flight.phase(row) === "search").map(([first, last]) => ({
    t: flight.t[first], kind: "warn",
    text: `searched for gate ${target[first] + 1}, ${seconds(flight.t[last] - flight.t[first])}`,
  }));
}

/** Where the error was larger than the filter said it could be. */
function surprises(flight: Flight): Moment[] {
  const moments: Moment[] = [];
  const sigmas = sigma(flight);
  ["along the axis", "across it", "in height"].forEach((name, axis) => {
    const error = flight.column(`error_${"xyz"[axis]}_m`);
    const outside = (row: number) => racing(flight, row) && Math.abs(error[row]) > OUTSIDE * sigmas[axis][row];
    for (const [first, last] of stretches(flight.t.length, outside)) {
      if (flight.t[last] - flight.t[first] < OUTSIDE_FOR) continue;
      let worst = first;
      for (let row = first; row <= last; ++row) if (Math.abs(error[row]) > Math.abs(error[worst])) worst = row;
      moments.push({ t: flight.t[first], kind: "warn", text: `position ${name} off by ${Math.abs(error[worst]).toFixed(2)} m, beyond 3σ` });
    }
  });
  return moments;
}

/** Long without a fix. */
function blindness(flight: Flight): Moment[] {
  const moments: Moment[] = [];
  const flown = stretches(flight.t.length, (row) => racing(flight, row));
  if (!flown.length) return [];
  let since = flight.t[flown[0][0]];
  const until = flight.t[flown[flown.length - 1][1]];
  const close = (t: number) => {
    if (t - since > BLIND_FOR) moments.push({ t: since, kind: "warn", text: `no fix for ${seconds(t - since)}` });
  };
  for (const look of flight.looks) {
    if (!look.source || look.t < since || look.t > until) continue;
    close(look.t);
    since = look.t;
  }
  close(until);
  return moments;
}

/** How it ended. */
export function ending(flight: Flight): Moment {
  const s = flight.summary;
  if (s.kind === "replay") return { t: flight.end, kind: "plain", text: "end of the log" };
  if (s.crash) return { t: Math.min(s.crash.t_s, flight.end), kind: "bad", text: `crashed into ${s.crash.object}` };
  if (s.finished) {
    const last = flight.passes.filter((pass) => pass.t !== undefined).pop();
    return { t: last?.t ?? flight.end, kind: "gate", text: "finished" };
  }
  if (s.stop_reason === "abort") {
    const land = stretches(flight.t.length, (row) => flight.phase(row) === "land")[0];
    return { t: land ? flight.t[land[0]] : flight.end, kind: "bad", text: `given up: ${s.abort_reason}` };
  }
  return { t: flight.end, kind: "bad", text: s.stop_reason };
}

/** Where the three sigmas of the error in the target gate's frame come from: rows of the Cholesky factor. */
export function sigma(flight: Flight): [Float64Array, Float64Array, Float64Array] {
  const l = (name: string) => flight.column(`l_${name}_m`);
  const [xx, yx, yy, zx, zy, zz] = ["xx", "yx", "yy", "zx", "zy", "zz"].map(l);
  return [flight.each((i) => xx[i]), flight.each((i) => Math.hypot(yx[i], yy[i])), flight.each((i) => Math.hypot(zx[i], zy[i], zz[i]))];
}

/** A second before the first gate, passed or not: by then something happens. */
export function opening(flight: Flight): number {
  const flying = stretches(flight.t.length, (row) => racing(flight, row))[0];
  return Math.max(flying ? flight.t[flying[0]] : 0, (flight.passes[0]?.t ?? ending(flight).t) - 1);
}

/** In the order of time; the end is always among them. */
export function moments(flight: Flight): Moment[] {
  const end = ending(flight);
  const all = [...searches(flight), ...surprises(flight), ...blindness(flight), end];
  if (flight.summary.landing_contact)
    all.push({ t: flight.end, kind: "warn", text: `touched ${flight.summary.landing_contact} while landing` });
  return all.sort((a, b) => a.t - b.t);
}
