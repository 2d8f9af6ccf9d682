// SPDX-License-Identifier: Apache-2.0
import type { Clock } from "./clock";
import { ATTITUDE, EST_ATTITUDE, EST_VELOCITY, ESTIMATE, lastUpTo, POSITION, VELOCITY, type Flight, type Look } from "./flight";
import { ending } from "./events";
import { color, onTheme } from "./theme";
import { Film } from "./film";
import { byId, degrees, element } from "./text";

const AHEAD = 8;      // pictures decoded before they are needed
const IN_FILM = 320;  // largest side of a picture in the film [px]

/** What the camera showed and what was found in it. */
export class Onboard {
  /** Arrival of what is shown [s]; null: nothing yet. `picture`: of the pixels behind it. */
  shown: { look: number; picture: number } | null = null;
  private readonly canvas = document.querySelector<HTMLCanvasElement>("#onboard canvas")!;
  private readonly note = byId("sight");
  private readonly cells: HTMLElement[];
  private readonly withPicture: Look[];
  private readonly decoded = new Map<number, HTMLImageElement>();
  private readonly byPicture: Map<number, Look>;
  readonly film: Film | null;
  private readonly size: [number, number];

  constructor(private readonly flight: Flight, private readonly clock: Clock) {
    this.withPicture = flight.looks.filter((look) => look.picture !== undefined);
    this.byPicture = new Map(this.withPicture.map((look) => [look.picture!, look]));
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
    const base64 = flight.film ? document.getElementById("film")?.textContent ?? "" : "";
    const smaller = Math.ceil(Math.max(...this.size) / IN_FILM), inFilm = this.size.map((side) => Math.ceil(side / smaller)) as [number, number];
    this.film = base64 ? new Film(base64, flight.film!.rate, inFilm, () => this.draw()) : null;
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

  /** The look whose picture is there, and the pixels; null: wait, it comes back when they are decoded. */
  private pixels(at: number): null | { look: Look; pixels: CanvasImageSource; stamp: number } {
    const look = this.withPicture[at];
    if (!this.film) {
      for (let i = at + 1; i <= Math.min(at + AHEAD, this.withPicture.length - 1); ++i) this.picture(this.withPicture[i].picture!);
      const image = this.picture(look.picture!);
      return image.complete ? { look, pixels: image, stamp: look.t } : null;
    }
    this.film.want(look.picture!);
    const shown = this.byPicture.get(this.film.shown);
    return shown ? { look: shown, pixels: this.film.canvas, stamp: shown.t } : null;
  }

  draw(): void {
    const time = this.clock.time;
    this.numbers(this.flight.row(time));
    const context = this.canvas.getContext("2d")!, { width, height } = this.canvas;
    const at = lastUpTo(this.withPicture.length, (i) => this.withPicture[i].t, time);
    const index = this.flight.look(time), filmed = !this.film?.failed && at >= 0;
    const there = filmed ? this.pixels(at) : null;
    if (filmed && !there) return;
    context.fillStyle = color("well");
    context.fillRect(0, 0, width, height);
    if (index < 0) {
      this.shown = null;
      this.say("no picture yet", context);
      return;
    }
    // What was found belongs to the picture it was found in.
    const look = there?.look ?? this.flight.looks[index];
    if (there) context.drawImage(there.pixels, 0, 0, width, height);
    this.shown = { look: look.t, picture: there?.stamp ?? NaN };
    if (!there && !look.gates?.length && !look.bars && !look.lower) this.say(this.whyNone(), context);
    this.outline(look, context, width / this.size[0]);
    this.ended(time, context);
    const found = look.gates?.length ?? 0;
    this.note.textContent =
      `${look.t.toFixed(2)} s` + (look.exposed < look.t ? `, exposed ${(1000 * (look.t - look.exposed)).toFixed(0)} ms before: ` : ": ") +
      (look.source ? `position from ${look.source}` + (look.dof ? `, NIS ${look.nis?.toFixed(1)} (${look.dof} dof)` : "")
        : look.offered ? "fix refused by the filter" : found ? `${found} found, none used` : "no gate found");
  }

  private whyNone(): string {
    if (this.film?.failed) return "this browser cannot show the onboard film";
    if (this.flight.filmFailed) return "ffmpeg failed: no onboard film";
    return "ideal vision: no pictures, nothing found";
  }

  /** From the contact on, the last picture says so. */
  private ended(time: number, context: CanvasRenderingContext2D): void {
    const end = ending(this.flight), { width, height } = this.canvas, size = Math.round(width / 24);
    if (end.kind !== "bad" || time < end.t - 1e-3) return;
    context.fillStyle = color("bad");
    context.fillRect(0, height - 2 * size, width, 2 * size);
    context.strokeStyle = color("bad");
    context.lineWidth = size / 3;
    context.strokeRect(0, 0, width, height);
    context.fillStyle = color("panel");
    context.textAlign = "center";
    context.font = `600 ${size}px system-ui, sans-serif`;
    context.fillText(`${end.t.toFixed(1)} s: ${end.text}`, width / 2, height - 0.65 * size, 0.95 * width);
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
    const error = Math.hypot(c("error_x_m"), c("error_y_m"), c("error_z_m"));
    const done = c("gates_passed") >= f.summary.gates_total;
    const values = [
      f.phase(row), done ? "none" : String(c("target_gate") + 1), `${(-f.known(POSITION, ESTIMATE, row)[2]).toFixed(2)} m`,
      `${Math.hypot(...f.known(VELOCITY, EST_VELOCITY, row)).toFixed(2)} m/s`,
      Number.isNaN(error) ? "not known" : `${error.toFixed(2)} m`, `${(3 * sigma).toFixed(2)} m`,
    ];
    values.forEach((value, i) => (this.cells[i].textContent = value));
    const [roll, pitch] = f.known(ATTITUDE, EST_ATTITUDE, row);
    this.cells[3].title = `roll ${degrees(roll).toFixed(0)}°, pitch ${degrees(pitch).toFixed(0)}°`;
  }
}
