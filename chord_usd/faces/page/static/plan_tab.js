// The reading over the picture: what is doubted, how to put it right, and "Furnish".
import { ask, get, job, oneAtATime } from "./api.js";
import { button, choice, complain, el, field, optionInput } from "./dom.js";
import { addStorey } from "./home.js";
import { PlanDrawing } from "./plan_drawing.js";
import * as model from "./plan_model.js";

const SAVE_AFTER_MS = 500;
const MOST_UNDONE = 100;

const VERDICTS = {
  right: "The reading is probably right.",
  look: "Look at what is red.",
  wrong: "The reading is probably wrong.",
};

const HINTS = {
  scale: "Click the two ends of something whose length you know.",
  door: "Click the wall where the door is.",
  window: "Click the wall where the window is.",
  passage: "Click the wall where the passage is.",
  split: "Click a wall where a new wall meets it.",
  join: "Click the wall between two rooms that are one.",
};

export async function planTab(app) {
  const tab = new PlanTab(app);
  app.left = () => tab.save();
  app.seen = (house) => tab.seen(house);
  await tab.load();
  return tab.node;
}

class PlanTab {
  constructor(app) {
    this.app = app;
    this.number = 0;
    this.done = [];
    this.undone = [];
    this.visits = {};
    this.sendInTurn = oneAtATime(() => this.send());
    this.picture = new Image();
    this.area = el("div", { class: "stagearea" });
    this.side = el("aside", { class: "side stack", "aria-label": "Corrections" });
    this.node = el("div", { class: "split" }, this.area, this.side);
    this.wishes = Object.fromEntries(app.choices.options.map((option) => [option.name, option.default]));
    this.drawing = new PlanDrawing({
      picture: this.picture,
      edit: (plan, how) => this.edited(plan, how),
      chosen: (what) => this.choose(what),
      pointed: (place, what) => this.pointed(place, what),
    });
  }

  async load() {
    const { house } = this.app;
    if (!house.plan) {
      this.area.replaceChildren(el("div", { class: "wait" }, this.waiting(house)));
      this.side.replaceChildren(...this.storeyForm(), this.furnishForm());
      return;
    }
    const { number, plan } = await get(`/api/houses/${house.id}/plan`);
    Object.assign(this, { number, plan, frame: structuredClone(house.drawing) });
    if (this.frame) {
      this.picture.src = `/api/houses/${house.id}/drawing.png`;
      await this.picture.decode().catch(() => {});
    }
    this.area.replaceChildren(this.tools(), this.drawing.node);
    this.area.classList.add("under");
    this.drawing.box = null;
    this.show();
    // Letters and corners are so many pixels high, which is known once it is on the page.
    requestAnimationFrame(() => this.show());
  }

  waiting(house) {
    const failed = house.jobs.findLast((job) => job.kind === "read" && job.state === "failed");
    return failed
      ? el("p", { class: "wrong" }, failed.error)
      : el("p", { class: "quiet" }, "The plan is being read …");
  }

  seen(house) {
    // A plan that was read just now, or anew; corrections of ours have the same number.
    if (house.plan > this.number) this.load().catch(complain);
    else if (!house.plan) this.area.firstChild?.replaceChildren?.(this.waiting(house));
  }

  show() {
    this.drawing.choice = this.choice;
    this.drawing.draw(this.plan, this.frame, model.doubtedIds(this.app.house.reading));
    this.side.replaceChildren(...this.panel().filter(Boolean));
    this.undo.disabled = !this.done.length;
    this.redo.disabled = !this.undone.length;
  }

  tools() {
    const tool = (name, text) =>
      button(text, () => this.use(this.drawing.tool === name ? "" : name), { "data-tool": name });
    this.undo = button("Undo", () => this.back(), { title: "Ctrl+Z" });
    this.redo = button("Redo", () => this.forth());
    this.area.onkeydown = (event) => {
      if (event.key === "z" && (event.ctrlKey || event.metaKey)) {
        event.preventDefault();
        if (event.shiftKey) this.forth();
        else this.back();
      } else if (event.key === "Delete" && this.choice) this.remove();
      else if (event.key === "Escape") this.use("");
    };
    return el(
      "div", { class: "tools", role: "toolbar", "aria-label": "Tools" },
      this.undo, this.redo,
      tool("door", "+ Door"), tool("window", "+ Window"), tool("passage", "+ Passage"),
      tool("split", "+ Wall"), tool("join", "− Wall"), tool("scale", "Scale"),
      button("+", () => this.drawing.zoom(0.8), { "aria-label": "Nearer" }),
      button("−", () => this.drawing.zoom(1.25), { "aria-label": "Farther" }),
    );
  }

