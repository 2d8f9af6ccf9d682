// SPDX-License-Identifier: Apache-2.0
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { Clock } from "./clock";
import { bandOf } from "./controls";
import { ending, stretches } from "./events";
import type { Flight } from "./flight";
import { PlotChoice } from "./plot_choice";
import { drawn, list, type Line, type Plot, type Values } from "./plot_list";
import type { Range } from "./range";
import type { Second } from "./second";
import { color, onTheme } from "./theme";
import { byId, element } from "./text";
import { startZoom } from "./zoom";

const HEIGHT = 170, DISTINCT = 16;  // of a plot, between two gates' numbers [px]

interface Shown { chart: uPlot; needle: HTMLElement; readout: HTMLElement; plot: Plot; box: HTMLElement }

/** Every plot shares the time axis, what of it is shown, and the cursor. */
export class Plots {
  /** Time at which the cursor line stands [s]. */
  stamp = 0;
  private plots: Shown[] = [];
  private second: Second | null = null;
  private secondPlots = new Map<string, Plot>();

  constructor(private readonly flight: Flight, private readonly clock: Clock, private readonly range: Range) {
    const host = byId("plots"), all = list(flight), choice = new PlotChoice(all);
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
    for (const plot of all) {
      const box = element("div", "", "panel plot"), head = element("div", "", "head");
      head.append(element("h2", plot.unit ? `${plot.title} [${plot.unit}]` : plot.title), choice.hider(plot, box));
      box.append(head);
      host.append(box);
      waiting.set(box, plot);
      seen.observe(box);
    }
    clock.onTime((time) => this.move(time));
    range.onChange(() => {
      for (const { chart } of this.plots) this.fit(chart);
      this.move(clock.time);
    });
    onTheme(() => this.again());
    new ResizeObserver(() => {
      for (const { chart, box } of this.plots) if (box.clientWidth) chart.setSize({ width: box.clientWidth, height: HEIGHT });
      this.move(clock.time);
    }).observe(host);
  }

  /** What each drawn plot shows [s]; for tests. */
  ranges(): number[][] { return this.plots.map(({ chart }) => [chart.scales.x.min!, chart.scales.x.max!]); }

  /** Another flight beside this one; null: alone again. */
  show(second: Second | null): void {
    this.second = second;
    this.secondPlots = new Map(second ? list(second.flight).map((plot) => [plot.id, plot]) : []);
    this.again();
  }

  private again(): void {
    for (const { chart, box, plot } of this.plots.splice(0)) {
      chart.destroy();
      box.querySelector(".key")?.remove();
      this.add(box, plot);
    }
  }

  /** What the second flight has to say to a plot of the first. */
  private other(plot: Plot): Line | undefined {
    return plot.alone ? undefined : this.secondPlots.get(plot.id)?.lines.find((line) => !line.at && !line.quiet);
  }

  private add(box: HTMLElement, plot: Plot): void {
    const times = Array.from(this.flight.t), tables: Values[][] = [[times]];
    const series: uPlot.Series[] = [{}], bands: uPlot.Band[] = [], other = this.other(plot);
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
    if (other && this.second) {
      const { flight, shift } = this.second;
      tables.push([Array.from(flight.t, (t) => t + shift), drawn(other.values)]);
      series.push({ stroke: color("second"), width: 1.5, points: { show: false } });
    }
    const data = tables.length > 1 ? uPlot.join(tables as unknown as uPlot.AlignedData[]) : tables[0];
    const axis = { stroke: color("muted"), grid: { stroke: color("grid"), width: 1 }, ticks: { show: false }, font: "11px system-ui, sans-serif" };
    const chart = new uPlot({
      width: box.clientWidth, height: HEIGHT, series, bands,
      legend: { show: false }, padding: [8, 12, 0, 0],
      scales: {
        x: { time: false, range: () => [this.range.from, this.range.to] },
        y: plot.error ? { range: () => this.around(plot.lines[0]) } : {},
      },
      axes: [{ ...axis, size: 24, values: (_, ticks) => ticks.map((t) => `${t}`) }, { ...axis, size: 44 }],
      cursor: { drag: { x: false, y: false }, x: false, y: false, points: { show: false } },
      hooks: { drawClear: [(u) => this.paintBands(u)] },
    }, data as unknown as uPlot.AlignedData, box);
    const needle = element("div", "", "needle"), readout = element("span", "", "readout");
    chart.over.append(needle);
    box.append(this.key(plot, other, readout));
    startZoom(chart, this.clock, this.range);
    this.plots.push({ chart, needle, readout, plot, box });
    this.move(this.clock.time);
  }

