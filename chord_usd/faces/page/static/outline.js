// Drawing the outer walls of a home: a corner at each click, in line with the others.
import { button, el, field, svg } from "./dom.js";

/** Corners lie on a grid of so much, and in line with the last or the first where they nearly are. */
const GRID_CM = 10;
const SNAP_PX = 12;
const TEXT_PX = 13;
const WIDTH_CM = 2000;
const HEIGHT_CM = 1400;
const LEAST_M2 = 10;

/** A drawing board. done: takes the corners [[x, y]] in cm, y up, counter-clockwise. */
export class Outline {
  constructor(done) {
    this.done = done;
    this.corners = [];
    this.isClosed = false;
    this.board = svg("svg", { viewBox: `0 0 ${WIDTH_CM} ${HEIGHT_CM}`, class: "board", role: "img", "aria-label": "The outline" });
    this.board.addEventListener("pointerdown", (event) => this.pressed(event));
    this.board.addEventListener("pointermove", (event) => this.draw(this.placeOf(event)));
    this.board.addEventListener("pointerleave", () => this.draw());
    this.told = el("p", { role: "status", class: "quiet" });
    const size = (name, value) => el("input", { type: "number", min: 3, max: 19, step: 0.1, value, "aria-label": name });
    const [wide, deep] = [size("Width, in metres", 10), size("Depth, in metres", 8)];
    this.back = button("Take a corner back", () => this.takeBack());
    this.go = button("Go on", () => this.done(this.corners.map(([x, y]) => [x, HEIGHT_CM - y])), { class: "first" });
    this.node = el("div", { class: "page outline" },
      el("h2", {}, "Draw the outline"), this.told, this.board,
      el("div", { class: "row" }, this.back, this.go,
        field("Or a rectangle, metres", el("span", { class: "row" }, wide, deep)),
        button("Draw it", () => this.rectangle(Number(wide.value) * 100, Number(deep.value) * 100))));
    this.draw();
  }

  placeOf(event) {
    const frame = this.board.getScreenCTM();
    const { x, y } = new DOMPoint(event.clientX, event.clientY).matrixTransform(frame.inverse());
    const near = SNAP_PX / frame.a;
    const beside = [this.corners.at(-1), this.corners[0]].filter(Boolean);
    return [x, y].map((value, axis) => {
      const line = beside.find((corner) => Math.abs(corner[axis] - value) < near);
      return line ? line[axis] : Math.round(value / GRID_CM) * GRID_CM;
    });
  }

  pressed(event) {
    if (event.button) return;
    if (this.isClosed) return;
    const place = this.placeOf(event);
    const [first] = this.corners;
    if (this.corners.length > 2 && place[0] === first[0] && place[1] === first[1]) this.isClosed = true;
    else if (String(place) !== String(this.corners.at(-1))) this.corners.push(place);
    this.draw();
  }

  takeBack() {
    if (this.isClosed) this.isClosed = false;
    else this.corners.pop();
    this.draw();
  }

  rectangle(wide, deep) {
    if (!(wide >= 300 && deep >= 300 && wide < WIDTH_CM && deep < HEIGHT_CM)) throw new Error("3 to 19 metres wide and 3 to 13 metres deep, please.");
    const [left, top] = [Math.round((WIDTH_CM - wide) / 2), Math.round((HEIGHT_CM - deep) / 2)];
    this.corners = [[left, top], [left + wide, top], [left + wide, top + deep], [left, top + deep]];
    this.isClosed = true;
    this.draw();
  }

  /** next: where the next corner would be. */
  draw(next = null) {
    const open = this.isClosed || !next ? this.corners : [...this.corners, next];
    const ends = this.isClosed ? [...open, open[0]] : open;
    const parts = [...grid()];
    if (open.length) parts.push(svg(this.isClosed ? "polygon" : "polyline", { points: open.map(String).join(" "), class: "walls" }));
    const size = TEXT_PX / (this.board.getScreenCTM()?.a || 0.3);
    for (let at = 0; at + 1 < ends.length; at += 1) parts.push(length(ends[at], ends[at + 1], size));
    this.corners.forEach(([x, y], at) => parts.push(svg("circle", { cx: x, cy: y, r: at ? 9 : 16, class: "corner" })));
    this.board.replaceChildren(...parts);
    const area = areaM2(this.corners);
    this.told.textContent = this.isClosed
      ? `${area.toFixed(1)} m² within the walls.`
      : this.corners.length > 2 ? "Click the first corner to close the outline." : "Click where the corners of the outer walls are; a square of the grid is a metre.";
    this.back.disabled = !this.corners.length;
    this.go.disabled = !this.isClosed || area < LEAST_M2;
  }
}

function* grid() {
  for (let x = 0; x <= WIDTH_CM; x += 100) yield svg("line", { x1: x, x2: x, y1: 0, y2: HEIGHT_CM, class: "grid" });
  for (let y = 0; y <= HEIGHT_CM; y += 100) yield svg("line", { x1: 0, x2: WIDTH_CM, y1: y, y2: y, class: "grid" });
}

function length([x1, y1], [x2, y2], size) {
  const text = svg("text", { x: (x1 + x2) / 2, y: (y1 + y2) / 2, "font-size": size });
  text.textContent = `${(Math.hypot(x2 - x1, y2 - y1) / 100).toFixed(1)} m`;
  return text;
}

function areaM2(corners) {
  const twice = corners.reduce((sum, [x, y], at) => {
    const [nextX, nextY] = corners[(at + 1) % corners.length];
    return sum + x * nextY - nextX * y;
  }, 0);
  return Math.abs(twice) / 2e4;
}

/** A plan, CHOrD JSON, whose one room is all that lies within the corners. */
export function openPlan(corners) {
  const room = { roomId: "room1", roomName: "living", roomType: 1, wallPoints: corners };
  return { rooms: [room], windowsDoors: [] };
}
