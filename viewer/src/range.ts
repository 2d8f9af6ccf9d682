// SPDX-License-Identifier: Apache-2.0
import { choose, chosen } from "./address";
import type { Clock } from "./clock";

const SHORTEST = 0.2;  // [s]

/** The stretch of time that every plot shows: all of it, or what was zoomed to. */
export class Range {
  from = 0;
  to: number;
  private listeners: (() => void)[] = [];

  constructor(private readonly clock: Clock) {
    this.to = clock.end;
    const [from, to] = chosen("zoom").split(",").map(Number);
    if (to > from) [this.from, this.to] = this.inside(from, to);
    clock.onTime((time) => this.follow(time));
    clock.onEnd(() => this.whole());
  }

  onChange(listener: () => void): void { this.listeners.push(listener); }
  get zoomed(): boolean { return this.from > 0 || this.to < this.clock.end; }

  show(from: number, to: number): void {
    [this.from, this.to] = this.inside(from, to);
    choose("zoom", this.zoomed ? `${this.from.toFixed(2)},${this.to.toFixed(2)}` : "");
    for (const listener of this.listeners) listener();
  }
  whole(): void { this.show(0, this.clock.end); }

  /** Closer (factor < 1) or wider around the cursor, which keeps its place. */
  zoom(factor: number): void {
    const at = Math.min(this.to, Math.max(this.from, this.clock.time));
    this.show(at - factor * (at - this.from), at + factor * (this.to - at));
  }

  private inside(from: number, to: number): [number, number] {
    const length = Math.min(this.clock.end, Math.max(SHORTEST, to - from)), begin = Math.min(Math.max(0, from), this.clock.end - length);
    return [begin, begin + length];
  }

  /** The cursor does not leave what is shown. */
  private follow(time: number): void {
    if (!this.zoomed || (time >= this.from && time <= this.to)) return;
    const length = this.to - this.from, from = time < this.from ? time - 0.1 * length : time - 0.9 * length;
    this.show(from, from + length);
  }
}
