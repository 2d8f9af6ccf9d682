// SPDX-License-Identifier: Apache-2.0
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { Clock } from "./clock";
import { bandOf } from "./controls";
import { sigma, stretches } from "./events";
import type { Flight } from "./flight";
import { color, onTheme } from "./theme";
import { byId, degrees, element } from "./text";

interface Line { name: string; color: string; values: ArrayLike<number | null>; dash?: boolean; points?: boolean }
interface Plot { title: string; unit: string; lines: Line[]; spread?: Float64Array; at?: number[] }

/** Angles without jumps at ±180°. */
function unwrapped(values: Float64Array): Float64Array {
  const out = Float64Array.from(values, degrees);
  for (let i = 1; i < out.length; ++i) out[i] -= 360 * Math.round((out[i] - out[i - 1]) / 360);
  return out;
}

function list(flight: Flight): Plot[] {
  const c = (name: string) => flight.column(name);
  const pair = (title: string, unit: string, truth: Float64Array, estimate: Float64Array): Plot =>
    ({ title, unit, lines: [{ name: "truth", color: "flown", values: truth }, { name: "estimate", color: "estimate", values: estimate }] });
  const speed = (prefix: string) => {
    const [x, y, z] = ["x", "y", "z"].map((axis) => c(`${prefix}v${axis}_mps`));
    return flight.each((i) => Math.hypot(x[i], y[i], z[i]));
  };
  const sigmas = sigma(flight);
  const error = (axis: number, name: string): Plot => ({
    title: `error ${name}`, unit: "m", spread: sigmas[axis],
    lines: [{ name: "truth − estimate", color: "flown", values: c(`error_${"xyz"[axis]}_m`) }],
  });
  const angle = (name: string): Plot => {
    const plot = pair(name, "°", unwrapped(c(`${name}_rad`)), unwrapped(c(`est_${name}_rad`)));
    plot.lines.push({ name: "command", color: "plan", values: unwrapped(c(`cmd_${name}_rad`)), dash: true });
    return plot;
  };
  const three = (title: string, unit: string, names: string[], scale = 1): Plot => ({
    title, unit, lines: names.map((name, i) => ({ name: "xyz"[i], color: ["flown", "estimate", "found"][i], values: Float64Array.from(c(name), (v) => v * scale) })),
  });
  const fixes = flight.looks.filter((look) => look.source && look.dof);
  return [
    error(0, "along the gate's axis"), error(1, "across it"), error(2, "in height"),
    pair("height", "m", flight.each((i) => -c("z_m")[i]), flight.each((i) => -c("est_z_m")[i])),
    pair("speed", "m/s", speed(""), speed("est_")),
    angle("roll"), angle("pitch"), angle("yaw"),
    three("accelerometer bias", "m/s²", ["bax_mps2", "bay_mps2", "baz_mps2"]),
    three("gyro bias", "°/s", ["bgx_radps", "bgy_radps", "bgz_radps"], degrees(1)),
    { title: "NIS a degree of freedom (1 is as expected)", unit: "", at: fixes.map((look) => look.t),
      lines: [{ name: "NIS", color: "found", values: fixes.map((look) => Math.min(look.nis! / look.dof!, 12)), points: true }] },
  ];
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
    const times = plot.at ?? Array.from(this.flight.t);
    const data: (ArrayLike<number | null>)[] = [times, ...plot.lines.map((line) => line.values)];
    const series: uPlot.Series[] = [{}, ...plot.lines.map((line): uPlot.Series => ({
      label: line.name, stroke: color(line.color), width: line.points ? 0 : line.dash ? 1 : 1.5, dash: line.dash ? [4, 4] : undefined,
      points: line.points ? { show: true, size: 4, fill: color(line.color), stroke: color(line.color) } : { show: false },
    }))];
    const bands: uPlot.Band[] = [];
    if (plot.spread) {
      const edge = { stroke: color("spread-line"), width: 1, points: { show: false } };
      data.push(Float64Array.from(plot.spread, (s) => 3 * s), Float64Array.from(plot.spread, (s) => -3 * s));
      series.push({ label: "+3σ", ...edge }, { label: "−3σ", ...edge });
      bands.push({ series: [plot.lines.length + 1, plot.lines.length + 2], fill: color("spread") });
    }
    const axis = { stroke: color("muted"), grid: { stroke: color("grid"), width: 1 }, ticks: { show: false }, font: "11px system-ui, sans-serif" };
    const chart = new uPlot({
      width: box.clientWidth, height: 170, series, bands,
      legend: { show: false }, padding: [8, 12, 0, 0],
      scales: { x: { time: false, range: () => this.range }, y: plot.spread ? { range: (_, low, high) => this.around(plot, low, high) } : {} },
      axes: [{ ...axis, size: 24, values: (_, ticks) => ticks.map((t) => `${t}`) }, { ...axis, size: 44 }],
      cursor: { drag: { x: false, y: false }, x: false, y: false, points: { show: false } },
      hooks: { drawClear: [(u) => this.paintBands(u)] },
    }, data as unknown as uPlot.AlignedData, box);
    const needle = element("div", "", "needle"), readout = element("span", "", "readout");
    chart.over.append(needle);
    const key = element("div", "", "key");
    for (const line of plot.lines) {
      const name = element("span", line.name);
      name.style.setProperty("--line", color(line.color));
      key.append(name);
    }
    if (plot.spread) {
      const name = element("span", "±3σ of the filter");
      name.style.setProperty("--line", color("spread-line"));
      key.append(name);
    }
    key.append(readout);
    box.append(key);
    this.scrub(chart);
    this.plots.push({ chart, needle, readout, plot, box });
    this.move(this.clock.time);
  }

  /** The error fills the plot even where 3σ is far beyond it. */
  private around(plot: Plot, low: number, high: number): [number, number] {
    let most = 0.1;
    const values = plot.lines[0].values, cut = plot.spread!;
    for (let i = 0; i < cut.length; ++i) most = Math.max(most, Math.abs(values[i] ?? 0) * 1.4);
    const typical = Float64Array.from(cut).sort()[Math.floor(0.9 * cut.length)] * 3.3;
    most = Math.min(Math.max(most, typical), Math.max(most, -low, high));
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
      if (!plot.at)
        readout.textContent = plot.lines.map((line) => (line.values[row] ?? NaN).toFixed(2)).join(" · ") +
          (plot.spread ? ` (±${(3 * plot.spread[row]).toFixed(2)})` : "") + ` ${plot.unit}`;
    }
  }
}
