// SPDX-License-Identifier: Apache-2.0
import type { Clock } from "./clock";
import { lastUpTo, type Flight, type Look } from "./flight";
import { color, onTheme } from "./theme";
import { byId, degrees, element } from "./text";

const AHEAD = 8;  // pictures decoded before they are needed

/** What the camera showed and what was found in it. */
export class Onboard {
  /** Arrival of what is shown [s]; null: nothing yet. `picture`: of the pixels behind it. */
  shown: { look: number; picture: number } | null = null;
  private readonly canvas = document.querySelector<HTMLCanvasElement>("#onboard canvas")!;
  private readonly note = byId("sight");
  private readonly cells: HTMLElement[];
  private readonly withPicture: Look[];
  private readonly decoded = new Map<number, HTMLImageElement>();
  private readonly size: [number, number];

  constructor(private readonly flight: Flight, private readonly clock: Clock) {
    this.withPicture = flight.looks.filter((look) => look.picture !== undefined);
    this.size = flight.camera[0] > 0 ? flight.camera : this.extent();
    const scale = Math.max(1, Math.round(640 / this.size[0]));
    this.canvas.width = this.size[0] * scale;
    this.canvas.height = this.size[1] * scale;
    this.cells = ["phase", "next gate", "height", "speed", "error", "±3σ"].map((name) => {
      const box = element("div"), value = element("dd");
      box.append(element("dt", name), value);
      byId("now").append(box);
      return value;
    });
    clock.onTime(() => this.draw());
    onTheme(() => this.draw());
  }

  /** Without pictures: what is large enough for all that was found. */
  private extent(): [number, number] {
    let right = 314, low = 159;
    for (const look of this.flight.looks)
      for (const gate of look.gates ?? [])
        for (let i = 0; i < 8; i += 2) { right = Math.max(right, gate.px[i]); low = Math.max(low, gate.px[i + 1]); }
    return [Math.min(640, Math.ceil(right) + 1), Math.min(640, Math.ceil(low) + 1)];
  }

  private picture(index: number): HTMLImageElement {
    let image = this.decoded.get(index);
    if (!image) {
      if (this.decoded.size > 400) this.decoded.clear();
      image = new Image();
      image.onload = () => this.draw();
      image.src = `data:image/jpeg;base64,${this.flight.pictures[index]}`;
      this.decoded.set(index, image);
    }
    return image;
  }

  draw(): void {
    const time = this.clock.time;
    this.numbers(this.flight.row(time));
    const context = this.canvas.getContext("2d")!, { width, height } = this.canvas;
    context.fillStyle = color("well");
    context.fillRect(0, 0, width, height);
    const index = this.flight.look(time);
    if (index < 0) {
      this.shown = null;
      this.say("no picture yet", context);
      return;
    }
    const at = lastUpTo(this.withPicture.length, (i) => this.withPicture[i].t, time);
    // What was found belongs to the picture it was found in.
    const look = at >= 0 ? this.withPicture[at] : this.flight.looks[index];
    if (at >= 0) {
      for (let i = at + 1; i <= Math.min(at + AHEAD, this.withPicture.length - 1); ++i) this.picture(this.withPicture[i].picture!);
      const image = this.picture(look.picture!);
      if (!image.complete) return;  // comes back when it is decoded
      context.drawImage(image, 0, 0, width, height);
      this.shown = { look: look.t, picture: look.t };
    } else {
      this.shown = { look: look.t, picture: NaN };
      if (!look.gates?.length && !look.bars && !look.lower) this.say("ideal vision: no pictures, nothing found", context);
    }
    this.outline(look, context, width / this.size[0]);
    const found = look.gates?.length ?? 0;
    this.note.textContent =
      `${look.t.toFixed(2)} s, exposed ${(1000 * (look.t - look.exposed)).toFixed(0)} ms before: ` +
      (look.source ? `position from ${look.source}` + (look.dof ? `, NIS ${look.nis?.toFixed(1)} (${look.dof} dof)` : "")
        : look.offered ? "fix refused by the filter" : found ? `${found} found, none used` : "no gate found");
  }

  private say(text: string, context: CanvasRenderingContext2D): void {
    context.fillStyle = color("muted");
    context.font = `${Math.round(this.canvas.width / 26)}px system-ui, sans-serif`;
    context.textAlign = "center";
    context.fillText(text, this.canvas.width / 2, this.canvas.height / 2);
    this.note.textContent = "";
  }

  private outline(look: Look, context: CanvasRenderingContext2D, scale: number): void {
    const at = (u: number, v: number): [number, number] => [(u + 0.5) * scale, (v + 0.5) * scale];
    const stroke = (points: [number, number][], closed: boolean, strong: boolean) => {
      context.beginPath();
      points.forEach(([x, y], i) => (i ? context.lineTo(x, y) : context.moveTo(x, y)));
      if (closed) context.closePath();
      context.globalAlpha = strong ? 1 : 0.6;
      context.lineWidth = (strong ? 2.2 : 1.1) * Math.max(1, scale);
      context.strokeStyle = "#001a20";
      context.stroke();
      context.lineWidth *= 0.6;
      context.strokeStyle = color("found");
      context.stroke();
      context.globalAlpha = 1;
    };
    look.gates?.forEach((gate, i) => {
      const corners = [0, 2, 4, 6].map((k) => at(gate.px[k], gate.px[k + 1]));
      stroke(corners, true, i === look.used);
    });
    if (look.bars)
      for (const k of [0, 2]) {
        const [x] = at(look.bars[k], 0);
        stroke([[x, 0.06 * this.canvas.height], [x, 0.94 * this.canvas.height]], false, true);
      }
    if (look.lower) {
      const [l, r] = [at(look.lower[0], look.lower[1]), at(look.lower[2], look.lower[3])];
      const up = 0.35 * Math.hypot(r[0] - l[0], r[1] - l[1]);
      stroke([[l[0], l[1] - up], l, r, [r[0], r[1] - up]], false, true);
    }
  }

  private numbers(row: number): void {
    const f = this.flight, c = (name: string) => f.column(name)[row];
    const sigma = Math.hypot(c("l_xx_m"), c("l_yx_m"), c("l_yy_m"), c("l_zx_m"), c("l_zy_m"), c("l_zz_m"));
    const done = c("gates_passed") >= f.summary.gates_total;
    const values = [
      f.phase(row), done ? "none" : String(c("target_gate") + 1), `${(-c("z_m")).toFixed(2)} m`,
      `${Math.hypot(c("vx_mps"), c("vy_mps"), c("vz_mps")).toFixed(2)} m/s`,
      `${Math.hypot(c("error_x_m"), c("error_y_m"), c("error_z_m")).toFixed(2)} m`, `${(3 * sigma).toFixed(2)} m`,
    ];
    values.forEach((value, i) => (this.cells[i].textContent = value));
    this.cells[3].title = `roll ${degrees(c("roll_rad")).toFixed(0)}°, pitch ${degrees(c("pitch_rad")).toFixed(0)}°`;
  }
}
