// What is changed by hand in a house: kept in the view at once, on the server a moment later.
import { ask, get } from "./api.js";
import { place, show } from "./batches.js";
import { complain } from "./dom.js";
import { THREE } from "./three.js";

const SAVE_AFTER_MS = 600;

export class Edits {
  constructor(address, house, changed) {
    Object.assign(this, { address, house, changed, done: [], revision: 0 });
    this.state = { pieces: {}, locked: [] };
  }

  /** Take in what was changed before. */
  async load() {
    const { revision, edits } = await get(this.address);
    this.revision = revision;
    this.state = { pieces: edits.pieces, locked: edits.locked };
    for (const piece of this.house.pieces.values()) piece.was = rowsOf(piece.node.matrix);
    this.showAll();
  }

  showAll() {
    for (const piece of this.house.pieces.values()) {
      if (piece.group === "Architecture") continue;
      const rows = this.state.pieces[piece.path]?.matrix ?? piece.was;
      if (String(rows) !== String(rowsOf(piece.node.matrix))) {
        setMatrix(piece.node, rows);
        place(this.house.pieces, piece);
      }
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

  /** Do something to the changes, so that it can be taken back. */
  apply(change) {
    this.done.push(structuredClone(this.state));
    change(this.state);
    this.tell();
  }

  undo() {
    const state = this.done.pop();
    if (!state) return;
    this.state = state;
    this.tell();
  }

  tell() {
    this.showAll();
    this.changed();
    clearTimeout(this.timer);
    this.isUnsaved = true;
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
    const before = structuredClone(this.state);
    const ones = [piece, ...this.restingOn(piece)];
    const from = ones.map((one) => one.node.matrix.clone());
    return {
      to: ([x, y]) => ones.forEach((one, at) => {
        const rows = rowsOf(new THREE.Matrix4().makeTranslation(x, y, 0).multiply(from[at]));
        this.put(this.state, one, rows);
        setMatrix(one.node, rows);
        place(this.house.pieces, one);
      }),
      end: () => {
        this.done.push(before);
        this.tell();
      },
    };
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

  async save() {
    clearTimeout(this.timer);
    if (!this.isUnsaved) return;
    this.isUnsaved = false;
    const body = { base: this.revision, edits: this.state };
    this.revision = (await ask("PUT", this.address, body)).revision;
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
