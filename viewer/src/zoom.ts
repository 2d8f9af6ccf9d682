// SPDX-License-Identifier: Apache-2.0
import type uPlot from "uplot";
import type { Clock } from "./clock";
import type { Range } from "./range";
import { byId, element } from "./text";

const CLICK = 5;     // a hand that shakes so much has clicked [px]
const CLOSER = 0.5;  // a key or button shows half as long

/** A click on a plot goes to that time, a drag shows what was dragged over, a double click all of the flight. */
export function startZoom(chart: uPlot, clock: Clock, range: Range): void {
  const over = chart.over, chosen = element("div", "", "chosen");
  chosen.hidden = true;
  over.append(chosen);
  let from: number | null = null;
  const place = (event: PointerEvent) => {
    const box = over.getBoundingClientRect();
    return Math.min(box.width, Math.max(0, event.clientX - box.left));
  };
  over.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    from = place(event);
    over.setPointerCapture(event.pointerId);
  });
  over.addEventListener("pointermove", (event) => {
    if (from === null) return;
    const to = place(event);
    chosen.hidden = Math.abs(to - from) < CLICK;
    chosen.style.left = `${Math.min(from, to)}px`;
    chosen.style.width = `${Math.abs(to - from)}px`;
  });
  over.addEventListener("pointerup", (event) => {
    if (from === null) return;
    const [a, b] = [from, place(event)].sort((one, other) => one - other), drag = b - a >= CLICK;
    from = null;
    chosen.hidden = true;
    const [first, last] = [a, b].map((x) => chart.posToVal(x, "x"));  // of what is shown now
    clock.play(false);
    if (drag) range.show(first, last);
    clock.seek(first);
  });
  over.addEventListener("pointercancel", () => {  // the finger scrolls the page
    from = null;
    chosen.hidden = true;
  });
  over.addEventListener("dblclick", () => range.whole());
}

/** The same by buttons and keys. */
export function startZoomKeys(range: Range): void {
  const closer = () => range.zoom(CLOSER), wider = () => range.zoom(1 / CLOSER), whole = () => range.whole();
  const buttons: [string, () => void][] = [["closer", closer], ["wider", wider], ["whole", whole]];
  for (const [id, act] of buttons) byId(`zoom-${id}`).addEventListener("click", act);
  document.addEventListener("keydown", (event) => {
    const on = event.target as HTMLElement;
    if (event.ctrlKey || event.altKey || event.metaKey || on.tagName === "SELECT") return;
    if (event.key === "+" || event.key === "=") closer();
    else if (event.key === "-") wider();
    else if (event.key === "0") whole();
  });
  const tell = () => {
    byId("zoom-shown").textContent = range.zoomed ? `${range.from.toFixed(1)} to ${range.to.toFixed(1)} s` : "whole flight";
    (byId("zoom-wider") as HTMLButtonElement).disabled = (byId("zoom-whole") as HTMLButtonElement).disabled = !range.zoomed;
  };
  range.onChange(tell);
  tell();
}
