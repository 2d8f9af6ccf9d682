// SPDX-License-Identifier: Apache-2.0
import type { Clock } from "./clock";
import { ending } from "./events";
import { Flight } from "./flight";
import { byId, element } from "./text";

const MOST_BYTES = 20_000_000;  // a page has 5 MB at most
const DATA = /<script type="application\/json" id="flight">([^<]*)<\/script>/;

/** Another flight in this one's scene and plots, both taking off at once. */
export interface Second {
  flight: Flight;
  /** Added to its times they are this flight's [s]. */
  shift: number;
  name: string;
}

/** The flight in a report.html, which is read as text and never run. @throws Error in words */
export function flightIn(html: string, file: string): Flight {
  const data = DATA.exec(html)?.[1];
  if (!data) throw new Error(`${file}: is no report.html of gatefly fly or replay`);
  try {
    const flight = new Flight(data);
    const sound = flight.t.length > 0 && flight.t.every((t, i) => Number.isFinite(t) && (i === 0 || t >= flight.t[i - 1]));
    if (!sound || typeof flight.verdict !== "string" || !Array.isArray(flight.passes) || !Array.isArray(flight.looks)) throw new Error();
    flight.phase(0);
    ending(flight);
    return flight;
  } catch {
    throw new Error(`${file}: its flight cannot be read`);
  }
}

const nameOf = ({ summary }: Flight) => (summary.kind === "replay" ? `replay of ${summary.flight}` : `${summary.track}, seed ${summary.seed}`);

/** The button that asks for a second flight's page. @param show  draws it, or with null this one alone again. */
export function startSecond(flight: Flight, clock: Clock, show: (second: Second | null) => void): void {
  const input = byId<HTMLInputElement>("second-file"), ask = byId("second"), said = byId("second-said");
  const tell = (...nodes: (Node | string)[]) => {
    said.replaceChildren(...nodes);
    said.hidden = nodes.length === 0;
  };
  const remove = () => {
    tell();
    show(null);
    clock.extend(flight.end);
    ask.focus();
  };
  ask.addEventListener("click", () => input.click());
  input.addEventListener("change", async () => {
    const file = input.files?.[0];
    input.value = "";  // the same file may be chosen again
    if (!file) return;
    try {
      if (file.size > MOST_BYTES) throw new Error(`${file.name}: is too large for a flight's page`);
      const other = flightIn(await file.text(), file.name);
      const second = { flight: other, shift: flight.takeOff - other.takeOff, name: nameOf(other) };
      const leave = element("button", "remove");
      leave.type = "button";
      leave.addEventListener("click", remove);
      const elsewhere = other.summary.track !== flight.summary.track ? " · on another track" : "";
      tell(element("b", "second flight"), ` ${second.name}: ${other.verdict}${elsewhere} · both from their take-off `, leave);
      show(second);
      clock.extend(Math.max(flight.end, other.end + second.shift));
    } catch (error) {
      tell(element("span", (error as Error).message, "bad"));
    }
  });
}