  use(tool) {
    this.drawing.tool = tool;
    this.drawing.points = [];
    for (const node of this.area.querySelectorAll("[data-tool]")) {
      node.setAttribute("aria-pressed", node.dataset.tool === tool);
    }
    this.show();
  }

  pointed(place, what) {
    const { tool } = this.drawing;
    if (tool === "scale") {
      this.drawing.points = [...this.drawing.points, place].slice(-2);
      this.show();
      return;
    }
    if (what?.type !== "wall") {
      complain("That is no wall.");
      return;
    }
    complain();
    this.edited(this.changed((plan) => {
      const room = plan.rooms[this.plan.rooms.indexOf(what.item)];
      if (tool === "split") {
        if (!model.splitRoom(plan, room, what.index, place)) complain("There is no room for a wall.");
      } else if (tool === "join") {
        if (!model.joinRooms(plan, room, what.index, place)) complain("No other room lies beyond this wall.");
      } else model.addOpening(plan, room, what.index, place, tool);
    }));
    this.use("");
  }

  choose(what) {
    this.choice = what;
    this.show();
  }

  changed(change) {
    const plan = model.copy(this.plan);
    change(plan);
    return plan;
  }

  /** Take in a change. isStep: of a drag that goes on; isDone: the drag is over. */
  edited(plan, { isStep = false, isDone = false, before = this.plan, frame = this.frame } = {}) {
    if (!isStep) {
      this.done = [...this.done, { plan: before, frame: this.frame }].slice(-MOST_UNDONE);
      this.undone = [];
    }
    if (!isDone) this.replace(plan, frame);
    else this.show();
    if (!isStep) this.saveSoon();
  }

  /** Show another plan, with the same things chosen in it. */
  replace(plan, frame) {
    if (this.choice) {
      const list = this.choice.type === "opening" ? "windowsDoors" : "rooms";
      const item = plan[list][this.plan[list].indexOf(this.choice.item)];
      this.choice = item ? { ...this.choice, item } : null;
    }
    this.plan = plan;
    this.frame = frame;
    this.show();
  }

  back() {
    this.step(this.done, this.undone);
  }

  forth() {
    this.step(this.undone, this.done);
  }

  step(from, to) {
    const state = from.pop();
    if (!state) return;
    to.push({ plan: this.plan, frame: this.frame });
    this.choice = null;
    this.replace(state.plan, state.frame);
    this.saveSoon();
  }

