// The furnished house: to look at, to walk through, and to change piece by piece.
import { file, get, post } from "./api.js";
import { boxOf, show } from "./batches.js";
import { button, check, choice, complain, el, field } from "./dom.js";
import { Collisions } from "./collisions.js";
import { Edits } from "./edits.js";
import { SceneView } from "./scene_view.js";
import { Swaps } from "./swaps.js";
import { THREE } from "./three.js";
import { floorsOf, roomFloors } from "./walker.js";

const STEP_M = 0.05;
const FINE_M = 0.01;
const TURN_DEG = 15;
const HIGHEST_M = 3;
const WORDS = (text) => text.replaceAll("_", " ");

/** Polygons of a storey's plan where the storey lies in the house. */
const shifted = (polygons, { shift_m: [x, y] }) => polygons.map((one) => one.map((point) => [point[0] + x, point[1] + y]));

export async function houseTab(app) {
  const tab = new HouseTab(app);
  app.left = () => tab.end();
  app.seen = () => tab.seen();
  tab.load().catch((error) => {
    tab.wait.textContent = "";
    complain(error);
  });
  return tab.node;
}

class HouseTab {
  constructor(app) {
    this.app = app;
    this.version = app.version();
    this.canvas = el("canvas", { tabindex: 0, role: "application", "aria-label": "The house. Click a piece and drag it; arrow keys move it, R turns it, Delete removes it." });
    this.wait = el("div", { class: "wait" }, "The house is loading …");
    this.area = el("div", { class: "stagearea" }, this.canvas, this.wait);
    this.side = el("aside", { class: "side stack", "aria-label": "Rooms and pieces" });
    this.node = el("div", { class: "split" }, this.area, this.side);
    this.canvas.addEventListener("keydown", (event) => this.typed(event));
  }

  async load() {
    const { house } = this.app;
    const version = this.version.number;
    this.view = new SceneView(this.canvas, { picked: (piece) => this.choose(piece), held: (piece) => this.hold(piece) });
    const known = this.version.storeys ?? [{ house: house.id, plan: this.version.plan, name: "", elevation_m: 0, shift_m: [0, 0] }];
    const [loaded, ...plans] = await Promise.all([
      this.view.load(file(house.id, version, ...(this.version.view ?? "view/view.glb").split("/"))),
      ...known.map((one) => get(`/api/houses/${one.house}/plan?number=${one.plan}`)),
    ]);
    this.house = loaded;
    this.roof = [...loaded.pieces.values()].find((one) => one.category === "roof");
    this.storeys = known.map((one, at) => ({ ...one, plan: plans[at].plan }));
    this.top = this.storeys.length - 1;
    const floors = this.storeys.map((one) => shifted(roomFloors(one.plan), one));
    this.collisions = new Collisions(this.house, (piece) => floors[piece.storey] ?? floors[0], (piece) => this.edits.isGone(piece));
    this.swaps = new Swaps(this);
    this.edits = new Edits(`/api/houses/${house.id}/versions/${version}/edits`, this.house, {
      changed: () => this.refresh(),
      dressed: (piece, swap) => this.swaps.show(piece, swap).catch(complain),
      saved: () => this.app.refresh(),
    });
    await this.edits.load();
    this.hideCeilings(true);
    this.wait.remove();
    this.area.append(this.tools());
    this.lookAsBefore();
    this.refresh();
    this.canvas.dataset.ready = "1";
    this.showTarget();
  }

  /** Another state of the same house is seen from where the one before it was. */
  lookAsBefore() {
    const before = this.app.lookedAt;
    if (before?.id !== this.app.house.id) return;
    this.view.camera.position.copy(before.from);
    this.view.controls.target.copy(before.to);
    this.view.controls.update();
    this.room = this.house.rooms.some((one) => one.name === before.room) ? before.room : undefined;
    this.chosen = this.house.pieces.get(before.path) ?? null;
  }

  /** Undo, redo, or go to a change of the history. */
  async putBack(way, to) {
    const { house } = this.app;
    await this.edits.save();
    await post(`/api/houses/${house.id}/versions/${this.version.number}/past`, { way, to });
    await this.app.refresh();
    // Where the view is another one, the house is loaded again.
    if ((this.app.version()?.view ?? "") === (this.version.view ?? "")) await this.edits.reload();
  }

