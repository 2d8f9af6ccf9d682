// SPDX-License-Identifier: Apache-2.0
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { Clock } from "./clock";
import { bandOf } from "./controls";
import { sigma, stretches } from "./events";
import type { Flight } from "./flight";
import { color, onTheme } from "./theme";
import { byId, degrees, element } from "./text";

type Values = ArrayLike<number | null>;
interface Line {
  name: string; color: string; values: Float64Array;
  at?: number[];            // times of its own [s]; points
  dash?: boolean;
  sigma?: Float64Array;     // ±3 of it are filled, around the line ...
  aroundZero?: boolean;     // ... or around zero
  quiet?: boolean;          // neither in the key nor in the readout
}
interface Plot { title: string; unit: string; lines: Line[]; error?: boolean }

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
const drawn = (values: Float64Array): Values =>
  some(values, Number.isNaN) ? Array.from(values, (value) => (Number.isNaN(value) ? null : value)) : values;

function list(flight: Flight): Plot[] {
  const c = (name: string) => flight.column(name), have = (name: string) => (flight.has(name) ? c(name) : undefined);
  const known = (line: Line) => some(line.values, (value) => !Number.isNaN(value));
  const pair = (title: string, unit: string, truth: Float64Array, estimate: Float64Array, sigma?: Float64Array): Plot =>
    ({ title, unit, lines: [{ name: "truth", color: "flown", values: truth }, { name: "estimate", color: "estimate", values: estimate, sigma }].filter(known) });
  const up = (name: string) => Float64Array.from(c(name), (v) => -v);
  const speed = (prefix: string) => {
    const [x, y, z] = ["x", "y", "z"].map((axis) => c(`${prefix}v${axis}_mps`));
    return flight.each((i) => Math.hypot(x[i], y[i], z[i]));
  };
  const sigmas = sigma(flight), fixed = flight.looks.filter((look) => look.fix);
  const error = (axis: number, name: string): Plot => ({
    title: `error ${name}`, unit: "m", error: true,
    lines: [{ name: "truth − estimate", color: "flown", values: c(`error_${"xyz"[axis]}_m`), sigma: sigmas[axis], aroundZero: true },
            { name: "truth − fix", color: "found", at: fixed.map((look) => look.t), values: Float64Array.from(fixed, (look) => look.fix![axis]) }],
  });
  const speedError = (axis: string, name: string): Plot => ({
    title: `velocity error ${name}`, unit: "m/s", error: true,
    lines: [{ name: "truth − estimate", color: "flown", values: c(`error_v${axis}_mps`), sigma: have(`sigma_v${axis}_mps`), aroundZero: true }],
  });
  const angle = (name: string, sigmaName: string): Plot => {
    const plot = pair(name, "°", unwrapped(c(`${name}_rad`)), unwrapped(c(`est_${name}_rad`)), have(sigmaName)?.map(degrees));
    plot.lines.push({ name: "command", color: "plan", values: unwrapped(c(`cmd_${name}_rad`)), dash: true });
    return plot;
  };
  const COLORS = ["flown", "estimate", "found"];
  const biases = (title: string, unit: string, names: string[], truth: number[] | undefined, sigmaNames: string[] = [], scale = 1): Plot => ({
    title: truth ? `${title} (dashed: really)` : title, unit,
    lines: names.flatMap((name, i): Line[] => [
      { name: "xyz"[i], color: COLORS[i], values: Float64Array.from(c(name), (v) => v * scale), sigma: sigmaNames[i] ? have(sigmaNames[i]) : undefined },
      ...(truth ? [{ name: "", color: COLORS[i], values: flight.each(() => truth[i] * scale), dash: true, quiet: true }] : []),
    ]),
  });
  const wind = ["wind_north_mps", "wind_east_mps"].map(c);
  const nis = flight.looks.filter((look) => look.source && look.dof);
  const plots: Plot[] = [
    error(0, "along the gate's axis"), error(1, "across it"), error(2, "in height"),
    pair("north", "m", c("x_m"), c("est_x_m")), pair("east", "m", c("y_m"), c("est_y_m")), pair("height", "m", up("z_m"), up("est_z_m")),
    pair("speed", "m/s", speed(""), speed("est_")),
    speedError("x", "forward"), speedError("y", "to the right"), speedError("z", "downward"),
    angle("roll", "sigma_tilt_rad"), angle("pitch", "sigma_tilt_rad"), angle("yaw", "sigma_yaw_rad"),
    biases("accelerometer bias", "m/s²", ["bax_mps2", "bay_mps2", "baz_mps2"], flight.course.accel_bias_mps2, ["sigma_bax_mps2", "sigma_bay_mps2", "sigma_baz_mps2"]),
    biases("gyro bias", "°/s", ["bgx_radps", "bgy_radps", "bgz_radps"], flight.course.gyro_bias_radps, [], degrees(1)),
    { title: "NIS a degree of freedom (1 is as expected)", unit: "",
      lines: [{ name: "NIS", color: "found", at: nis.map((look) => look.t), values: Float64Array.from(nis, (look) => Math.min(look.nis! / look.dof!, 12)) }] },
  ];
  if (wind.some((values) => some(values, (value) => Math.abs(value) > 0)))
    plots.push({ title: "wind", unit: "m/s", lines: wind.map((values, i) => ({ name: ["to the north", "to the east"][i], color: COLORS[i], values })) });
  return plots.map((plot) => ({ ...plot, lines: plot.lines.filter(known) })).filter((plot) => plot.lines.length > 0);
}

