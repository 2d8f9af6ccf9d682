// SPDX-License-Identifier: Apache-2.0
// What stands in the scene, and its colours.
import { BoxGeometry, CanvasTexture, Color, CylinderGeometry, Mesh, MeshLambertMaterial, Sprite, SpriteMaterial, SRGBColorSpace, type Object3D } from "three";
import type { Box, Flight } from "./flight";
import { color } from "./theme";

/** The speed at the fast end of the colours [m/s]. */
export const fastest = (flight: Flight): number => 1.4 * flight.course.speed_mps;

/** Colour of a speed, as a part of the fastest. */
export function speedColor(part: number): Color {
  const [slow, quick, fast] = ["slow", "flown", "fast"].map((name) => new Color(color(name)));
  return part < 0.5 ? slow.lerp(quick, part / 0.5) : quick.lerp(fast, Math.min(1, (part - 0.5) / 0.5));
}

/** A box or a pole on the floor. */
export function solid(box: Box, colour: string, opacity: number): Object3D {
  const height = box.top - box.bottom;
  const shape = box.pole ? new CylinderGeometry(box.size[0] / 2, box.size[0] / 2, height, 20).rotateX(Math.PI / 2) : new BoxGeometry(box.size[0], box.size[1], height);
  const mesh = new Mesh(shape, new MeshLambertMaterial({ color: colour, transparent: true, opacity }));
  mesh.position.set(box.center[0], box.center[1], -(box.bottom + box.top) / 2);
  mesh.rotation.z = box.heading;
  return mesh;
}

/** A sign that always faces the camera. @param size [m] */
export function label(text: string, colour = color("gate"), size = 0.5): Sprite {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 64;
  const context = canvas.getContext("2d")!;
  context.font = "bold 46px system-ui, sans-serif";
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.fillStyle = colour;
  context.fillText(text, 32, 34);
  const map = new CanvasTexture(canvas);
  map.colorSpace = SRGBColorSpace;
  const sprite = new Sprite(new SpriteMaterial({ map, depthTest: false }));
  sprite.scale.setScalar(size);
  return sprite;
}
