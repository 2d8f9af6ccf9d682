// SPDX-License-Identifier: Apache-2.0

/** The one time cursor: whoever shows a moment listens, whoever moves it calls seek(). */
export class Clock {
  time = 0;
  rate = 1;
  playing = false;
  private listeners: ((time: number) => void)[] = [];
  private states: (() => void)[] = [];
  private ends: (() => void)[] = [];
  private last = 0;

  /** @param end of this flight [s]; a second one may last longer. */
  constructor(public end: number) {}

  onEnd(listener: () => void): void { this.ends.push(listener); }
  extend(end: number): void {
    this.end = end;
    for (const listener of this.ends) listener();
    this.seek(this.time);
  }

  onTime(listener: (time: number) => void): void { this.listeners.push(listener); }
  onState(listener: () => void): void { this.states.push(listener); }

  seek(time: number): void {
    this.time = Math.min(this.end, Math.max(0, time));
    for (const listener of this.listeners) listener(this.time);
  }

  play(on = !this.playing): void {
    if (on && this.time >= this.end) this.seek(0);
    this.playing = on;
    for (const listener of this.states) listener();
    if (!on) return;
    this.last = performance.now();
    requestAnimationFrame(this.tick);
  }

  private tick = (now: number): void => {
    if (!this.playing) return;
    this.seek(this.time + Math.max(0, now - this.last) * 1e-3 * this.rate);
    this.last = now;
    if (this.time >= this.end) this.play(false);
    else requestAnimationFrame(this.tick);
  };
}
