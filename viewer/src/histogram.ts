// SPDX-License-Identifier: Apache-2.0
import { element } from "./text";

const NS = "http://www.w3.org/2000/svg", WIDTH = 400, HEIGHT = 130, FOOT = 20;

function shape(tag: string, attributes: Record<string, string | number>, text = ""): SVGElement {
  const node = document.createElementNS(NS, tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, String(value));
  node.textContent = text;
  return node;
}

function quantile(sorted: number[], q: number): number {
  const at = q * (sorted.length - 1), low = Math.floor(at), high = Math.ceil(at);
  return sorted[low] + (at - low) * (sorted[high] - sorted[low]);
}

/** 1, 2 or 5 times a power of ten, not below `width`. */
function round(width: number): number {
  const power = 10 ** Math.floor(Math.log10(width));
  return power * ([1, 2, 5, 10].find((step) => step * power >= width) ?? 10);
}

export interface Bins { low: number; step: number; counts: number[]; integers: boolean }

/** Counts of equal bins. Whole numbers lie in the middle of theirs: a bin of two holds 8 and 9, none holds half of one.
 *  @param top  the values are whole numbers from 0 to this. */
export function binned(values: number[], top?: number): Bins {
  const first = values.reduce((a, b) => Math.min(a, b)), last = values.reduce((a, b) => Math.max(a, b)), integers = values.every(Number.isInteger);
  const from = top !== undefined ? 0 : first, to = top ?? last;
  const step = integers ? round(Math.max((to - from + 1) / 40, 1)) : round(Math.max((to - from) / 24, 1e-3));
  const begin = Math.floor(from / step + 1e-9) * step, low = begin - (integers ? 0.5 : 0);
  const counts = new Array<number>(Math.floor((to - begin) / step + 1e-9) + 1).fill(0);
  for (const value of values) ++counts[Math.floor((value - low) / step + 1e-9)];
  return { low, step, counts, integers };
}

/** What lies in bin i, in words: "8", "8 to 9", "1.0 to 1.2". */
export function named({ low, step, integers }: Bins, i: number, text: (value: number) => string): string {
  const from = low + i * step;
  if (!integers) return `${text(from)} to ${text(from + step)}`;
  return step === 1 ? text(from + 0.5) : `${text(from + 0.5)} to ${text(from + step - 0.5)}`;
}

/** @param top  the values are whole numbers from 0 to this. */
export function histogram(title: string, unit: string, values: number[], top?: number): HTMLElement {
  const sorted = [...values].sort((a, b) => a - b), first = sorted[0], last = sorted[sorted.length - 1];
  const bins = binned(values, top), { low, step, counts, integers } = bins;
  const most = counts.reduce((a, b) => Math.max(a, b), 1), wide = WIDTH / counts.length, digits = integers ? 0 : Math.max(0, Math.min(3, -Math.floor(Math.log10(step) + 1e-9)));
  const x = (value: number) => ((value - low) / (counts.length * step)) * WIDTH, text = (value: number) => value.toFixed(integers && !Number.isInteger(value) ? 1 : digits);

  const box = element("div", "", "panel histogram"), [p10, p50, p90] = [0.1, 0.5, 0.9].map((q) => quantile(sorted, q));
  const told = `median ${text(p50)} ${unit}, 10 to 90 %: ${text(p10)} to ${text(p90)}, in all ${text(first)} to ${text(last)}`;
  const svg = shape("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", "aria-label": `${title}: ${told}` });
  counts.forEach((count, i) => {
    if (!count) return;
    const height = Math.max(1.5, (count / most) * (HEIGHT - FOOT - 16));
    const bar = shape("rect", { x: i * wide + 0.5, y: HEIGHT - FOOT - height, width: Math.max(1, wide - 1), height, class: "bar-of" });
    bar.append(shape("title", {}, `${named(bins, i, text)} ${unit}: ${count}`));
    svg.append(bar);
  });
  const half = integers ? 0.5 : 0, end = top ?? low + counts.length * step - half;
  svg.append(shape("line", { x1: 0, x2: WIDTH, y1: HEIGHT - FOOT, y2: HEIGHT - FOOT, class: "foot" }),
    shape("line", { x1: x(p50), x2: x(p50), y1: 10, y2: HEIGHT - FOOT, class: "median" }),
    shape("text", { x: 0, y: HEIGHT - 5 }, text(low + half)), shape("text", { x: x(end), y: HEIGHT - 5, "text-anchor": "end" }, text(end)),
    shape("text", { x: WIDTH, y: 9, "text-anchor": "end" }, `highest: ${most}`));
  box.append(element("h2", `${title} [${unit}]`), svg, element("p", told));
  return box;
}
