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

/** @param whole  the values are whole numbers from 0 to this. */
export function histogram(title: string, unit: string, values: number[], whole?: number): HTMLElement {
  const sorted = [...values].sort((a, b) => a - b), first = sorted[0], last = sorted[sorted.length - 1];
  const step = whole !== undefined ? Math.max(1, round(whole / 40)) : round(Math.max((last - first) / 24, 1e-3));
  const low = whole !== undefined ? -0.5 : Math.floor(first / step) * step, bins = Math.max(1, Math.ceil(((whole !== undefined ? whole + 0.5 : last) - low) / step + 1e-9));
  const counts = new Array<number>(bins).fill(0);
  for (const value of values) ++counts[Math.min(bins - 1, Math.floor((value - low) / step + 1e-9))];
  const most = counts.reduce((a, b) => Math.max(a, b), 1), wide = WIDTH / bins, digits = Math.max(0, Math.min(3, -Math.floor(Math.log10(step))));
  const x = (value: number) => ((value - low) / (bins * step)) * WIDTH, text = (value: number) => value.toFixed(whole !== undefined ? 0 : digits);

  const box = element("div", "", "panel histogram"), [p10, p50, p90] = [0.1, 0.5, 0.9].map((q) => quantile(sorted, q));
  const told = `median ${text(p50)} ${unit}, 10 to 90 %: ${text(p10)} to ${text(p90)}, in all ${text(first)} to ${text(last)}`;
  const svg = shape("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", "aria-label": `${title}: ${told}` });
  counts.forEach((count, i) => {
    if (!count) return;
    const height = Math.max(1.5, (count / most) * (HEIGHT - FOOT - 16)), from = low + i * step;
    const bar = shape("rect", { x: i * wide + 0.5, y: HEIGHT - FOOT - height, width: Math.max(1, wide - 1), height, class: "bar-of" });
    bar.append(shape("title", {}, `${whole !== undefined ? text(Math.ceil(from)) : `${text(from)} to ${text(from + step)}`} ${unit}: ${count}`));
    svg.append(bar);
  });
  svg.append(shape("line", { x1: 0, x2: WIDTH, y1: HEIGHT - FOOT, y2: HEIGHT - FOOT, class: "foot" }),
    shape("line", { x1: x(p50), x2: x(p50), y1: 10, y2: HEIGHT - FOOT, class: "median" }),
    shape("text", { x: 0, y: HEIGHT - 5 }, text(whole !== undefined ? 0 : low)), shape("text", { x: WIDTH, y: HEIGHT - 5, "text-anchor": "end" }, text(whole ?? low + bins * step)),
    shape("text", { x: WIDTH, y: 9, "text-anchor": "end" }, `highest: ${most}`));
  box.append(element("h2", `${title} [${unit}]`), svg, element("p", told));
  return box;
}