  private key(plot: Plot, other: Line | undefined, readout: HTMLElement): HTMLElement {
    const key = element("div", "", "key");
    const entry = (text: string, line: string) => {
      const name = element("span", text);
      name.style.setProperty("--line", color(line));
      key.append(name);
    };
    for (const line of plot.lines) if (!line.quiet) entry(line.name, line.color);
    if (plot.lines.some((line) => line.sigma)) entry("±3σ of the filter", "spread-line");
    if (other) entry(`second flight: ${other.name}`, "second");
    key.append(readout);
    return key;
  }

  private fit(chart: uPlot): void { chart.setScale("x", { min: this.range.from, max: this.range.to }); }

  /** The error fills the plot even where 3σ is far beyond it; a wild fix is cut off. */
  private around(line: Line): [number, number] {
    const first = this.flight.row(this.range.from), last = this.flight.row(this.range.to) + 1;
    const values = line.values.subarray(first, last), sigma = line.sigma?.subarray(first, last);
    const errors = values.map(Math.abs).filter((value) => !Number.isNaN(value)), cut = (sigma ?? values).slice().sort();
    const most = Math.max(0.1, 1.4 * errors.reduce((a, b) => Math.max(a, b), 0), sigma ? 3.3 * cut[Math.floor(0.9 * cut.length)] : 0);
    return [-most, most];
  }

  private paintBands(u: uPlot): void {
    const { left, top, width, height } = u.bbox, context = u.ctx, at = (t: number) => u.valToPos(t, "x", true);
    context.save();
    context.beginPath();
    context.rect(left, top, width, height);
    context.clip();
    for (const phase of this.flight.phases) {
      const band = bandOf(phase);
      if (!band) continue;
      context.fillStyle = band;
      for (const [first, last] of stretches(this.flight.t.length, (row) => this.flight.phase(row) === phase))
        context.fillRect(at(this.flight.t[first]), top, at(this.flight.t[last]) - at(this.flight.t[first]) + 1, height);
    }
    const ratio = devicePixelRatio || 1;
    context.font = `${10 * ratio}px system-ui, sans-serif`;
    let free = -Infinity;  // from here on a number covers no other
    for (const { t, gate } of this.flight.passes) {
      if (t === undefined) continue;
      context.fillStyle = color("gate");
      context.fillRect(at(t), top, ratio, height);
      if (at(t) < free) continue;
      context.fillText(String(gate + 1), at(t) + 3 * ratio, top + 10 * ratio);
      free = at(t) + DISTINCT * ratio;
    }
    this.paintEnd(u, this.flight, 0, "bad");
    if (this.second) this.paintEnd(u, this.second.flight, this.second.shift, "second");
    context.restore();
  }

  /** A thick line where a race was lost. */
  private paintEnd(u: uPlot, flight: Flight, shift: number, name: string): void {
    const end = ending(flight), ratio = devicePixelRatio || 1, { top, height } = u.bbox;
    if (end.kind !== "bad") return;
    const x = u.valToPos(end.t + shift, "x", true);
    u.ctx.fillStyle = color(name);
    u.ctx.fillRect(x - 2 * ratio, top, 2 * ratio, height);
    u.ctx.textAlign = "right";
    u.ctx.fillText("✕", x - 4 * ratio, top + 10 * ratio);
    u.ctx.textAlign = "left";
  }

  private move(time: number): void {
    this.stamp = time;
    const row = this.flight.row(time);
    for (const { chart, needle, readout, plot } of this.plots) {
      needle.style.transform = `translateX(${chart.valToPos(time, "x")}px)`;
      const lines = plot.lines.filter((line) => !line.at && !line.quiet), other = this.other(plot);
      const value = (line: Line, i: number) => (Number.isNaN(line.values[i]) || i >= line.values.length ? "–" : line.values[i].toFixed(2));
      const beside = other && this.second ? ` · second ${value(other, this.second.flight.row(time - this.second.shift))}` : "";
      if (lines.length)
        readout.textContent = lines.map((line) => value(line, row)).join(" · ") +
          (plot.error && lines[0].sigma ? ` (±${(3 * lines[0].sigma[row]).toFixed(2)})` : "") + `${beside} ${plot.unit}`;
    }
  }
}