  pastForm() {
    const { past } = this.app.house;
    const step = (text, way) => {
      const node = button(text, () => this.putBack(way), { title: past[way] ?? "" });
      node.disabled = !past[way] && !(way === "undo" && this.edits.isUnsaved);
      return node;
    };
    const rows = [...past.changes].reverse().map((one) => el("li", {}, one.number === past.number
      ? `${one.told} (now)` : button(one.told, () => this.putBack("to", one.number), { title: one.made })));
    return [
      el("div", { class: "row" }, step("Undo", "undo"), step("Redo", "redo"), el("span", { class: "quiet" }, this.version.label)),
      el("p", { class: "wrong", hidden: !past.error }, past.error),
      el("details", { hidden: !rows.length, id: "past" }, el("summary", {}, `History: ${rows.length}`), el("ol", { class: "list" }, ...rows)),
    ];
  }

  /** What another tab asked to see. */
  showTarget() {
    const paths = this.app.target?.paths;
    this.app.target = null;
    if (!paths) return;
    const found = paths.map((path) => this.pieceAt(path)).filter(Boolean);
    if (!found.length) return;
    const box = new THREE.Box3();
    for (const piece of found) box.union(boxOf(piece));
    this.choose(found[0]);
    this.view.frame(box);
  }

  /** The piece of a path, or that it is part of; of a room, its floor. */
  pieceAt(path) {
    for (let at = path; at.length > 1; at = at.slice(0, at.lastIndexOf("/"))) {
      if (this.house.pieces.has(at)) return this.house.pieces.get(at);
    }
    return [...this.house.pieces.values()].find((one) => one.path.startsWith(`${path}/`));
  }

  tools() {
    const cut = el("input", { type: "range", min: 0.3, max: HIGHEST_M, step: "any", value: HIGHEST_M, "aria-label": "Cut the house at a height" });
    this.cutHouse = () => this.view.cutAt(Number(cut.value) >= HIGHEST_M ? 100 : this.storeys[this.top].elevation_m + Number(cut.value));
    cut.addEventListener("input", this.cutHouse);
    this.walkButton = button("Walk", () => this.walk(), { "aria-pressed": false });
    const ceilings = check("Ceilings", false, (isShown) => this.hideCeilings(!isShown));
    this.ceilings = ceilings.querySelector("input");
    const roof = check("Roof", false, (isShown) => this.showRoof(isShown));
    return el("div", { class: "tools", role: "toolbar", "aria-label": "View" },
      button("All", () => this.walk(false)), this.walkButton,
      el("label", { class: "check" }, "Cut", cut), ceilings, ...(this.roof ? [roof] : []), ...this.storeyChoice());
  }

  /** Up to which storey the house is shown. */
  storeyChoice() {
    if (this.storeys.length < 2) return [];
    const last = this.storeys.length - 1;
    const names = this.storeys.map((one, at) => [at, at === last ? "All storeys" : `Up to: ${one.name}`]);
    const list = choice(names.reverse(), this.top, (at) => {
      this.top = Number(at);
      this.cutHouse();
      if (this.view.walker) this.walk(true).catch(complain);
      else this.hideCeilings(!this.ceilings.checked);
    });
    list.id = "storey";
    list.setAttribute("aria-label", "Show the house up to a storey");
    return [list];
  }

  hideStoreys() {
    for (const piece of this.house.pieces.values()) {
      const isShown = piece.storey <= this.top && !this.edits.isGone(piece);
      for (const { batch, id } of piece.parts) batch.setVisibleAt(id, isShown);
    }
  }

  hideCeilings(isHidden) {
    if (this.storeys.length > 1) this.hideStoreys();
    for (const piece of this.house.pieces.values()) {
      if (piece.storey > this.top) continue;
      // Below another storey the ceiling is under that one's floor.
      const isShown = !isHidden || piece.storey < this.top;
      if (piece.category === "ceiling") show(this.house.pieces, piece, isShown);
      // Lamps that hang from nothing look odd from above.
      if (piece.category === "ceiling_lamp" && !this.edits.isGone(piece)) show(this.house.pieces, piece, isShown);
    }
    if (this.roof) show(this.house.pieces, this.roof, Boolean(this.isRoofWanted) && this.top === this.storeys.length - 1);
    this.areCeilingsHidden = isHidden;
    this.view.draw();
  }

  showRoof(isShown) {
    this.isRoofWanted = isShown;
    this.hideCeilings(this.areCeilingsHidden);
  }

