// SPDX-License-Identifier: Apache-2.0
// The page of a campaign or of a folder of flights: src/workshop/gatefly/report/list_page.cpp writes what is read here.
import "./style.css";
import { type Comparison, showComparison } from "./comparison";
import { binned, histogram, named } from "./histogram";
import { head } from "./tables";
import { byId, element } from "./text";
import { startTheme } from "./theme";

interface Row {
  name: string; page?: string; fly?: string; note?: string; kind?: string; seed?: number; finished?: boolean; gates?: number; gates_total?: number;
  time_s?: number; speed_mps?: number; stop?: string; why?: string; rmse_m?: number; lost?: string; lost_by?: string;
}
interface Cause { cause: string; count: number; seeds: number[] }
interface Result {
  runs: number; finished: number; completion_rate: number; completion_wilson95: [number, number]; gates_passed: number; gates_total: number;
  consistency?: { nees: { samples: number; mean_per_dof: number; inside_95: number } };
  causes: Cause[]; lost_by?: Cause[];
}
interface List {
  title: string; flights: Row[]; one_in: number; offsets_cm: { across: number[]; down: number[] }; result: Result | null;
  arguments?: { version?: string }; comparison?: Comparison;
}

const SHOWN = 200;  // rows; more are behind a button
const ENOUGH = 8;   // flights of a folder, for distributions
const percent = (part: number) => `${(100 * part).toFixed(1)} %`;
const css = (part: number) => `${(100 * part).toFixed(2)}%`;

function outcome(row: Row): string {
  if (row.finished === false && row.lost) return row.lost;
  if (row.finished === undefined) return row.kind === "replay" ? "replay" : row.note ?? "not readable";
  if (row.finished) return "finished";
  return (row.stop === "crash" ? "crashed into " : row.stop === "abort" ? "given up: " : "") + (row.why || row.stop || "not finished");
}

/** A bar from 0 to 100 % with the 95 % interval on it. */
function showRate(result: Result): void {
  const [low, high] = result.completion_wilson95;
  const bar = element("div", "", "rate"), interval = element("i", "", "interval"), value = element("i", "", "value");
  value.style.width = css(result.completion_rate);
  interval.style.left = css(low);
  interval.style.width = css(high - low);
  bar.append(value, interval);
  bar.setAttribute("role", "img");
  bar.setAttribute("aria-label", `${percent(result.completion_rate)} finished, 95 % interval ${percent(low)} to ${percent(high)}`);
  byId("rate").append(bar, element("p", `${percent(result.completion_rate)} finished; the true rate lies between ${percent(low)} and ${percent(high)} (95 % interval, Wilson)`));
}

function showHead(list: List): void {
  const { result, flights } = list;
  document.title = `${list.title} · gatefly`;
  byId("title").textContent = list.title;
  byId("version").textContent = list.arguments?.version ? `flown by gatefly ${list.arguments.version}` : "";
  const flown = flights.filter((row) => row.finished !== undefined), done = flown.filter((row) => row.finished);
  byId("verdict").textContent = result ? `${result.finished} of ${result.runs} races finished`
    : flown.length ? `${flights.length} flights, ${done.length} of ${flown.length} races finished` : `${flights.length} flights`;
  if (!result) return;
  showRate(result);
  const figure = (name: string, value: string) => {
    const box = element("div");
    box.append(element("dt", name), element("dd", value));
    byId("figures").append(box);
  };
  figure("gates passed", `${result.gates_passed} of ${result.gates_total}`);
  const nees = result.consistency?.nees;
  if (nees && nees.samples > 0) figure("NEES a degree of freedom (1 is as expected)", `${nees.mean_per_dof.toFixed(2)}, ${percent(nees.inside_95)} inside 95 %`);
  if (list.one_in > 1) figure("shown here", `one run in ${list.one_in}`);
}

function showHistograms(list: List): void {
  if (!list.result && list.flights.filter((row) => row.finished).length < ENOUGH) return;
  const done = list.flights.filter((row) => row.finished), numbers = (values: (number | undefined)[]) => values.filter((value): value is number => value !== undefined);
  const host = byId("histograms"), gates = Math.max(1, ...numbers(list.flights.map((row) => row.gates_total)));
  const add = (title: string, unit: string, values: number[], whole?: number) => {
    if (values.length > 1) host.append(histogram(title, unit, values, whole));
  };
  add("race time, of those that finished", "s", numbers(done.map((row) => row.time_s)));
  add("mean speed, of those that finished", "m/s", numbers(done.map((row) => row.speed_mps)));
  add("gates passed, all races", "gates", numbers(list.flights.map((row) => row.gates)), gates);
  add("position error of a race, RMS", "m", numbers(list.flights.map((row) => row.rmse_m)));
  add("where gates are passed: right of the middle", "cm", list.offsets_cm.across);
  add("where gates are passed: above the middle", "cm", list.offsets_cm.down.map((down) => -down));
}

