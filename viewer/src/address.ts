// SPDX-License-Identifier: Apache-2.0
// What was chosen stands behind the page's address, after #: it outlives a reload, and is part of a link.

export function chosen(name: string): string { return new URLSearchParams(location.hash.slice(1)).get(name) ?? ""; }

export function choose(name: string, value: string): void {
  const all = new URLSearchParams(location.hash.slice(1));
  if (value) all.set(name, value);
  else all.delete(name);
  const text = all.toString().replaceAll("%2C", ",");
  try {
    history.replaceState(null, "", text ? `#${text}` : location.pathname + location.search);
  } catch { /* a page inside another may not: the choice lasts as long as the page */ }
}
