// SPDX-License-Identifier: Apache-2.0
import { choose, chosen } from "./address";
import type { Plot } from "./plot_list";
import { byId, element } from "./text";

/** Which plots are shown: a box to tick for each, remembered behind the page's address. */
export class PlotChoice {
  private readonly hidden = new Set(chosen("hide").split(","));
  private readonly summary = byId("plots-shown").querySelector("summary")!;
  private readonly boxes = new Map<string, { tick: HTMLInputElement; box: HTMLElement }>();

  constructor(private readonly all: Plot[]) {}

  /** Takes over a plot's box. @return the button that hides it */
  hider(plot: Plot, box: HTMLElement): HTMLButtonElement {
    const label = element("label"), tick = element("input"), button = element("button", "×", "hide");
    tick.type = "checkbox";
    tick.addEventListener("change", () => this.set(plot.id, tick.checked));
    label.append(tick, ` ${plot.title}`);
    byId("plots-shown").append(label);
    button.type = "button";
    button.setAttribute("aria-label", `hide: ${plot.title}`);
    button.addEventListener("click", () => {
      this.set(plot.id, false);
      this.summary.focus();
    });
    this.boxes.set(plot.id, { tick, box });
    this.set(plot.id, !this.hidden.has(plot.id));
    return button;
  }

  private set(id: string, shown: boolean): void {
    const { tick, box } = this.boxes.get(id)!;
    tick.checked = shown;
    box.hidden = !shown;
    if (shown) this.hidden.delete(id);
    else this.hidden.add(id);
    const known = this.all.filter((plot) => this.hidden.has(plot.id));
    choose("hide", known.map((plot) => plot.id).join(","));
    this.summary.textContent = `plots shown: ${this.all.length - known.length} of ${this.all.length}`;
  }
}
