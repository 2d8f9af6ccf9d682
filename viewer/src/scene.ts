// SPDX-License-Identifier: Apache-2.0
import {
  AmbientLight, BoxGeometry, BufferGeometry, Color, CylinderGeometry, DirectionalLight, EdgesGeometry, Euler, Float32BufferAttribute, GridHelper,
  Group, Line, LineBasicMaterial, LineDashedMaterial, LineSegments, Matrix4, Mesh, MeshBasicMaterial, MeshLambertMaterial, PerspectiveCamera, Scene,
  SphereGeometry, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { Line2 } from "three/examples/jsm/lines/Line2.js";
import { LineGeometry } from "three/examples/jsm/lines/LineGeometry.js";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import type { Clock } from "./clock";
import { ATTITUDE, EST_ATTITUDE, EST_VELOCITY, ESTIMATE, POSITION, VELOCITY, type Flight, type Gate, type Vec3 } from "./flight";
import { ending } from "./events";
import { fastest, label, solid, speedColor } from "./scene_parts";
import type { Second } from "./second";
import { color, onTheme } from "./theme";

// The flight's axes are north, east, down; WebGL's y is up.
const NED = new Matrix4().set(0, 1, 0, 0, 0, 0, -1, 0, -1, 0, 0, 0, 0, 0, 0, 1);
export type View = "overview" | "above" | "follow";

/** Course, flight and drone in three dimensions. */
export class SceneView {
  /** Time of the row that the drone stands at [s]. */
  stamp = 0;
  frames = 0;
  private readonly box = document.querySelector<HTMLElement>("#scene")!;
  private readonly canvas = this.box.querySelector("canvas")!;
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private world = new Group();
  private readonly camera = new PerspectiveCamera(45, 1, 0.05, 500);
  private readonly orbit: OrbitControls;
  private drone = new Group();
  private estimate = new Group();
  private cloud!: Mesh;
  private flown: { line: Line2; segments: number; flight: Flight; shift: number }[] = [];
  private second: Second | null = null;
  private ghost = new Group();
  private rings: Mesh[] = [];
  private view: View = "overview";
  private waiting = false;

  /** @throws Error when there is no WebGL. */
  constructor(private readonly flight: Flight, private readonly clock: Clock) {
    this.renderer = new WebGLRenderer({ canvas: this.canvas, antialias: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio || 1, 2));
    this.orbit = new OrbitControls(this.camera, this.canvas);
    this.orbit.maxPolarAngle = 0.495 * Math.PI;
    this.orbit.addEventListener("change", () => this.draw());
    this.scene.add(new AmbientLight(0xffffff, 1.6));
    const sun = new DirectionalLight(0xffffff, 2.0);
    sun.position.set(4, 10, 6);
    this.scene.add(sun);
    this.build();
    this.resize();
    this.look("overview");
    for (const button of this.box.querySelectorAll<HTMLButtonElement>("[data-view]"))
      button.addEventListener("click", () => this.look(button.dataset.view as View));
    clock.onTime(() => this.move());
    onTheme(() => { this.build(); this.move(); });
    new ResizeObserver(() => this.resize()).observe(this.canvas);
  }

  /** Where races were lost, and where the second flight stands; for tests. */
  ends(): number[][] { return this.world.children.filter((node) => node.name === "end").map((node) => node.position.toArray()); }
  secondAt(): number[] { return this.ghost.position.toArray(); }

  /** Another flight beside this one; null: alone again. */
  show(second: Second | null): void {
    this.second = second;
    this.build();
    this.move();
  }

  private build(): void {
    this.scene.remove(this.world);
    this.world = new Group();
    this.world.matrixAutoUpdate = false;
    this.world.matrix.copy(NED);
    this.scene.add(this.world);
    this.scene.background = new Color(color("well"));
    const course = this.flight.course;
    this.addRoom();
    for (const obstacle of course.obstacles) this.world.add(solid(obstacle, color("solid"), 0.75));
    for (const decoy of course.decoys) this.world.add(solid(decoy, color("gate"), 0.55));
    this.rings = course.gates.map((gate, i) => this.addGate(gate, i));
    for (const leg of course.plan) this.addPlan(leg);
    this.addPaths();
    this.addDrone();
    this.addEnd(this.flight, "bad");
    this.addSecond();
  }

  private addRoom(): void {
    const { room_center: [x, y], room_size: [north, east, height] } = this.flight.course;
    const size = Math.ceil(Math.max(north, east));
    const grid = new GridHelper(size, size, color("grid-strong"), color("grid-scene"));
    grid.rotation.x = Math.PI / 2;
    grid.position.set(x, y, 0);
    this.world.add(grid);
    const walls = new LineSegments(new EdgesGeometry(new BoxGeometry(north, east, height)), new LineBasicMaterial({ color: color("grid-strong") }));
    walls.position.set(x, y, -height / 2);
    this.world.add(walls);
  }

  private addGate(gate: Gate, index: number): Mesh {
    const group = new Group();
    group.position.set(...gate.position);
    group.rotation.z = gate.heading;
    const material = new MeshLambertMaterial({ color: color("gate-solid") });
    const middle = (gate.side - gate.bar) / 2;
    for (const [y, z, width, height] of [[0, -middle, gate.side, gate.bar], [0, middle, gate.side, gate.bar], [-middle, 0, gate.bar, gate.side], [middle, 0, gate.bar, gate.side]]) {
      const bar = new Mesh(new BoxGeometry(gate.bar, width, height), material);
      bar.position.set(0, y, z);
      group.add(bar);
    }
    const low = -gate.position[2] - gate.side / 2;
    if (low > 0.02) {
      const pole = new Mesh(new BoxGeometry(0.04, 0.04, low), new MeshLambertMaterial({ color: color("solid") }));
      pole.position.set(0, 0, gate.side / 2 + low / 2);
      group.add(pole);
    }
    const name = label(String(index + 1));
    name.position.set(0, 0, -gate.side / 2 - 0.28);
    group.add(name);
    // The one the pilot flies to is filled.
    const pane = new Mesh(new BoxGeometry(0.005, gate.side - 2 * gate.bar, gate.side - 2 * gate.bar),
      new MeshBasicMaterial({ color: color("gate-solid"), transparent: true, opacity: 0.3, depthWrite: false }));
    group.add(pane);
    this.world.add(group);
    if (gate.map) {  // where the pilot's map has it
      const ghost = new LineSegments(new EdgesGeometry(new BoxGeometry(gate.bar, gate.side, gate.side)), new LineBasicMaterial({ color: color("plan") }));
      ghost.position.set(...gate.map.position);
      ghost.rotation.z = gate.map.heading;
      this.world.add(ghost);
    }
    return pane;
  }

  private addPlan(points: Vec3[]): void {
    const geometry = new BufferGeometry().setAttribute("position", new Float32BufferAttribute(points.flat(), 3));
    const line = new Line(geometry, new LineDashedMaterial({ color: color("plan"), dashSize: 0.18, gapSize: 0.14 }));
    line.computeLineDistances();
    this.world.add(line);
  }

  /** Twice: faint for all of the flight, strong for what is flown at the cursor. */
  private addPaths(): void {
    const f = this.flight, rows = f.t.length, fast = fastest(f), steps = Array.from({ length: 65 }, (_, i) => speedColor(i / 64));
    const truth: number[] = [], belief: number[] = [], colors: number[] = [];
    for (let row = 0; row < rows; ++row) {
      truth.push(...f.known(POSITION, ESTIMATE, row));
      belief.push(...f.vector(ESTIMATE, row));
      const part = Math.min(1, Math.hypot(...f.known(VELOCITY, EST_VELOCITY, row)) / fast);
      const { r, g, b } = steps[Math.round(64 * part) || 0];
      colors.push(r, g, b);
    }
    this.flown = [];
    if (rows < 2) return;
    const add = (points: number[], width: number, opacity: number, strong: boolean, one?: string) => {
      const line = this.addLine(points, width, opacity, one ?? colors);
      if (strong) this.flown.push({ line, segments: rows - 1, flight: f, shift: 0 });
    };
    add(truth, 1.5, 0.3, false);
    if (f.hasTruth) {
      add(belief, 1.2, 0.3, false, color("estimate"));
      add(belief, 1.6, 1, true, color("estimate"));
    }
    add(truth, 3.5, 1, true);
  }

  /** @param paint one colour, or one for each point */
  private addLine(points: number[], width: number, opacity: number, paint: string | number[]): Line2 {
    const geometry = new LineGeometry().setPositions(points), one = typeof paint === "string";
    if (!one) geometry.setColors(paint);
    const line = new Line2(geometry, new LineMaterial({ color: one ? paint : 0xffffff, vertexColors: !one, linewidth: width, transparent: opacity < 1, opacity }));
    line.frustumCulled = false;
    this.world.add(line);
    return line;
  }

  /** Where a race was lost: a cross that is seen from everywhere. */
  private addEnd(flight: Flight, name: string): void {
    if (ending(flight).kind !== "bad" || !flight.t.length) return;
    const mark = label("✕", color(name), 0.75);
    mark.position.set(...flight.known(POSITION, ESTIMATE, flight.t.length - 1));
    mark.name = "end";
    this.world.add(mark);
  }

  private addSecond(): void {
    if (!this.second) return;
    const { flight, shift } = this.second, points: number[] = [];
    for (let row = 0; row < flight.t.length; ++row) points.push(...flight.known(POSITION, ESTIMATE, row));
    this.ghost = new Group();
    this.ghost.add(new Mesh(new SphereGeometry(0.11, 16, 12), new MeshBasicMaterial({ color: color("second"), transparent: true, opacity: 0.85 })));
    this.world.add(this.ghost);
    this.addEnd(flight, "second");
    if (flight.t.length < 2) return;
    this.addLine(points, 1.5, 0.35, color("second"));
    this.flown.push({ line: this.addLine(points, 2.5, 1, color("second")), segments: flight.t.length - 1, flight, shift });
  }

  private addDrone(): void {
    this.drone = new Group();
    const ink = new MeshLambertMaterial({ color: color("ink") });
    this.drone.add(new Mesh(new BoxGeometry(0.28, 0.09, 0.06), ink));
    const nose = new Mesh(new BoxGeometry(0.07, 0.07, 0.05), new MeshLambertMaterial({ color: color("found") }));
    nose.position.set(0.15, 0, 0);
    this.drone.add(nose);
    for (const [x, y] of [[0.12, 0.15], [0.12, -0.15], [-0.12, 0.15], [-0.12, -0.15]]) {
      const disc = new Mesh(new CylinderGeometry(0.1, 0.1, 0.012, 20), new MeshLambertMaterial({ color: color("ink"), transparent: true, opacity: 0.7 }));
      disc.rotation.x = Math.PI / 2;
      disc.position.set(x, y, -0.04);
      this.drone.add(disc);
    }
    this.estimate = new Group();
    this.estimate.add(new Mesh(new SphereGeometry(0.045, 12, 8), new MeshBasicMaterial({ color: color("estimate") })));
    this.cloud = new Mesh(new SphereGeometry(1, 24, 16), new MeshBasicMaterial({ color: color("estimate"), transparent: true, opacity: 0.22, depthWrite: false }));
    this.cloud.matrixAutoUpdate = false;
    this.world.add(this.drone, this.estimate, this.cloud);
  }

  private move(): void {
    const f = this.flight, row = f.row(this.clock.time);
    const [roll, pitch, yaw] = f.known(ATTITUDE, EST_ATTITUDE, row), place = f.known(POSITION, ESTIMATE, row), believed = f.vector(ESTIMATE, row);
    this.drone.position.set(...place);
    this.drone.rotation.copy(new Euler(roll, pitch, yaw, "ZYX"));
    this.estimate.position.set(...believed);

    // The ±3σ ellipsoid: the unit sphere under three times the Cholesky factor, in the gate's axes.
    const target = f.column("target_gate")[row], gate = f.course.gates[target];
    const l = (name: string) => 3 * f.column(`l_${name}_m`)[row];
    const spread = new Matrix4().set(l("xx"), 0, 0, 0, l("yx"), l("yy"), 0, 0, l("zx"), l("zy"), l("zz"), 0, 0, 0, 0, 1);
    this.cloud.matrix.makeTranslation(...believed).multiply(new Matrix4().makeRotationZ(gate?.map?.heading ?? gate?.heading ?? 0)).multiply(spread);
    this.cloud.visible = ["straight", "turn", "search"].includes(f.phase(row));

    const done = f.column("gates_passed")[row] >= f.summary.gates_total;
    this.rings.forEach((pane, i) => (pane.visible = !done && i === target));
    for (const { line, segments, flight, shift } of this.flown) {
      const flown = flight.row(this.clock.time - shift);
      line.geometry.instanceCount = Math.min(flown, segments);
      line.visible = flown > 0;
    }
    if (this.second) {
      const { flight, shift } = this.second;
      this.ghost.position.set(...flight.known(POSITION, ESTIMATE, flight.row(this.clock.time - shift)));
    }
    if (this.view === "follow") this.follow();
    this.stamp = f.t[row] ?? 0;
    this.draw();
  }

  look(view: View): void {
    this.view = view;
    for (const button of this.box.querySelectorAll<HTMLElement>("[data-view]"))
      button.setAttribute("aria-pressed", String(button.dataset.view === view));
    const { middle: [x, y], north, east } = this.extent();
    const middle = new Vector3(x, y, -0.8).applyMatrix4(NED);
    // Far enough for the course's width and depth at this shape of the window.
    const half = Math.tan((this.camera.fov * Math.PI) / 360);
    const wide = (0.5 * east) / (half * this.camera.aspect), deep = (0.5 * north) / half;
    this.orbit.target.copy(middle);
    if (view === "above") this.camera.position.copy(middle).add(new Vector3(0, Math.max(wide, deep) + 1.5, 0.01));
    else if (view === "overview") {
      const far = Math.max(wide, 0.85 * deep) + 0.25 * north + 0.5;
      this.camera.position.copy(middle).add(new Vector3(0.1 * far, 0.66 * far, 0.74 * far));
    } else this.follow(true);
    this.orbit.update();
    this.draw();
  }

  /** What a view has to show: gates and flight, a metre around them. */
  private extent(): { middle: [number, number]; north: number; east: number } {
    const f = this.flight, gates = f.course.gates.map((gate) => gate.position);
    const range = (axis: 0 | 1): [number, number] => {
      const flown = f.each((i) => f.known(POSITION, ESTIMATE, i)[axis]);
      const places = gates.map((place) => place[axis]);
      return [flown.reduce((a, b) => Math.min(a, b), Math.min(...places, flown[0] ?? 0)) - 1,
              flown.reduce((a, b) => Math.max(a, b), Math.max(...places, flown[0] ?? 0)) + 1];
    };
    const [south, north] = range(0), [west, east] = range(1);
    return { middle: [(south + north) / 2, (west + east) / 2], north: north - south, east: east - west };
  }

  /** Behind and above the drone; then along with it, as the user has turned the view. */
  private follow(first = false): void {
    const row = this.flight.row(this.clock.time), yaw = this.flight.known(ATTITUDE, EST_ATTITUDE, row)[2];
    const at = new Vector3(...this.flight.known(POSITION, ESTIMATE, row)).applyMatrix4(NED);
    if (first) {
      const back = new Vector3(-2.6 * Math.cos(yaw), -2.6 * Math.sin(yaw), -1.2).applyMatrix4(NED);
      this.camera.position.copy(at).add(back);
    } else this.camera.position.add(at.clone().sub(this.orbit.target));
    this.orbit.target.copy(at);
    this.orbit.update();
  }

  private resize(): void {
    const width = this.canvas.clientWidth, height = this.canvas.clientHeight;
    if (!width || !height) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (this.view !== "follow") this.look(this.view);
    this.draw();
  }

  /** Once a frame of the browser, and only when something changed. */
  private draw(): void {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.renderer.render(this.scene, this.camera);
      ++this.frames;
    });
  }
}
