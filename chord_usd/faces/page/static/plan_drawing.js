// The plan over its picture, as an SVG in centimetres (y is turned over), to be dragged about.
import { svg } from "./dom.js";
import { areaM2, edgeOf, kindOf, middleOf, moveCorner, moveOpening, moveWall, roomsOf } from "./plan_model.js";

const MARGIN_CM = 60;
const STEP_CM = 5;
/** What lies round a place is seen so far, and a room with so much beside it. */
const AROUND_CM = 500;
const AROUND_SHARE = 1.6;

export class PlanDrawing {
  /**
   * edit: takes a change of the plan, (plan) => void; chosen: is told of what was clicked;
   * pointed: of places in cm, while a tool waits for them.
   */
  constructor({ edit, chosen, pointed, picture }) {
    Object.assign(this, { edit, chosen, pointed, picture });
    this.choice = null;
    this.tool = "";
    this.points = [];
    this.node = svg("svg", { role: "application", tabindex: 0, "aria-label": "The plan. Tab goes from piece to piece, arrow keys move what is chosen." });
    this.node.addEventListener("pointerdown", (event) => this.pressed(event));
    this.node.addEventListener("keydown", (event) => this.typed(event));
  }

  /** Draw a plan. drawing: where the picture lies, null for none. */
  draw(plan, drawing, doubted) {
    Object.assign(this, { plan, drawing, doubted });
    const parts = [];
    if (drawing && this.picture.naturalWidth) parts.push(this.pictureUnder());
    roomsOf(plan).forEach((room, number) => parts.push(...this.roomParts(room, number)));
    for (const opening of plan.windowsDoors) parts.push(this.openingPart(opening));
    for (const room of roomsOf(plan)) parts.push(...this.cornerParts(room), this.label(room));
    if (this.points.length) parts.push(this.measure());
    const focused = document.activeElement?.dataset?.key;
    this.node.replaceChildren(...parts);
    this.node.querySelector(focused ? `[data-key="${CSS.escape(focused)}"]` : "none")?.focus();
    if (!this.box) this.fit();
  }

  fit() {
    const points = this.plan.rooms.flatMap((room) => room.wallPoints);
    const [xs, ys] = [points.map(([x]) => x), points.map(([, y]) => -y)];
    const [left, top] = [Math.min(...xs) - MARGIN_CM, Math.min(...ys) - MARGIN_CM];
    this.box = [left, top, Math.max(...xs) + MARGIN_CM - left, Math.max(...ys) + MARGIN_CM - top];
    this.node.setAttribute("viewBox", this.box.join(" "));
  }

  /** Bring a room or an opening into the middle. */
  goTo(item) {
    const points = item.wallPoints ?? [item.pos];
    const sides = [points.map(([x]) => x), points.map(([, y]) => -y)].map((places) => {
      const [low, high] = [Math.min(...places), Math.max(...places)];
      const long = Math.max((high - low) * AROUND_SHARE, AROUND_CM);
      return [(low + high - long) / 2, long];
    });
    this.box = [sides[0][0], sides[1][0], sides[0][1], sides[1][1]];
    this.node.setAttribute("viewBox", this.box.join(" "));
  }

  /** How many centimetres a pixel of the screen is. */
  cmPerPx() {
    return 1 / (this.node.getScreenCTM()?.a || 1);
  }

  pictureUnder() {
    const cm = this.drawing.m_per_px * 100;
    const [x, y] = this.drawing.origin_m;
    return svg("image", {
      href: this.picture.src,
      x: x * 100,
      y: -(y * 100 + this.drawing.height_px * cm),
      width: this.picture.naturalWidth * cm,
      height: this.drawing.height_px * cm,
      preserveAspectRatio: "none",
      opacity: 0.75,
    });
  }

  classes(name, what) {
    const isChosen = this.choice?.item === what.item && (what.index ?? null) === (this.choice.index ?? null);
    const id = what.item.roomId ?? what.item.id;
    return `${name}${isChosen && what.type === this.choice.type ? " chosen" : ""}${this.doubted.has(id) ? " doubted" : ""}`;
  }

  roomParts(room, number) {
    const what = { type: "room", item: room };
    const points = room.wallPoints.map(([x, y]) => `${x},${-y}`).join(" ");
    const floor = svg("polygon", { points, class: this.classes("floor", what), tabindex: 0, role: "button", "aria-label": `Room ${number + 1}: ${room.roomName}`, "data-key": `r${room.roomId}` });
    floor.what = what;
    const walls = room.wallPoints.map((_, index) => {
      const { from, to } = edgeOf(room, index);
      const wall = { type: "wall", item: room, index };
      const line = svg("line", { x1: from[0], y1: -from[1], x2: to[0], y2: -to[1], class: this.classes("wall", wall), tabindex: 0, role: "button", "aria-label": `Wall ${index + 1} of ${room.roomName}`, "data-key": `w${room.roomId}/${index}` });
      line.what = wall;
      return line;
    });
    return [floor, ...walls];
  }

