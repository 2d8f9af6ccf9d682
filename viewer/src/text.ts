// SPDX-License-Identifier: Apache-2.0

export const seconds = (t: number): string => `${t.toFixed(1)} s`;
export const degrees = (radians: number): number => (radians * 180) / Math.PI;

/** An element with text in it, never markup. */
export function element<K extends keyof HTMLElementTagNameMap>(tag: K, text = "", className = ""): HTMLElementTagNameMap[K] {
  const node = document.createElement(tag);
  node.textContent = text;
  if (className) node.className = className;
  return node;
}

export function byId<T extends HTMLElement = HTMLElement>(id: string): T {
  const node = document.getElementById(id);
  if (!node) throw new Error(`no element ${id}`);
  return node as T;
}
