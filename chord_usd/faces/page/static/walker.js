// Walking through a house at eye height: rooms and the holes of doors are where one can be.
import { THREE } from "./three.js";
import { isInside, roomsOf } from "./plan_model.js";

const M_PER_S = 1.6;
const TURN_PER_S = 1.6;
const LOOK_PER_PX = 0.004;
const KEYS = {
  ArrowUp: "ahead", KeyW: "ahead", ArrowDown: "back", KeyS: "back",
  ArrowLeft: "left", ArrowRight: "right", KeyA: "aside", KeyD: "beside",
};

export class Walker {
  /** floors: polygons [[x, y]] in metres, of the plan; start: where on it. */
  constructor(camera, canvas, floors, start, eye, draw) {
    Object.assign(this, { camera, canvas, floors, draw, yaw: 0, pitch: 0, held: new Set() });
    camera.position.set(start[0], eye, -start[1]);
    this.yaw = this.farthest();
    this.listeners = [
      [canvas, "keydown", (event) => this.key(event, true)],
      [canvas, "keyup", (event) => this.key(event, false)],
      [canvas, "blur", () => this.held.clear()],
      [canvas, "pointermove", (event) => event.buttons && this.look(event)],
    ];
    for (const [node, name, act] of this.listeners) node.addEventListener(name, act);
    this.turn();
  }

  /** The way in which one sees farthest. */
  farthest() {
    const { x, z } = this.camera.position;
    let best = [0, 0];
    for (let yaw = 0; yaw < 2 * Math.PI; yaw += Math.PI / 8) {
      let far = 0;
      while (far < 20 && this.canStand(x - Math.sin(yaw) * far, z - Math.cos(yaw) * far)) far += 0.2;
      if (far > best[1]) best = [yaw, far];
    }
    return best[0];
  }

  key(event, isDown) {
    const way = KEYS[event.code];
    if (!way) return;
    event.preventDefault();
    this.hold(way, isDown);
  }

  /** Go a way until it is let go. */
  hold(way, isHeld) {
    if (isHeld) this.held.add(way);
    else this.held.delete(way);
    if (this.held.size && !this.frame) {
      this.last = performance.now();
      this.frame = requestAnimationFrame((now) => this.step(now));
    }
  }

  look(event) {
    this.yaw += event.movementX * LOOK_PER_PX;
    this.pitch = Math.min(Math.max(this.pitch + event.movementY * LOOK_PER_PX, -1.2), 1.2);
    this.turn();
  }

  step(now) {
    const seconds = Math.min((now - this.last) / 1000, 0.1);
    this.last = now;
    const has = (way) => (this.held.has(way) ? 1 : 0);
    this.yaw += (has("left") - has("right")) * TURN_PER_S * seconds;
    const ahead = (has("ahead") - has("back")) * M_PER_S * seconds;
    const beside = (has("beside") - has("aside")) * M_PER_S * seconds;
    const [sin, cos] = [Math.sin(this.yaw), Math.cos(this.yaw)];
    this.go(-sin * ahead + cos * beside, -cos * ahead - sin * beside);
    this.turn();
    this.frame = this.held.size ? requestAnimationFrame((next) => this.step(next)) : 0;
  }

  /** Along the wall where one cannot go through it. */
  go(x, z) {
    const at = this.camera.position;
    if (this.canStand(at.x + x, at.z + z)) at.set(at.x + x, at.y, at.z + z);
    else if (this.canStand(at.x + x, at.z)) at.x += x;
    else if (this.canStand(at.x, at.z + z)) at.z += z;
  }

  canStand(x, z) {
    return this.floors.some((floor) => isInside(floor, [x, -z]));
  }

  turn() {
    this.camera.quaternion.setFromEuler(new THREE.Euler(this.pitch, this.yaw, 0, "YXZ"));
    this.draw();
  }

  stop() {
    cancelAnimationFrame(this.frame);
    for (const [node, name, act] of this.listeners) node.removeEventListener(name, act);
  }
}

/** Where one can stand in a plan: its floors, and the holes of doors and passages, in metres. */
export function floorsOf(plan) {
  const floors = roomFloors(plan);
  const holes = plan.windowsDoors
    .filter((opening) => opening.type !== "window")
    .map(({ pos, length, width, rotate }) => {
      const angle = (rotate * Math.PI) / 180;
      const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
      const [a, b] = [length / 2, width / 2 + 5];
      return [[-a, -b], [a, -b], [a, b], [-a, b]].map(([u, v]) => [
        (pos[0] + u * cos - v * sin) / 100,
        (pos[1] + u * sin + v * cos) / 100,
      ]);
    });
  return [...floors, ...holes];
}

/** The rooms of a plan as polygons, in metres. */
export const roomFloors = (plan) => roomsOf(plan).map((room) => room.wallPoints.map(([x, y]) => [x / 100, y / 100]));