  async walk(isOn = !this.view.walker) {
    this.walkButton.setAttribute("aria-pressed", isOn);
    this.pad?.remove();
    if (!isOn) {
      this.hideCeilings(!this.ceilings.checked);
      this.view.overview();
      return;
    }
    this.hideCeilings(false);
    const storey = this.storeys[this.top];
    const floors = shifted(floorsOf(storey.plan), storey);
    const [points] = floors;
    const start = [0, 1].map((axis) => points.reduce((sum, point) => sum + point[axis], 0) / points.length);
    this.view.walk(floors, start, storey.elevation_m);
    this.pad = this.walkPad();
    this.area.append(this.pad);
    this.canvas.focus();
  }

  /** For fingers: a keyboard has the arrow keys. */
  walkPad() {
    const hold = (text, way, name) => {
      const node = el("button", { type: "button", "aria-label": name }, text);
      node.addEventListener("pointerdown", () => this.view.walker?.hold(way, true));
      for (const end of ["pointerup", "pointerleave", "pointercancel"]) {
        node.addEventListener(end, () => this.view.walker?.hold(way, false));
      }
      return node;
    };
    return el("div", { class: "tools below", id: "pad" },
      hold("↰", "left", "Turn left"), hold("↑", "ahead", "Go ahead"), hold("↓", "back", "Go back"), hold("↱", "right", "Turn right"));
  }

  choose(piece) {
    const isFixed = piece?.group === "Architecture";
    this.chosen = isFixed || !piece ? null : piece;
    this.room = piece?.room || this.room;
    this.refresh();
    if (piece) this.side.scrollTop = 0;
  }

  /** Drag the chosen piece, also by what lies on it; others turn the house, as the floor does. */
  hold(piece) {
    const { chosen } = this;
    if (!chosen || this.edits.isGone(chosen)) return null;
    if (piece !== chosen && piece.above !== chosen && !this.edits.restingOn(chosen).includes(piece)) return null;
    const drag = this.edits.drag(chosen);
    return {
      to: (by) => {
        drag.to(by);
        this.mark();
      },
      end: drag.end,
    };
  }

  mark() {
    const piece = this.chosen && !this.edits.isGone(this.chosen) ? this.chosen : null;
    const met = piece ? this.collisions.of(piece) : new Set();
    this.view.mark(piece, piece ? this.collisions.footprint(piece) : [], met.size > 0);
    return met;
  }

  /** The last sentence that was said, as a job. */
  lastSaid() {
    return this.app.house.jobs.filter((job) => job.kind === "say").at(-1);
  }

  seen() {
    const { past } = this.app.house;
    if (this.edits && JSON.stringify(past) !== this.shownPast) this.refresh();
    const state = this.lastSaid()?.state;
    if (state === this.said || !this.canvas.dataset.ready) return;
    this.said = state;
    if (state === "failed" || this.lastSaid()?.answer?.answer) this.refresh();
  }

  refresh() {
    this.met = this.mark();
    if (this.areCeilingsHidden) this.hideCeilings(true);
    this.shownPast = JSON.stringify(this.app.house.past);
    this.side.replaceChildren(
      ...this.pastForm(),
      ...(this.app.choices.canSay && this.storeys.length === 1 ? [this.sentenceForm()] : []),
      this.chosen ? this.pieceForm(this.chosen) : el("p", { class: "quiet" }, "Click a piece to change it; then drag it."),
      this.roomForm(),
      ...this.lists(),
    );
  }

