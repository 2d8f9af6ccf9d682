// SPDX-License-Identifier: Apache-2.0
// A flight as src/workshop/gatefly/report/flight_page.cpp writes it.

export type Vec3 = [number, number, number];

export interface Gate { position: Vec3; heading: number; side: number; bar: number; map?: { position: Vec3; heading: number } }
export interface Box { center: [number, number]; size: [number, number]; heading: number; bottom: number; top: number; pole: boolean }
export interface Look {
  t: number; exposed: number; took_ms?: number; target: number; picture?: number; offered?: boolean; source?: "corners" | "bars"; used?: number;
  nis?: number; dof?: number; fix?: Vec3; gates?: { px: number[]; fitness: number }[]; bars?: number[]; lower?: number[];
}
export interface Pass { gate: number; lap: number; t?: number; speed?: number; offset?: [number, number]; seen?: number; seen_from?: number }
export interface Course {
  room_center: [number, number]; room_size: Vec3; laps: number; speed_mps: number; gates: Gate[]; obstacles: Box[]; decoys: Box[]; plan: Vec3[][];
  accel_bias_mps2?: Vec3; gyro_bias_radps?: Vec3; rotor_limits_radps?: [number, number];
}
/** Why a race was lost, split into what each part of the drone did to it. */
export interface Why {
  line: string; t_s: number; object: string; since_fix_s: number | null; wind_mps: number | null;
  /** Lateral to the right, vertical down. `share_cm`: of the miss's length; negative: against it. */
  parts: { cause: "estimate" | "guidance" | "map" | "detection"; lateral_cm: number; vertical_cm: number; share_cm?: number }[];
}
/** Of a race; a replay has less to tell. */
export interface Summary {
  kind?: "replay"; flight?: string; estimator?: string; fixes?: number; position_rmse_m?: Vec3 | null; recorded?: string;
  finished: boolean; gates_passed: number; gates_total: number; race_time_s: number; lap_times_s: number[]; mean_speed_mps: number;
  max_speed_mps: number; crash: null | { t_s: number; object: string }; stop_reason: string; abort_reason: string; landing_contact: string | null;
  estimation_rmse_m: Vec3; searches: number; flight_time_s: number; seed: number; track: string; vision: string; version: string;
  detection: { frames: number; with_gate_visible: number; true_positives: number; false_positives: number };
  timings: Record<string, Record<string, number>>; config: unknown;
}

export class Flight {
  readonly verdict: string;
  readonly summary: Summary;
  readonly why: Why | null;
  readonly phases: string[];
  readonly camera: [number, number];
  readonly course: Course;
  readonly passes: Pass[];
  readonly looks: Look[];
  readonly pictures: string[];
  readonly film: null | { rate: number; pictures: number };
  readonly filmFailed: boolean;
  readonly t: Float64Array;
  private readonly columns = new Map<string, Float64Array>();

  constructor(flight: string, pictures = "[]") {
    const data = JSON.parse(flight);
    this.verdict = data.verdict;
    this.summary = data.summary;
    this.why = data.why ?? null;
    this.phases = data.phases;
    this.camera = data.camera;
    this.course = data.course;
    this.passes = data.passes;
    this.looks = data.looks;
    this.pictures = JSON.parse(pictures);
    this.film = data.film ?? null;
    this.filmFailed = data.film_failed === true;
    for (const [name, { unit, steps }] of Object.entries<{ unit: number; steps: (number | null)[] }>(data.columns)) {
      let sum = 0;
      const scale = Math.round(1 / unit);
      this.columns.set(name, Float64Array.from(steps, (step) => (step === null ? NaN : (sum += step) / scale)));
    }
    this.t = this.columns.get("t_s") ?? new Float64Array();
  }

  get end(): number { return this.t.length ? this.t[this.t.length - 1] : 0; }

  has(name: string): boolean { return this.columns.get(name)?.some((value) => !Number.isNaN(value)) ?? false; }
  /** Whether anybody knows where the drone really was. */
  get hasTruth(): boolean { return this.has("x_m"); }

  /** NaN where nobody knows. */
  column(name: string): Float64Array {
    let column = this.columns.get(name);
    if (!column) this.columns.set(name, (column = new Float64Array(this.t.length).fill(NaN)));
    return column;
  }

  vector(names: string[], row: number): Vec3 { return names.map((name) => this.column(name)[row]) as Vec3; }

  /** Where to draw the drone: where it was, else where the pilot believed it to be. */
  known(truth: string[], estimate: string[], row: number): Vec3 {
    const there = this.vector(truth, row);
    return there.some(Number.isNaN) ? this.vector(estimate, row) : there;
  }

  /** Column by column: f of every row. */
  each(f: (row: number) => number): Float64Array { return Float64Array.from(this.t, (_, row) => f(row)); }

  /** When the body leaves the ground, by the pilot's phase [s]. */
  get takeOff(): number {
    const row = this.t.findIndex((_, i) => this.phase(i) !== "ground");
    return row < 0 ? 0 : this.t[row];
  }

  /** The last row that is not after `time`. */
  row(time: number): number { return Math.max(0, lastUpTo(this.t.length, (i) => this.t[i], time)); }
  /** The last picture that had arrived at `time`; -1: none yet. */
  look(time: number): number { return lastUpTo(this.looks.length, (i) => this.looks[i].t, time); }

  phase(row: number): string { return this.phases[this.column("phase")[row]]; }
}

/** The last of `count` ascending times that is not after `time`; -1: none. */
export function lastUpTo(count: number, at: (i: number) => number, time: number): number {
  let low = 0, high = count;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (at(middle) <= time + 1e-9) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

export const POSITION = ["x_m", "y_m", "z_m"], ESTIMATE = ["est_x_m", "est_y_m", "est_z_m"];
export const VELOCITY = ["vx_mps", "vy_mps", "vz_mps"], EST_VELOCITY = ["est_vx_mps", "est_vy_mps", "est_vz_mps"];
export const ATTITUDE = ["roll_rad", "pitch_rad", "yaw_rad"], EST_ATTITUDE = ["est_roll_rad", "est_pitch_rad", "est_yaw_rad"];