function command(row: Row): HTMLElement {
  const box = element("span", "", "command"), code = element("code", row.fly!), copy = element("button", "copy", "chip");
  copy.type = "button";
  copy.setAttribute("aria-label", `copy the command that flies ${row.name}`);
  copy.addEventListener("click", () => {
    navigator.clipboard?.writeText(row.fly!).then(() => (copy.textContent = "copied"), () => getSelection()?.selectAllChildren(code));
  });
  box.append(code, copy);
  return box;
}

const EXPLAINED: Record<string, string> = {
  estimate: "the estimate: what IMU, drag and wind put in between fixes", guidance: "guidance: it knew that it was off",
  map: "the map: the gate stands elsewhere", detection: "detection: fixes that were wrong, or none where a gate was in view",
  "in the way": "something that is on no map stood in the way", timeout: "out of time", "given up": "given up: a sensor, the motors",
};

function showCauses(list: List): void {
  const { result } = list;
  if (!result?.causes.length) return;
  byId("causes").hidden = false;
  const bySeed = new Map(list.flights.map((row) => [row.seed, row]));
  const table = (host: HTMLElement, what: string, causes: Cause[], explained: Record<string, string> = {}) => {
    const body = head(host, [what, "races", "flights, and the command that flies each again"]);
    for (const { cause, count, seeds } of causes) {
      const row = element("tr"), cell = element("td"), details = element("details");
      details.append(element("summary", seeds.slice(0, 8).join(", ") + (seeds.length > 8 ? ", …" : "")));
      for (const seed of seeds.slice(0, SHOWN)) {
        const flight = bySeed.get(seed), line = element("div", `seed ${seed}: `, "line");
        if (flight?.page) line.append(link(flight), " ");
        if (flight?.fly) line.append(command(flight));
        details.append(line);
      }
      cell.append(details);
      row.append(element("td", explained[cause] ?? cause), element("td", `${count}, ${percent(count / result.runs)}`), cell);
      body.append(row);
    }
  };
  if (result.lost_by?.length) table(byId("lost_by"), "most of the miss", result.lost_by, EXPLAINED);
  else byId("touched").closest("details")!.open = true;
  table(byId("touched"), "how it ended", result.causes);
}

function link(row: Row): HTMLAnchorElement {
  const anchor = element("a", row.name);
  anchor.href = row.page!.split("/").map(encodeURIComponent).join("/");
  return anchor;
}

function showFlights(list: List): void {
  const body = head(byId("flights").querySelector("table")!, ["flight", "result", "gates", "time", "speed", "error", "page"]);
  const fixed = (value: number | undefined, digits: number, unit: string) => (value === undefined ? "–" : `${value.toFixed(digits)} ${unit}`);
  const add = (rows: Row[]) => {
    for (const row of rows) {
      const line = element("tr"), name = element("td"), page = element("td");
      if (row.page) name.append(link(row));
      else name.textContent = row.name;
      if (row.page) page.textContent = row.note ?? "report.html";
      else if (row.fly) page.append(command(row));
      else page.textContent = row.note ?? "–";
      const result = element("td", outcome(row), row.finished === false ? "bad" : "");
      line.append(name, result, element("td", row.gates === undefined ? "–" : `${row.gates} of ${row.gates_total}`), element("td", row.finished ? fixed(row.time_s, 1, "s") : "–"),
        element("td", row.finished ? fixed(row.speed_mps, 2, "m/s") : "–"), element("td", fixed(row.rmse_m, 2, "m")), page);
      body.append(line);
    }
  };
  // Of a campaign those come first that did not finish.
  const rank = (row: Row) => (list.result && row.finished === false ? 0 : 1), ranked = [...list.flights].sort((a, b) => rank(a) - rank(b));
  const more = byId<HTMLButtonElement>("more"), left = ranked.slice(SHOWN);
  add(ranked.slice(0, SHOWN));
  more.hidden = left.length === 0;
  more.textContent = `${left.length} more`;
  more.addEventListener("click", () => { add(left); more.hidden = true; });
}

const list: List = JSON.parse(byId("list").textContent!);
startTheme(byId("theme"));
if (list.comparison) {
  showComparison(list.title, list.comparison);
} else {
  showHead(list);
  showHistograms(list);
  showCauses(list);
  showFlights(list);
}
Object.assign(window, { __report: { list, binned, named } });  // for tests