  saveSoon() {
    this.isUnsaved = true;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.save().catch(complain), SAVE_AFTER_MS);
  }

  save() {
    clearTimeout(this.timer);
    return this.sendInTurn();
  }

  async send() {
    if (!this.isUnsaved) return;
    this.isUnsaved = false;
    const { id } = this.app.house;
    const body = { base: this.number, plan: this.plan, drawing: this.frame };
    try {
      this.number = (await ask("PUT", `/api/houses/${id}/plan`, body)).number;
    } catch (error) {
      this.isUnsaved = error.status !== 409;
      throw error;
    }
  }

  panel() {
    if (this.drawing.tool === "scale" && this.drawing.points.length === 2) return [this.scaleForm()];
    if (this.drawing.tool) return [el("p", {}, HINTS[this.drawing.tool])];
    const chosen = this.choice ? [this.choiceForm()] : [];
    const divide = model.roomsOf(this.plan).length === 1 ? [this.divideForm()] : [];
    return [...this.storeyForm(), ...chosen, ...divide, this.furnishForm(), this.doubts(), this.roomList()];
  }

  /** Which storey's plan is seen, and a further one above. */
  storeyForm() {
    const { house } = this.app;
    const storeys = house.storeys ?? [];
    const go = (id) => { location.hash = `#/${id}/plan`; };
    const rows = storeys.length > 1
      ? [el("div", { id: "storeys" }, field("Storey", choice(storeys.map(({ id, name }, at) => [id, `${at + 1}: ${name}`]), house.id, go)))]
      : [];
    const ground = storeys[0]?.id ?? house.id;
    const picker = el("input", {
      type: "file", hidden: true, accept: this.app.choices.suffixes.join(), "aria-label": "Plan of the storey above",
      onchange: () => picker.files[0] && addStorey(ground, picker.files[0]).then(({ id }) => go(id)).catch(complain),
    });
    const part = el("input", { type: "number", min: 1, max: 1000, value: storeys.length + 1, "aria-label": "Which plan of the file" });
    const own = house.source ? [part, button("Part of this file", async () => go((await addStorey(ground, Number(part.value))).id))] : [];
    return [...rows, el("details", {}, el("summary", {}, "Add the storey above"),
      el("div", { class: "row" }, button("A file", () => picker.click()), picker, ...own))];
  }

  /** Outer walls without rooms: what may be drawn by hand, or in a picture. */
  divideForm() {
    const text = el("input", { placeholder: "two bedrooms, open kitchen", maxlength: 2000, value: this.rooms ?? "" });
    text.addEventListener("input", () => { this.rooms = text.value; });
    return el("section", { class: "card stack", id: "divide" },
      el("h2", {}, "Divide it into rooms"),
      el("p", { class: "quiet" }, "First put the windows and the front door where they are: rooms are laid out behind them."),
      field("Which rooms", text),
      button("Divide", async () => {
        await this.save();
        await this.app.start("divide", { text: text.value, seed: Number(this.wishes.seed) || 0 });
      }, { class: "first" }));
  }

  scaleForm() {
    const [a, b] = this.drawing.points;
    const measured = Math.hypot(a[0] - b[0], a[1] - b[1]) / 100;
    const input = el("input", { type: "number", min: 0.01, step: 0.01, value: measured.toFixed(2) });
    return el(
      "div", { class: "stack" },
      el("p", {}, `That is ${measured.toFixed(2)} m now.`),
      field("Its true length, in metres", input),
      el("div", { class: "row" },
        button("Set the scale", () => {
          const factor = Number(input.value) / measured;
          if (!(factor > 0.01 && factor < 100)) throw new Error("That is no length.");
          const frame = structuredClone(this.frame);
          this.drawing.box = null;
          const plan = this.changed((one) => model.rescale(one, frame, factor));
          this.use("");
          this.edited(plan, { frame });
        }, { class: "first" }),
        button("Leave it", () => this.use(""))),
    );
  }

  choiceForm() {
    const { type, item, index } = this.choice;
    if (type === "opening") return this.openingForm(item);
    const corner = type === "corner" && button("Remove the corner", () => this.edited(this.changedItem((room) => model.removeCorner(room, index))));
    const wall = type === "wall" && el("div", { class: "row" }, this.lengthField(item, index),
      button("Add a corner", () => this.edited(this.changedItem((room) => model.addCorner(room, index)))));
    return el("section", { class: "card stack" }, el("h2", {}, `Room: ${item.roomName}`), this.roomForm(item), corner || null, wall || null,
      button("Delete the room", () => this.remove()));
  }

  changedItem(change) {
    const list = this.choice.type === "opening" ? "windowsDoors" : "rooms";
    const at = this.plan[list].indexOf(this.choice.item);
    return this.changed((plan) => change(plan[list][at]));
  }

  roomForm(room) {
    const name = el("input", { value: room.roomName, maxlength: 60 });
    name.addEventListener("change", () => {
      this.edited(this.changedItem((one) => {
        one.roomKind = model.kindOf(one);
        one.roomName = name.value.trim() || one.roomKind;
      }));
    });
    const kind = choice(model.ROOM_KINDS, model.kindOf(room), (value) => {
      this.edited(this.changedItem((one) => model.setKind(one, value)));
    });
    const at = this.plan.rooms.indexOf(room);
    const cook = model.kindOf(room) !== "kitchen" && button("The kitchen is here", () =>
      this.edited(this.changed((plan) => model.moveKitchen(plan, plan.rooms[at]))));
    return el("div", { class: "row" }, field("Name", name), field("Kind", kind), cook || "");
  }

  lengthField(room, index) {
    const long = model.edgeOf(room, index).span;
    const at = this.plan.rooms.indexOf(room);
    const input = el("input", { type: "number", min: 30, max: 10000, step: 1, value: Math.round(long) });
    input.addEventListener("change", () => {
      const cm = Math.min(Math.max(Number(input.value) || long, 30), 10000);
      this.edited(this.changed((plan) => model.setLength(plan, plan.rooms[at], index, cm)));
    });
    return field("Length, cm", input);
  }

  openingForm(opening) {
    const kind = choice(model.OPENING_KINDS, opening.type, (value) => {
      this.edited(this.changedItem((one) => model.setOpeningKind(one, value)));
    });
    const width = el("input", { type: "number", min: 30, max: 1000, step: 1, value: Math.round(opening.length) });
    width.addEventListener("change", () => {
      this.edited(this.changedItem((one) => {
        one.length = Math.min(Math.max(Number(width.value) || one.length, 30), 1000);
      }));
    });
    return el(
      "section", { class: "card stack" },
      el("h2", {}, "Opening"),
      el("div", { class: "row" }, field("Kind", kind), field("Width, cm", width)),
      button("Delete", () => this.remove()),
    );
  }

  remove() {
    const { type, item } = this.choice;
    const list = type === "opening" ? "windowsDoors" : "rooms";
    const at = this.plan[list].indexOf(item);
    const plan = this.changed((one) => {
      if (type === "opening") model.removeOpening(one, one.windowsDoors[at]);
      else if (model.roomsOf(one).length > 1) model.removeRoom(one, one.rooms[at]);
    });
    const before = this.plan;
    this.choice = null;
    this.edited(plan, { before });
  }

  doubts() {
    const { reading } = this.app.house;
    const told = model.doubtsOf(reading);
    const verdict = VERDICTS[reading?.verdict];
    if (!told.length && !verdict) return null;
    return el("section", { id: "doubts" }, el("h2", {}, "Doubts"), verdict ? el("p", {}, verdict) : "",
      el("ul", { class: "list" }, ...told.map((doubt) => el("li", { class: "wrong" }, this.doubt(doubt)))));
  }

  /** A doubt, which leads to each of its places in turn, or to what puts it right. */
  doubt({ text, ids }) {
    if (text.includes("--scale") && this.frame) return button(text, () => this.use("scale"));
    const places = model.placesOf(this.plan, { ids });
    if (!places.length) return text;
    const at = this.visits[text];
    const which = places.length > 1 && at !== undefined ? ` (${(at % places.length) + 1} of ${places.length})` : "";
    return button(text + which, () => {
      this.visits[text] = (at ?? -1) + 1;
      const place = places[this.visits[text] % places.length];
      this.drawing.goTo(place.item);
      this.choose(place);
      this.side.querySelector(`[data-doubt="${CSS.escape(text)}"]`)?.focus();
    }, { "data-doubt": text });
  }

  roomList() {
    const rooms = model.roomsOf(this.plan);
    const rows = rooms.map((room, number) =>
      el("li", {}, button(`${number + 1} ${room.roomName}, ${model.areaM2(room).toFixed(1)} m²`, () => this.choose({ type: "room", item: room }))));
    return el("details", {}, el("summary", {}, `${rooms.length} rooms`), el("ul", { class: "list" }, ...rows));
  }

  furnishForm() {
    const { wishes } = this;
    const { options } = this.app.choices;
    const inputs = (isText) => options.filter((option) => (option.kind === "text") === isText)
      .map((option) => field(option.label, optionInput(option, wishes)));
    const again = this.app.house.versions.length > 0;
    return el(
      "section", { class: "stack", "aria-label": "Furnish" },
      el("div", { class: "row" }, ...inputs(false)),
      ...inputs(true),
      button(again ? "Furnish again" : "Furnish", async () => {
        await this.save();
        const given = { ...wishes };
        const ground = this.app.house.storeys?.[0]?.id ?? this.app.house.id;
        if (ground === this.app.house.id) {
          await this.app.start("furnish", given);
          return;
        }
        await job(ground, "furnish", given);
        location.hash = `#/${ground}/plan`;
      }, { class: "first", id: "furnish" }),
    );
  }
}
