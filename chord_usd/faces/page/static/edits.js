// What is changed by hand in a house: kept in the view at once, on the server a moment later.
import { ask, get, oneAtATime } from "./api.js";
import { boxOf, place, show } from "./batches.js";
import { complain } from "./dom.js";
import { THREE } from "./three.js";

const SAVE_AFTER_MS = 600;
/** Dressing that lies this near to a piece's top lies on it. */
const ON_TOP_M = 0.1;

export class Edits {
  /** dressed: told of each piece and the swap of it, or null, whenever something has changed. */
  constructor(address, house, { changed, dressed, saved }) {
    Object.assign(this, { address, house, changed, dressed, saved, revision: 0 });
    this.state = { pieces: {}, locked: [] };
    this.sendInTurn = oneAtATime(() => this.send());
  }

  /** Take in what was changed before. */
  async load() {
    await this.take();
    for (const piece of this.house.pieces.values()) {
      piece.was = rowsOf(piece.node.matrix);
      if (piece.model) piece.modelWas = rowsOf(piece.model.matrix);
    }
    this.showAll();
  }

  async take() {
    const { revision, edits } = await get(this.address);
    this.revision = revision;
    this.state = { pieces: edits.pieces, locked: edits.locked };
  }

  /** Show the changes as the server has them now: some were undone. */
  async reload() {
    await this.take();
    this.showAll();
    this.changed();
  }

  showAll() {
    for (const piece of this.house.pieces.values()) {
      if (piece.group === "Architecture") continue;
      const nodes = [[piece.path, piece.node, piece.was]];
      if (piece.modelPath !== piece.path) nodes.push([piece.modelPath, piece.model, piece.modelWas]);
      for (const [path, node, was] of nodes) {
        const rows = this.state.pieces[path]?.matrix ?? was;
        if (String(rows) !== String(rowsOf(node.matrix))) {
          setMatrix(node, rows);
          place(this.house.pieces, piece);
        }
      }
      this.dressed(piece, this.state.pieces[piece.modelPath]?.swap ?? null);
    }
    for (const piece of this.house.pieces.values()) {
      if (piece.group !== "Architecture" && !piece.above) show(this.house.pieces, piece, true);
    }
    for (const [path, edit] of Object.entries(this.state.pieces)) {
      const piece = this.house.pieces.get(path);
      if (piece && edit.matrix === null) show(this.house.pieces, piece, false);
    }
  }

  isGone(piece) {
    for (let one = piece; one; one = one.above) {
      if (this.state.pieces[one.path]?.matrix === null) return true;
    }
    return false;
  }

  isLocked(piece) {
    return this.state.locked.includes(piece.path);
  }

  /** Do something to the changes; the server keeps it so that it can be undone. */
  apply(change) {
    change(this.state);
    this.tell();
  }

