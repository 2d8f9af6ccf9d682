// SPDX-License-Identifier: Apache-2.0
import type { Clock } from "./clock";
import type { Flight, Why } from "./flight";
import { byId, element, seconds } from "./text";

const BEFORE = 3;  // what led to it [s]
const MEANING: Record<Why["parts"][number]["cause"], string> = {
  estimate: "not where it believed to be, by IMU, drag and wind",
  guidance: "not where it wanted to be",
  map: "the gate is not where the map has it",
  detection: "not where it believed to be, by gates measured wrongly",
};
const cm = (value: number) => `${Math.abs(value).toFixed(0)} cm`;

/** What a cause put into the miss [cm]; negative: against it. */
const share = ({ share_cm, lateral_cm, vertical_cm }: Why["parts"][number]) => (typeof share_cm === "number" ? share_cm : Math.hypot(lateral_cm, vertical_cm));

function bar(part: Why["parts"][number], longest: number): HTMLElement {
  const size = share(part), row = element("li");
  const name = element("span", part.cause, "cause"), track = element("span", "", "amount"), fill = element("i");
  fill.style.width = `${(100 * Math.abs(size)) / Math.max(longest, 1)}%`;
  track.append(fill);
  if (size === longest && size > 0) row.className = "most";
  if (size < -0.5) row.className = "against";
  const sides = [
    ...(Math.abs(part.lateral_cm) >= 0.5 ? [`${cm(part.lateral_cm)} ${part.lateral_cm > 0 ? "right" : "left"}`] : []),
    ...(Math.abs(part.vertical_cm) >= 0.5 ? [`${cm(part.vertical_cm)} ${part.vertical_cm > 0 ? "low" : "high"}`] : []),
  ];
  row.append(name, track, element("b", size < -0.5 ? `−${cm(size)}` : cm(size)), element("span", sides.join(", "), "sides"),
             element("span", (MEANING[part.cause] ?? "") + (size < -0.5 ? " (and made up for some of it)" : ""), "meaning"));
  return row;
}

/** Why the race was lost, on top of everything. @param show  brings a moment before the eyes. */
export function showHeadline(flight: Flight, clock: Clock, show: () => void): void {
  const why = flight.why, box = byId("why");
  if (!why || typeof why.line !== "string") return;
  box.hidden = false;
  box.append(element("p", why.line, "line"));
  const parts = Array.isArray(why.parts) ? why.parts : [];
  if (parts.length) {
    const longest = Math.max(...parts.map((part) => Math.abs(share(part)))), list = element("ul");
    list.append(...parts.map((part) => bar(part, longest)));
    box.append(list);
  }
  const facts = [
    ...(typeof why.since_fix_s === "number" ? [`last fix ${seconds(why.since_fix_s)} before`] : []),
    ...(typeof why.wind_mps === "number" ? [`wind ${why.wind_mps.toFixed(2)} m/s`] : []),
    ...(why.object ? [`touched: ${why.object}`] : []),
  ];
  const foot = element("p", facts.join(" · "), "facts");
  const button = (text: string, id: string, act: () => void) => {
    const node = element("button", text);
    node.type = "button";
    node.id = id;
    node.addEventListener("click", () => { show(); act(); });
    foot.append(" ", node);
  };
  button(`show the moment, ${seconds(why.t_s)}`, "to-contact", () => { clock.play(false); clock.seek(why.t_s); });
  button(`play the ${BEFORE} s before`, "play-contact", () => { clock.seek(why.t_s - BEFORE); clock.play(true); });
  box.append(foot);
}
