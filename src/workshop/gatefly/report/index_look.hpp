// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace gatefly::report {

/// The index's colours and type are those of viewer/src/style.css.
inline constexpr const char* kIndexStyle = R"css(
:root { color-scheme: light dark;
  --page: #f4f6f8; --panel: #fff; --well: #eef1f4; --ink: #17202b; --muted: #525d6b; --rule: #d5dbe1; --focus: #0b5fce;
  --gate: #b45309; --good: #15803d; --bad: #b91c1c; }
@media (prefers-color-scheme: dark) { :root {
  --page: #10141a; --panel: #171d26; --well: #0c1015; --ink: #e6edf3; --muted: #9aa7b5; --rule: #2b3542; --focus: #7cc4ff;
  --gate: #ff8c1a; --good: #7ee787; --bad: #ff8080; } }
* { box-sizing: border-box; }
[hidden] { display: none !important; }
body { margin: 0 auto; max-width: 1500px; padding: 12px 16px; background: var(--page); color: var(--ink); font: 15px/1.45 system-ui, sans-serif; font-variant-numeric: tabular-nums; }
.bar { display: flex; gap: 12px; align-items: baseline; } .brand { color: var(--gate); font-weight: 700; } .bar span:last-child { color: var(--muted); overflow-wrap: anywhere; }
h1 { margin: 6px 0 12px; font-size: clamp(19px, 2.1vw, 28px); line-height: 1.2; font-weight: 650; }
:focus-visible { outline: 2px solid var(--focus); outline-offset: 2px; }
form { display: flex; flex-wrap: wrap; gap: 8px 12px; align-items: center; margin-bottom: 12px; }
input, select { font: inherit; color: inherit; background: var(--panel); border: 1px solid var(--rule); border-radius: 6px; padding: 5px 10px; min-width: 0; }
input { flex: 1 1 200px; max-width: 360px; }
#shown { color: var(--muted); font-size: 13px; }
.panel { background: var(--panel); border: 1px solid var(--rule); border-radius: 10px; padding: 6px 12px; overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-size: 14px; white-space: nowrap; }
th { text-align: left; color: var(--muted); font-weight: 500; font-size: 12px; position: sticky; top: 0; background: var(--panel); }
th, td { padding: 6px 14px 6px 4px; border-bottom: 1px solid var(--rule); } tbody tr:last-child td { border-bottom: 0; }
tbody tr:hover { background: var(--well); }
th button { all: unset; cursor: pointer; padding: 4px 2px; } th button:focus-visible { outline: 2px solid var(--focus); }
th[aria-sort] { color: var(--ink); } th[aria-sort=ascending] button::after { content: " ↑"; } th[aria-sort=descending] button::after { content: " ↓"; }
td.number, th.number { text-align: right; } td a { color: inherit; } td:first-child a { font-weight: 600; }
.good { color: var(--good); } .bad { color: var(--bad); } .muted { color: var(--muted); }
td.what { white-space: normal; min-width: 200px; overflow-wrap: anywhere; } td:first-child { white-space: normal; min-width: 110px; overflow-wrap: anywhere; }
@media (max-width: 700px) {  /* a card a flight */
  thead { display: none; } table, tbody { display: block; } .panel { padding: 0 12px; }
  tbody tr { display: flex; flex-wrap: wrap; gap: 0 14px; padding: 8px 0; border-bottom: 1px solid var(--rule); } tbody tr:last-child { border: 0; }
  td, tbody tr:last-child td { border: 0; padding: 1px 0; } td:empty { display: none; }
  td:first-child, td.what { flex: 1 0 100%; } td.number { text-align: left; } td[data-label]::before { content: attr(data-label) " "; color: var(--muted); }
}
)css";

/// Sorts and filters the rows that are there: `data-sort` of a cell is its value.
inline constexpr const char* kIndexScript = R"js(
"use strict";
const table = document.querySelector("table"), body = table.tBodies[0], rows = [...body.rows];
const words = document.getElementById("words"), kind = document.getElementById("kind"), shown = document.getElementById("shown");
const orders = document.getElementById("order"), headers = [...table.tHead.rows[0].cells];

function filter() {
  const wanted = words.value.toLowerCase().split(/\s+/).filter(Boolean);
  let count = 0;
  for (const row of rows) {
    const text = row.textContent.toLowerCase();
    const fits = (!kind.value || row.dataset.kind.split(" ").includes(kind.value)) && wanted.every((word) => text.includes(word));
    row.hidden = !fits;
    count += fits;
  }
  shown.textContent = count < rows.length ? `${count} of ${rows.length}` : "";
}

const value = (row, column) => row.cells[column].dataset.sort ?? row.cells[column].textContent;
function compare(a, b, numbers) {
  if (a === "" || b === "") return (a === "") - (b === "");  // what is not known comes last, whichever way
  return numbers ? a - b : a.localeCompare(b, "en", { numeric: true });
}
function sort(column, down) {
  const numbers = headers[column].classList.contains("number") || headers[column].dataset.numbers !== undefined;
  headers.forEach((header, i) => i === column ? header.setAttribute("aria-sort", down ? "descending" : "ascending") : header.removeAttribute("aria-sort"));
  orders.value = `${column} ${down ? 1 : 0}`;
  const sorted = rows.map((row) => [value(row, column), row]).sort(([a], [b]) => (down && a !== "" && b !== "" ? -1 : 1) * compare(a, b, numbers));
  body.append(...sorted.map(([, row]) => row));
}

headers.forEach((header, column) => {
  const button = document.createElement("button"), name = header.textContent, first = header.dataset.down !== undefined;
  button.type = "button";
  button.textContent = name;
  header.replaceChildren(button);
  button.addEventListener("click", () => sort(column, header.hasAttribute("aria-sort") ? header.getAttribute("aria-sort") === "ascending" : first));
  for (const down of first ? [true, false] : [false, true]) {
    const said = header.dataset.numbers === undefined ? (down ? "high to low" : "low to high") : down ? "newest first" : "oldest first";
    const alphabetic = !header.classList.contains("number") && header.dataset.numbers === undefined;
    orders.append(new Option(`${name}, ${alphabetic ? (down ? "Z to A" : "A to Z") : said}`, `${column} ${down ? 1 : 0}`));
  }
});
orders.addEventListener("change", () => { const [column, down] = orders.value.split(" ").map(Number); sort(column, down === 1); });
words.addEventListener("input", filter);
kind.addEventListener("change", filter);
for (const time of document.querySelectorAll("time")) {
  const date = new Date(time.dateTime), two = (number) => String(number).padStart(2, "0");
  time.textContent = `${date.getFullYear()}-${two(date.getMonth() + 1)}-${two(date.getDate())} ${two(date.getHours())}:${two(date.getMinutes())}`;
}
document.querySelector("form").hidden = false;
sort(headers.findIndex((header) => header.dataset.numbers !== undefined), true);  // the newest first
filter();  // a browser remembers what was typed
window.__report = { rows: rows.length };  // ready, for who waits for it
)js";

}  // namespace gatefly::report