  cornerParts(room) {
    if (this.choice?.item !== room) return [];
    return room.wallPoints.map(([x, y], index) => {
      const what = { type: "corner", item: room, index };
      const dot = svg("circle", { cx: x, cy: -y, r: 7 * this.cmPerPx(), class: this.classes("corner", what), tabindex: 0, role: "button", "aria-label": `Corner ${index + 1} of ${room.roomName}`, "data-key": `c${room.roomId}/${index}` });
      dot.what = what;
      return dot;
    });
  }

  openingPart(opening) {
    const what = { type: "opening", item: opening };
    const [x, y] = opening.pos;
    const box = svg("rect", {
      x: -opening.length / 2, y: -opening.width / 2, width: opening.length, height: opening.width,
      transform: `translate(${x} ${-y}) rotate(${-opening.rotate})`,
      class: this.classes(`opening ${opening.type}`, what), tabindex: 0, role: "button",
      "aria-label": `${opening.type} ${opening.id}`, "data-key": `o${opening.id}`,
    });
    box.what = what;
    return box;
  }

  label(room) {
    const [x, y] = middleOf(room);
    const size = Math.max(13 * this.cmPerPx(), 8);
    const text = svg("text", { x, y: -y, "font-size": size });
    const kind = kindOf(room);
    const name = room.roomName === kind ? kind : `${room.roomName} (${kind})`;
    text.append(
      svg("tspan", { x }, kind === "unknown" ? "not known" : name),
      svg("tspan", { x, dy: "1.1em" }, `${areaM2(room).toFixed(1)} m²`),
    );
    return text;
  }

  measure() {
    const [a, b = a] = this.points;
    return svg("line", { class: "measure", x1: a[0], y1: -a[1], x2: b[0], y2: -b[1] });
  }

  /** The place in cm under a pointer. */
  placeOf(event) {
    const place = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.node.getScreenCTM().inverse());
    return [place.x, -place.y];
  }

  pressed(event) {
    if (event.button) return;
    const place = this.placeOf(event);
    const what = event.target.what;
    if (this.tool) {
      event.preventDefault();
      this.pointed(place, what);
      return;
    }
    this.chosen(what ?? null);
    if (!what || what.type === "room") this.panFrom(event);
    else this.dragFrom(place, what, event);
  }

  dragFrom(start, what, event) {
    const before = structuredClone(this.plan);
    const where = whereIn(this.plan, what);
    this.followPointer(event, (place) => {
      // Each step begins anew from what was, so that rounding does not add up.
      const plan = structuredClone(before);
      moveIn(plan, where, place, [place[0] - start[0], place[1] - start[1]]);
      this.edit(plan, { isStep: true, before });
    }, () => this.edit(null, { isDone: true, before }));
  }

  panFrom(event) {
    const [x, y] = [event.clientX, event.clientY];
    const [left, top, width, height] = this.box;
    const cm = this.cmPerPx();
    this.followPointer(event, (_place, move) => {
      this.box = [left - (move.clientX - x) * cm, top - (move.clientY - y) * cm, width, height];
      this.node.setAttribute("viewBox", this.box.join(" "));
    });
  }

  followPointer(event, step, done = () => {}) {
    event.preventDefault();
    let isMoved = false;
    const move = (next) => {
      if (next.pointerId !== event.pointerId) return;
      isMoved ||= Math.hypot(next.clientX - event.clientX, next.clientY - event.clientY) > 3;
      if (isMoved) step(this.placeOf(next), next);
    };
    const end = (next) => {
      if (next.pointerId !== event.pointerId) return;
      for (const name of ["pointermove", "pointerup", "pointercancel"]) {
        removeEventListener(name, name === "pointermove" ? move : end);
      }
      if (isMoved) done();
    };
    addEventListener("pointermove", move);
    addEventListener("pointerup", end);
    addEventListener("pointercancel", end);
  }

  zoom(factor) {
    const [left, top, width, height] = this.box;
    this.box = [left + (width * (1 - factor)) / 2, top + (height * (1 - factor)) / 2, width * factor, height * factor];
    this.node.setAttribute("viewBox", this.box.join(" "));
    this.draw(this.plan, this.drawing, this.doubted);
  }

  typed(event) {
    const what = event.target.what;
    if (!what) return;
    if (event.key === "Enter" || event.key === " ") {
      this.chosen(what);
      event.preventDefault();
    }
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (way && what.type !== "room") {
      event.preventDefault();
      const by = way.map((x) => x * (event.shiftKey ? 1 : STEP_CM));
      const plan = structuredClone(this.plan);
      const where = whereIn(this.plan, what);
      const from = what.type === "corner" ? what.item.wallPoints[what.index] : what.item.pos ?? [0, 0];
      moveIn(plan, where, [from[0] + by[0], from[1] + by[1]], by);
      this.edit(plan);
    }
  }
}

/** Where something is, so that it is found in a copy of its plan. */
function whereIn(plan, { type, item, index }) {
  const list = type === "opening" ? "windowsDoors" : "rooms";
  return { type, list, at: plan[list].indexOf(item), index };
}

function moveIn(plan, { type, list, at, index }, place, by) {
  const item = plan[list][at];
  if (type === "wall") moveWall(plan, item, index, by);
  else if (type === "corner") moveCorner(item, index, place);
  else moveOpening(item, place);
}

