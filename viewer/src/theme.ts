// SPDX-License-Identifier: Apache-2.0

const listeners: (() => void)[] = [];

export function dark(): boolean {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
}

/** A colour of style.css. */
export function color(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

/** For what is drawn by hand and not by style sheets. */
export function onTheme(listener: () => void): void { listeners.push(listener); }

export function startTheme(button: HTMLElement): void {
  const tell = () => listeners.forEach((listener) => listener());
  button.addEventListener("click", () => {
    document.documentElement.dataset.theme = dark() ? "light" : "dark";
    tell();
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", tell);
}
