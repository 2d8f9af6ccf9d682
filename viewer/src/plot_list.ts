// SPDX-License-Identifier: Apache-2.0
// Which plots a flight has.
import { sigma } from "./events";
import type { Flight, Look } from "./flight";
import { degrees } from "./text";

export type Values = ArrayLike<number | null>;
export interface Line {
  name: string; color: string; values: Float64Array;
  at?: number[];            // times of its own [s]; points
  dash?: boolean;
  sigma?: Float64Array;     // ±3 of it are filled, around the line ...
  aroundZero?: boolean;     // ... or around zero
  quiet?: boolean;          // neither in the key nor in the readout
}
export interface Plot {
  id: string; title: string; unit: string; lines: Line[];
  error?: boolean;
  alone?: boolean;          // of this flight only, a second one would be too much
}

/** Angles without jumps at ±180°. */
function unwrapped(values: Float64Array): Float64Array {
  const out = Float64Array.from(values, degrees);
  let last = NaN;
  for (let i = 0; i < out.length; ++i) {
    if (!Number.isNaN(last)) out[i] -= 360 * Math.round((out[i] - last) / 360);
    if (!Number.isNaN(out[i])) last = out[i];
  }
  return out;
}

const some = (values: ArrayLike<number>, is: (value: number) => boolean) => Array.prototype.some.call(values, is);
export const drawn = (values: Float64Array): Values =>
  some(values, Number.isNaN) ? Array.from(values, (value) => (Number.isNaN(value) ? null : value)) : values;

/** In the air, how long no picture has corrected the filter [s]. */
function sinceFix(flight: Flight): Float64Array {
  const fixes = flight.looks.filter((look) => look.source);
  let next = 0;
  return flight.each((row) => {
    while (next < fixes.length && fixes[next].t <= flight.t[row]) ++next;
    return next ? flight.t[row] - fixes[next - 1].t : NaN;
  });
}