  tell() {
    this.isUnsaved = true;
    this.showAll();
    this.changed();
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.save().catch(complain), SAVE_AFTER_MS);
  }

  /** Move a piece by metres in the plan and turn it by degrees; what rests on it goes along. */
  move(piece, [x, y], turn = 0) {
    this.apply((state) => {
      const pivot = new THREE.Vector3().setFromMatrixPosition(piece.node.matrix);
      const whole = new THREE.Matrix4()
        .makeTranslation(pivot.x + x, pivot.y + y, 0)
        .multiply(new THREE.Matrix4().makeRotationZ((turn * Math.PI) / 180))
        .multiply(new THREE.Matrix4().makeTranslation(-pivot.x, -pivot.y, 0));
      for (const one of [piece, ...this.restingOn(piece)]) {
        this.put(state, one, rowsOf(whole.clone().multiply(one.node.matrix)));
      }
    });
  }

  put(state, piece, matrix) {
    state.pieces[piece.path] = { ...state.pieces[piece.path], was: piece.was, matrix };
  }

  /** Begin to move a piece as a finger does. Returns what moves it on, by metres in all, and what
   * lets it go: one change, that can be taken back. */
  drag(piece) {
    const ones = [piece, ...this.restingOn(piece)];
    const from = ones.map((one) => one.node.matrix.clone());
    return {
      to: ([x, y]) => ones.forEach((one, at) => {
        const rows = rowsOf(new THREE.Matrix4().makeTranslation(x, y, 0).multiply(from[at]));
        this.put(this.state, one, rows);
        setMatrix(one.node, rows);
        place(this.house.pieces, one);
      }),
      end: () => this.tell(),
    };
  }

  swapOf(piece) {
    return this.state.pieces[piece.modelPath]?.swap ?? null;
  }

  /** What a piece may fill: what the house had there. */
  slotOf(piece) {
    const swap = this.swapOf(piece);
    if (swap) return swap.slot_m;
    const size = boxOf({ ...piece, node: piece.model }, true).getSize(new THREE.Vector3());
    return size.multiply(new THREE.Vector3().setFromMatrixScale(piece.model.matrix)).toArray();
  }

  /** Put another model in a piece's place, as it was turned; what stands on it goes up or down. */
  swap(piece, model, { usd, colour }) {
    const before = this.swapOf(piece);
    const swap = {
      usd,
      slot_m: this.slotOf(piece),
      offset_m: model.fits.center_m.slice(0, 2),
      size_m: model.fits.size_m,
      looks: colour ? { colour } : {},
      kg_per_m3: before?.kg_per_m3 ?? 0,
    };
    const [x, y] = [0, 1].map((axis) => swap.offset_m[axis] - (before?.offset_m[axis] ?? 0));
    const [at, turn] = [new THREE.Vector3(), new THREE.Quaternion()];
    piece.model.matrix.decompose(at, turn, new THREE.Vector3());
    at.add(new THREE.Vector3(x, y, 0).applyQuaternion(turn));
    const scale = new THREE.Vector3(...swap.size_m.map((side, axis) => side / model.size_m[axis]));
    const matrix = rowsOf(new THREE.Matrix4().compose(at, turn, scale));
    const height = before?.size_m[2] ?? swap.slot_m[2];
    const top = piece.node.matrix.elements[14] + height;
    const carried = [...this.house.pieces.values()].filter((one) => one.above === piece);
    const onTop = this.restingOn(piece).filter((one) => one.node.matrix.elements[14] >= top - ON_TOP_M);
    this.apply((state) => {
      state.pieces[piece.modelPath] = { was: piece.modelWas, matrix, swap };
      for (const one of [...carried, ...onTop]) {
        const up = new THREE.Matrix4().makeTranslation(0, 0, swap.size_m[2] - height);
        this.put(state, one, rowsOf(up.multiply(one.node.matrix)));
      }
    });
  }

  remove(piece) {
    this.apply((state) => {
      for (const one of [piece, ...this.restingOn(piece)]) {
        this.put(state, one, null);
      }
    });
  }

  lock(piece, isLocked) {
    this.apply((state) => {
      state.locked = state.locked.filter((path) => path !== piece.path);
      if (isLocked) state.locked.push(piece.path);
    });
  }

  /** Dressing that lies or stands on a piece, and what is on that. */
  restingOn(piece) {
    const found = [];
    const waiting = [piece];
    while (waiting.length) {
      const below = waiting.pop();
      for (const one of this.house.pieces.values()) {
        if (one.restsOn && one.restsOn === below.id && !found.includes(one)) {
          found.push(one);
          waiting.push(one);
        }
      }
    }
    return found;
  }

  save() {
    clearTimeout(this.timer);
    return this.sendInTurn();
  }

  async send() {
    if (!this.isUnsaved) return;
    this.isUnsaved = false;
    const body = { base: this.revision, edits: this.state };
    this.revision = (await ask("PUT", this.address, body)).revision;
    await this.saved();
  }
}

/** Four rows of four, which act on columns. */
function rowsOf(matrix) {
  const round = (x) => Math.round(x * 1e6) / 1e6;
  return [0, 1, 2, 3].map((row) => [0, 1, 2, 3].map((column) => round(matrix.elements[column * 4 + row])));
}

function setMatrix(node, rows) {
  node.matrix.set(...rows.flat());
  node.matrix.decompose(node.position, node.quaternion, node.scale);
}
