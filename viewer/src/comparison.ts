// SPDX-License-Identifier: Apache-2.0
// Two campaigns beside each other, seed by seed: what `campaign --compare` writes, and src/simulator/gatefly/simulated_race/results/campaign_comparison.cpp pairs.
import { histogram } from "./histogram";
import { head } from "./tables";
import { byId, element } from "./text";

type Pair<T> = [T, T];
interface Spread { p25: number; p50: number; p75: number }
interface Seed {
  seed: number; finished: Pair<boolean>; gates: Pair<number>; time_s: Pair<number | null>; speed_mps: Pair<number | null>; cause: Pair<string>; why: Pair<string>;
}
export interface Comparison {
  first: string; second: string; pairs: number; unpaired: number; both_finished: number; neither_finished: number; only_first: number[]; only_second: number[];
  mcnemar_p: number; differences: string[]; second_minus_first: Record<"race_time_s" | "mean_speed_mps" | "gates_passed", Spread | null>;
  lost_by: Pair<{ cause: string; count: number }[]>; seeds: Seed[];
}

/** "0.031", "1.2e-05". */
export function probability(p: number): string {
  if (p === 0 || p >= 1e-3) return p.toFixed(3);
  return p.toExponential(1).replace(/e([+-])(\d)$/, "e$10$2");
}

function figures(told: Comparison): void {
  const figure = (name: string, value: string) => {
    const box = element("div");
    box.append(element("dt", name), element("dd", value));
    byId("figures").append(box);
  };
  figure("first", told.first);
  figure("second", told.second);
  const gain = (name: string, key: keyof Comparison["second_minus_first"], unit: string, digits: number) => {
    const q = told.second_minus_first[key], at = (value: number) => (value < 0 ? "" : "+") + value.toFixed(digits);
    if (q) figure(`${name}, second − first`, `${at(q.p50)}${unit} median, ${at(q.p25)} to ${at(q.p75)}${unit} (quartiles)`);
  };
  gain("race time where both finished", "race_time_s", " s", 2);
  gain("mean speed where both finished", "mean_speed_mps", " m/s", 3);
  gain("gates passed", "gates_passed", "", 1);
  if (told.unpaired) figure("left out", `${told.unpaired} runs of one alone`);
}

/** A panel of its own before the flights. */
function panel(title: string): HTMLTableElement {
  const section = element("section", "", "panel"), wide = element("div", "", "wide"), table = element("table");
  wide.append(table);
  section.append(element("h2", title), wide);
  section.setAttribute("aria-label", title.toLowerCase());
  byId("flights").before(section);
  return table;
}

function row(body: HTMLElement, cells: string[], bad: number[] = []): void {
  const line = element("tr");
  line.append(...cells.map((text, i) => element("td", text, bad.includes(i) ? "bad" : "")));
  body.append(line);
}

function showTable(told: Comparison): void {
  const body = head(panel("Who finished"), ["", "second finished", "second did not"]);
  row(body, ["first finished", `${told.both_finished}`, `${told.only_first.length}`]);
  row(body, ["first did not", `${told.only_second.length}`, `${told.neither_finished}`]);
}

function showLostBy(told: Comparison): void {
  const [a, b] = told.lost_by, counts = (list: typeof a, cause: string) => `${list.find((one) => one.cause === cause)?.count ?? 0}`;
  const causes = [...new Set([...a, ...b].map((one) => one.cause))];
  if (!causes.length) return;
  const body = head(panel("What races were lost by"), ["", "first", "second"]);
  for (const cause of causes) row(body, [cause, counts(a, cause), counts(b, cause)]);
}

function showDifferences(told: Comparison): void {
  const body = head(panel("What they differ in"), ["key: first | second"]);
  for (const difference of told.differences.length ? told.differences : ["nothing but chance: the same arguments"]) row(body, [difference]);
}

function showSeeds(told: Comparison): void {
  const differ = told.seeds.filter(({ finished }) => finished[0] !== finished[1]);
  if (!differ.length) return;
  const body = head(panel("Seeds that one of them finished"), ["seed", "first", "second"]);
  const words = (seed: Seed, i: 0 | 1) => (seed.finished[i] ? `finished in ${seed.time_s[i]!.toFixed(1)} s` : `${seed.cause[i]}, ${seed.gates[i]} ${seed.gates[i] === 1 ? "gate" : "gates"}${seed.why[i] && seed.why[i] !== seed.cause[i] ? `, lost by ${seed.why[i]}` : ""}`);
  for (const seed of differ) row(body, [`${seed.seed}`, words(seed, 0), words(seed, 1)], ([0, 1] as const).filter((i) => !seed.finished[i]).map((i) => i + 1));
}

function showGains(told: Comparison): void {
  const gain = (of: (seed: Seed) => Pair<number | null>) =>
    told.seeds.map(of).filter((pair): pair is Pair<number> => pair[0] !== null && pair[1] !== null).map(([a, b]) => b - a);
  const add = (title: string, unit: string, values: number[]) => {
    if (values.length > 1) byId("histograms").append(histogram(title, unit, values));
  };
  add("race time, second − first, of those that both finished", "s", gain((seed) => seed.time_s));
  add("mean speed, second − first, of those that both finished", "m/s", gain((seed) => seed.speed_mps));
  add("gates passed, second − first, all seeds", "gates", gain((seed) => seed.gates));
}

export function showComparison(title: string, told: Comparison): void {
  document.title = `${title} · gatefly`;
  byId("title").textContent = title;
  byId("verdict").textContent = `${told.both_finished + told.only_first.length} | ${told.both_finished + told.only_second.length} of ${told.pairs} races finished`;
  byId("rate").append(element("p", `${told.only_first.length} seeds were finished by the first alone, ${told.only_second.length} by the second alone: ` +
    `two campaigns that finish equally often would differ so much with p = ${probability(told.mcnemar_p)} (McNemar, exact)`));
  figures(told);
  showGains(told);
  showTable(told);
  showLostBy(told);
  showDifferences(told);
  showSeeds(told);
  byId("flights").hidden = true;
}