/** Every plot shares the time axis and the cursor. */
export class Plots {
  /** Time at which the cursor line stands [s]. */
  stamp = 0;
  private plots: { chart: uPlot; needle: HTMLElement; readout: HTMLElement; plot: Plot; box: HTMLElement }[] = [];
  private range: [number, number];

  constructor(private readonly flight: Flight, private readonly clock: Clock) {
    this.range = [0, flight.end];
    const host = byId("plots");
    // Each when it comes into view: the page is there at once.
    const waiting = new Map<Element, Plot>();
    const seen = new IntersectionObserver((entries) => {
      for (const entry of entries) {
        const plot = waiting.get(entry.target);
        if (!entry.isIntersecting || !plot) continue;
        waiting.delete(entry.target);
        seen.unobserve(entry.target);
        this.add(entry.target as HTMLElement, plot);
      }
    }, { rootMargin: "400px" });
    for (const plot of list(flight)) {
      const box = element("div", "", "panel plot");
      box.append(element("h2", plot.unit ? `${plot.title} [${plot.unit}]` : plot.title));
      host.append(box);
      waiting.set(box, plot);
      seen.observe(box);
    }
    clock.onTime((time) => this.move(time));
    onTheme(() => {
      for (const { chart, box, plot } of this.plots.splice(0)) {
        chart.destroy();
        box.querySelector(".key")?.remove();
        this.add(box, plot);
      }
    });
    new ResizeObserver(() => {
      for (const { chart, box } of this.plots) chart.setSize({ width: box.clientWidth, height: 170 });
      this.move(clock.time);
    }).observe(host);
  }