/** Of one flight; what it does not know is left out. */
export function list(flight: Flight): Plot[] {
  const c = (name: string) => flight.column(name), have = (name: string) => (flight.has(name) ? c(name) : undefined);
  const known = (line: Line) => some(line.values, (value) => !Number.isNaN(value));
  const pair = (title: string, unit: string, truth: Float64Array, estimate: Float64Array, sigma?: Float64Array): Plot =>
    ({ id: title, title, unit, lines: [{ name: "truth", color: "flown", values: truth }, { name: "estimate", color: "estimate", values: estimate, sigma }].filter(known) });
  const up = (name: string) => Float64Array.from(c(name), (v) => -v);
  const speed = (prefix: string) => {
    const [x, y, z] = ["x", "y", "z"].map((axis) => c(`${prefix}v${axis}_mps`));
    return flight.each((i) => Math.hypot(x[i], y[i], z[i]));
  };
  const sigmas = sigma(flight), fixed = flight.looks.filter((look) => look.fix);
  const error = (axis: number, name: string): Plot => ({
    id: `error-${"xyz"[axis]}`, title: `error ${name}`, unit: "m", error: true,
    lines: [{ name: "truth − estimate", color: "flown", values: c(`error_${"xyz"[axis]}_m`), sigma: sigmas[axis], aroundZero: true },
            { name: "truth − fix", color: "found", at: fixed.map((look) => look.t), values: Float64Array.from(fixed, (look) => look.fix![axis]) }],
  });
  const speedError = (axis: string, name: string): Plot => ({
    id: `velocity-error-${axis}`, title: `velocity error ${name}`, unit: "m/s", error: true,
    lines: [{ name: "truth − estimate", color: "flown", values: c(`error_v${axis}_mps`), sigma: have(`sigma_v${axis}_mps`), aroundZero: true }],
  });
  const angle = (name: string, sigmaName: string): Plot => {
    const plot = pair(name, "°", unwrapped(c(`${name}_rad`)), unwrapped(c(`est_${name}_rad`)), have(sigmaName)?.map(degrees));
    plot.lines.push({ name: "command", color: "plan", values: unwrapped(c(`cmd_${name}_rad`)), dash: true });
    return plot;
  };
  const COLORS = ["flown", "estimate", "found"];
  const biases = (id: string, title: string, unit: string, names: string[], truth: number[] | undefined, sigmaNames: string[] = [], scale = 1): Plot => ({
    id, alone: true, title: truth ? `${title} (dashed: really)` : title, unit,
    lines: names.flatMap((name, i): Line[] => [
      { name: "xyz"[i], color: COLORS[i], values: Float64Array.from(c(name), (v) => v * scale), sigma: sigmaNames[i] ? have(sigmaNames[i]) : undefined },
      ...(truth ? [{ name: "", color: COLORS[i], values: flight.each(() => truth[i] * scale), dash: true, quiet: true }] : []),
    ]),
  });
  const wind = ["wind_north_mps", "wind_east_mps"].map(c);
  const nis = flight.looks.filter((look) => look.source && look.dof);
  const percent = (name: string) => Float64Array.from(c(name), (v) => 100 * v), limits = flight.course.rotor_limits_radps;
  const looked = (f: (look: Look) => number | undefined): Pick<Line, "at" | "values"> => {
    const known = flight.looks.filter((look) => f(look) !== undefined);
    return { at: known.map((look) => look.t), values: Float64Array.from(known, (look) => f(look)!) };
  };
  const plots: Plot[] = [
    error(0, "along the gate's axis"), error(1, "across it"), error(2, "in height"),
    { id: "since-fix", title: "time since a picture corrected the estimate", unit: "s", lines: [{ name: "since the last fix", color: "found", values: sinceFix(flight) }] },
    pair("speed", "m/s", speed(""), speed("est_")),
    { id: "wind", alone: true, title: "wind", unit: "m/s",
      lines: wind.some((values) => some(values, (value) => Math.abs(value) > 0))
        ? wind.map((values, i) => ({ name: ["to the north", "to the east"][i], color: COLORS[i], values })) : [] },
    pair("north", "m", c("x_m"), c("est_x_m")), pair("east", "m", c("y_m"), c("est_y_m")), pair("height", "m", up("z_m"), up("est_z_m")),
    speedError("x", "forward"), speedError("y", "to the right"), speedError("z", "downward"),
    angle("roll", "sigma_tilt_rad"), angle("pitch", "sigma_tilt_rad"), angle("yaw", "sigma_yaw_rad"),
    { id: "thrust", title: "thrust for each kilogram", unit: "m/s²",
      lines: [{ name: "felt by the accelerometer", color: "flown", values: c("thrust_mps2") }, { name: "command", color: "plan", values: c("cmd_thrust_mps2"), dash: true }] },
    { id: "rotors", alone: true, title: "rotor speeds asked for (dashed: limits)", unit: "rad/s",
      lines: [{ name: "fastest", color: "flown", values: c("rotor_fastest_radps") }, { name: "slowest", color: "estimate", values: c("rotor_slowest_radps") },
              ...(limits ?? []).map((limit): Line => ({ name: "", color: "plan", values: flight.each(() => limit), dash: true, quiet: true }))] },
    { id: "saturation", title: "a rotor at its limit", unit: "% of the time", lines: [{ name: "saturated", color: "bad", values: percent("rotor_saturated") }] },
    { id: "battery", title: "battery, under load", unit: "V", lines: [{ name: "voltage", color: "flown", values: c("battery_v") }] },
    { id: "latency", alone: true, title: "age of a picture when it arrives, and work on it", unit: "ms",
      lines: [{ name: "age", color: "found", ...looked((look) => (look.exposed < look.t ? 1000 * (look.t - look.exposed) : undefined)) },
              { name: "pilot's step on this computer", color: "estimate", ...looked((look) => look.took_ms) }] },
    biases("accelerometer-bias", "accelerometer bias", "m/s²", ["bax_mps2", "bay_mps2", "baz_mps2"], flight.course.accel_bias_mps2, ["sigma_bax_mps2", "sigma_bay_mps2", "sigma_baz_mps2"]),
    biases("gyro-bias", "gyro bias", "°/s", ["bgx_radps", "bgy_radps", "bgz_radps"], flight.course.gyro_bias_radps, [], degrees(1)),
    { id: "nis", alone: true, title: "NIS a degree of freedom (1 is as expected)", unit: "",
      lines: [{ name: "NIS", color: "found", at: nis.map((look) => look.t), values: Float64Array.from(nis, (look) => Math.min(look.nis! / look.dof!, 12)) }] },
  ];
  return plots.map((plot) => ({ ...plot, lines: plot.lines.filter(known) })).filter((plot) => plot.lines.some((line) => !line.quiet));
}