  /** A change in words: carried out whole, or refused with a reason. */
  sentenceForm() {
    const sentence = el("input", { placeholder: "put a plant in bedroom 1", maxlength: 500, value: this.sentence ?? "", "aria-label": "Change in words" });
    sentence.addEventListener("input", () => { this.sentence = sentence.value; });
    const say = (more) => this.edits.save()
      .then(() => this.app.start("say", { version: this.version.number, sentence: sentence.value, ...more }))
      .catch(complain);
    const last = this.lastSaid();
    const isWorse = last?.state === "failed" && last.code === "worse" && last.given.sentence === sentence.value;
    const form = el("form", { class: "row" }, sentence, el("button", { type: "submit" }, "Change it"),
      ...(isWorse ? [button("Do it all the same", () => say({ force: 1 }))] : []),
      ...(last?.answer?.answer ? [el("p", { role: "status" }, last.answer.answer)] : []));
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      if (sentence.value.trim()) say({});
    });
    return form;
  }

  pieceForm(piece) {
    const size = boxOf(piece, true).getSize(new THREE.Vector3());
    const told = [size.x, size.y, size.z].map((side) => side.toFixed(2)).join(" × ");
    const move = (text, way, name) => button(text, () => this.edits.move(piece, way), { "aria-label": name });
    const turn = (text, angle, name) => button(text, () => this.edits.move(piece, [0, 0], angle), { "aria-label": name });
    return el("section", { class: "card stack", id: "piece" },
      el("h2", {}, `${WORDS(piece.category)} (${piece.name})`),
      el("p", { class: "quiet" }, `${told} m, in ${piece.room}. Drag it, or:`),
      el("p", { class: "wrong", role: "status", hidden: !this.met.size }, `Stands in: ${[...this.met].map(WORDS).join(", ")}`),
      el("div", { class: "row", role: "group", "aria-label": "Move" },
        move("←", [-STEP_M, 0], "Left"), move("→", [STEP_M, 0], "Right"), move("↑", [0, STEP_M], "Up, in the plan"), move("↓", [0, -STEP_M], "Down, in the plan"),
        turn("↺", TURN_DEG, "Turn left"), turn("↻", -TURN_DEG, "Turn right")),
      check("Locked: stays when the room is furnished again", this.edits.isLocked(piece), (isLocked) => this.edits.lock(piece, isLocked)),
      el("div", { class: "row" }, button("Delete", () => this.remove(piece)), button("Look at it", () => this.view.frame(boxOf(piece)))),
      ...this.swaps.form(piece).filter(Boolean));
  }

  remove(piece) {
    this.chosen = null;
    this.edits.remove(piece);
  }

  roomForm() {
    const called = (room) => (room.title && room.title !== room.name ? room.title : WORDS(room.kind));
    const rooms = this.house.rooms.map((room) => [room.name, `${called(room)} (${room.name})`]);
    this.room ??= rooms[0]?.[0];
    const list = choice(rooms, this.room, (name) => {
      this.room = name;
      this.refresh();
    });
    const asked = this.house.rooms.find((room) => room.name === this.room)?.requests;
    const wish = el("input", { placeholder: "desk, two chairs", maxlength: 500 });
    const without = el("input", { placeholder: "sofa", maxlength: 500 });
    return el("section", { class: "card stack" },
      el("h2", {}, "Room"), list,
      el("p", { class: "quiet", id: "asked", hidden: !asked }, `Asked for: ${asked}. It stays so until you ask otherwise.`),
      el("div", { class: "row" }, field("With", wish), field("Without", without)),
      button("Furnish this room again", async () => {
        await this.edits.save();
        const keep = this.edits.state.locked.filter((path) => path.includes(`/${this.room}/`)).map((path) => /\/(?:Furniture|Dressing)\/(\w+)/.exec(path)[1]);
        await this.app.start("refurnish", { version: this.version.number, room: this.room, with: wish.value, without: without.value, keep });
      }));
  }

  /** All that stands in the room, for keyboards and for what hides behind something. */
  lists() {
    const own = [...this.house.pieces.values()].filter((one) => one.room === this.room && one.group !== "Architecture" && one.category);
    return ["Furniture", "Items", "Dressing"].map((group) => {
      const rows = own.filter((one) => one.group === group).map((piece) =>
        el("li", {}, button(`${WORDS(piece.category)}${this.edits.isGone(piece) ? " (deleted)" : ""}`, () => {
          this.choose(piece);
          this.view.frame(boxOf(piece));
        }, { "data-path": piece.path })));
      const name = { Furniture: "Furniture", Items: "On tables", Dressing: "Dressing" }[group];
      return el("details", { hidden: !rows.length }, el("summary", {}, `${name}: ${rows.length}`), el("ul", { class: "list" }, ...rows));
    });
  }

  typed(event) {
    if (!this.edits || this.view.walker) return;
    if (event.key.toLowerCase() === "z" && (event.ctrlKey || event.metaKey)) {
      this.putBack(event.shiftKey ? "redo" : "undo").catch(complain);
      return;
    }
    const piece = this.chosen;
    if (!piece) return;
    const step = event.shiftKey ? FINE_M : STEP_M;
    const way = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, step], ArrowDown: [0, -step] }[event.key];
    if (way) this.edits.move(piece, way);
    else if (event.key.toLowerCase() === "r") this.edits.move(piece, [0, 0], event.shiftKey ? -TURN_DEG : TURN_DEG);
    else if (event.key === "Delete") this.remove(piece);
    else if (event.key === "Escape") this.choose(null);
    else return;
    event.preventDefault();
  }

  end() {
    this.edits?.save().catch(complain);
    if (this.house) {
      const [from, to] = [this.view.camera.position.clone(), this.view.controls.target.clone()];
      this.app.lookedAt = { id: this.app.house?.id, from, to, room: this.room, path: this.chosen?.path };
    }
    this.view?.end();
  }
}