  private add(box: HTMLElement, plot: Plot): void {
    const times = Array.from(this.flight.t), tables: Values[][] = [[times]];
    const series: uPlot.Series[] = [{}], bands: uPlot.Band[] = [];
    const put = (values: Values, how: uPlot.Series) => { tables[0].push(values); series.push(how); };
    for (const line of plot.lines) {
      const { sigma } = line;
      if (!sigma) continue;
      const edge = (sign: number) => drawn(Float64Array.from(sigma, (s, i) => (line.aroundZero ? 0 : line.values[i]) + 3 * sign * s));
      const how = { stroke: color("spread-line"), width: plot.error ? 1 : 0.5, points: { show: false } };
      put(edge(1), how);
      put(edge(-1), how);
      bands.push({ series: [series.length - 2, series.length - 1], fill: color("spread") });
    }
    const stroke = (line: Line) => color(line.color);
    for (const line of plot.lines.filter((each) => !each.at))
      put(drawn(line.values), { stroke: stroke(line), width: line.dash ? 1 : 1.5, dash: line.dash ? [4, 4] : undefined, points: { show: false } });
    for (const line of plot.lines.filter((each) => each.at)) {
      tables.push([line.at!, drawn(line.values)]);
      series.push({ stroke: stroke(line), width: 0, points: { show: true, size: 4, fill: stroke(line), stroke: stroke(line) } });
    }
    const data = tables.length > 1 ? uPlot.join(tables as unknown as uPlot.AlignedData[]) : tables[0];
    const axis = { stroke: color("muted"), grid: { stroke: color("grid"), width: 1 }, ticks: { show: false }, font: "11px system-ui, sans-serif" };
    const chart = new uPlot({
      width: box.clientWidth, height: 170, series, bands,
      legend: { show: false }, padding: [8, 12, 0, 0],
      scales: { x: { time: false, range: () => this.range }, y: plot.error ? { range: () => this.around(plot.lines[0]) } : {} },
      axes: [{ ...axis, size: 24, values: (_, ticks) => ticks.map((t) => `${t}`) }, { ...axis, size: 44 }],
      cursor: { drag: { x: false, y: false }, x: false, y: false, points: { show: false } },
      hooks: { drawClear: [(u) => this.paintBands(u)] },
    }, data as unknown as uPlot.AlignedData, box);
    const needle = element("div", "", "needle"), readout = element("span", "", "readout");
    chart.over.append(needle);
    const key = element("div", "", "key");
    const entry = (text: string, line: string) => {
      const name = element("span", text);
      name.style.setProperty("--line", color(line));
      key.append(name);
    };
    for (const line of plot.lines) if (!line.quiet) entry(line.name, line.color);
    if (plot.lines.some((line) => line.sigma)) entry("±3σ of the filter", "spread-line");
    key.append(readout);
    box.append(key);
    this.scrub(chart);
    this.plots.push({ chart, needle, readout, plot, box });
    this.move(this.clock.time);
  }

  /** The error fills the plot even where 3σ is far beyond it; a wild fix is cut off. */
  private around({ values, sigma }: Line): [number, number] {
    const errors = values.map(Math.abs).filter((value) => !Number.isNaN(value)), cut = (sigma ?? values).slice().sort();
    const most = Math.max(0.1, 1.4 * errors.reduce((a, b) => Math.max(a, b), 0), sigma ? 3.3 * cut[Math.floor(0.9 * cut.length)] : 0);
    return [-most, most];
  }

  /** The mouse or a finger on a plot moves the time. */
  private scrub(chart: uPlot): void {
    const go = (event: PointerEvent) => {
      const box = chart.over.getBoundingClientRect();
      this.clock.seek(chart.posToVal(event.clientX - box.left, "x"));
    };
    chart.over.addEventListener("pointerdown", (event) => {
      this.clock.play(false);
      chart.over.setPointerCapture(event.pointerId);
      go(event);
    });
    chart.over.addEventListener("pointermove", (event) => event.buttons & 1 && go(event));
  }

  private paintBands(u: uPlot): void {
    const { top, height } = u.bbox, context = u.ctx;
    for (const phase of this.flight.phases) {
      const band = bandOf(phase);
      if (!band) continue;
      context.fillStyle = band;
      for (const [first, last] of stretches(this.flight.t.length, (row) => this.flight.phase(row) === phase)) {
        const x = u.valToPos(this.flight.t[first], "x", true);
        context.fillRect(x, top, u.valToPos(this.flight.t[last], "x", true) - x + 1, height);
      }
    }
    context.fillStyle = color("gate");
    for (const pass of this.flight.passes)
      if (pass.t !== undefined) context.fillRect(u.valToPos(pass.t, "x", true), top, devicePixelRatio, height);
  }

  private move(time: number): void {
    this.stamp = time;
    const row = this.flight.row(time);
    for (const { chart, needle, readout, plot } of this.plots) {
      needle.style.transform = `translateX(${chart.valToPos(time, "x")}px)`;
      const lines = plot.lines.filter((line) => !line.at && !line.quiet);
      const value = (line: Line) => (Number.isNaN(line.values[row]) || row >= line.values.length ? "–" : line.values[row].toFixed(2));
      if (lines.length)
        readout.textContent = lines.map(value).join(" · ") + (plot.error && lines[0].sigma ? ` (±${(3 * lines[0].sigma[row]).toFixed(2)})` : "") + ` ${plot.unit}`;
    }
  }
}
