// Other models in the places of pieces: what is offered, and what the view shows of them.
import { file } from "./api.js";
import { wear } from "./batches.js";
import { button, choice, complain, el } from "./dom.js";
import { GLTFLoader } from "./three.js";

const WORDS = (text) => text.replaceAll("_", " ");

export class Swaps {
  /** tab: the house's, once its house and changes are there. */
  constructor(tab) {
    this.tab = tab;
    this.offered = null;
    /** By piece: the address of what it wears, "" for its own; models by piece and address. */
    this.worn = new Map();
    this.models = new Map();
  }

  viewOf({ usd, looks }) {
    const { app, version } = this.tab;
    return file(app.house.id, version.number, "models", `${usd.split("/")[1]}-${looks.colour ?? ""}.glb`);
  }

  /** Let the view show what the changes say of a piece. */
  async show(piece, swap) {
    const address = swap ? this.viewOf(swap) : "";
    if ((this.worn.get(piece) ?? "") === address) return;
    this.worn.set(piece, address);
    const model = address ? await this.model(piece, address) : null;
    // Whoever was quicker has the last word; what Blender swapped was never made for the view.
    if (this.worn.get(piece) !== address || (address && !model)) return;
    const { view, house } = this.tab;
    view.add(wear(house.pieces, piece, model));
    this.tab.refresh();
  }

  async model(piece, address) {
    const key = `${piece.path} ${address}`;
    if (!this.models.has(key)) {
      const answer = await fetch(address);
      if (!answer.ok) return null;
      const { scene } = await new GLTFLoader().parseAsync(await answer.arrayBuffer(), "");
      this.models.set(key, scene.getObjectByName("Piece"));
    }
    return this.models.get(key);
  }

  /** What of the form of a piece is about others in its place. */
  form(piece) {
    const { tab } = this;
    if (!piece.modelPath || !piece.category) return [];
    const offer = this.offered?.piece === piece ? this.offered.models : null;
    if (!offer) return [button("Swap for another", () => this.offer(piece))];
    if (!offer.length) return [el("p", { class: "quiet" }, "There is no other.")];
    const swap = tab.edits.swapOf(piece);
    const now = swap && offer.find((one) => swap.usd.split("/")[1].startsWith(one.id));
    const pictures = offer.map((model) => {
      const size = model.size_m.slice(0, 2).map((side) => side.toFixed(2)).join(" × ");
      const picture = el("img", { src: `/api/models/${model.id}.png`, alt: "", loading: "lazy" });
      const node = button("", () => this.take(piece, model, model.colours[0] ?? ""), {
        "aria-label": `${WORDS(model.id)}, ${size} m`, title: WORDS(model.id), "aria-pressed": model === now, "data-model": model.id,
      });
      node.append(picture, `${size} m`);
      return node;
    });
    const colours = now?.colours.length > 1
      ? el("label", {}, "Colour", choice(now.colours, swap.looks.colour, (colour) => this.take(piece, now, colour).catch(complain)))
      : null;
    return [el("div", { class: "swaps" }, ...pictures), colours];
  }

  async offer(piece) {
    const size = this.tab.edits.slotOf(piece).map((side) => Math.max(side, 0.01).toFixed(4)).join("x");
    const answer = await this.tab.app.result("models", { category: piece.category, size });
    if (!answer) return;
    this.offered = { piece, models: answer.models };
    this.tab.refresh();
  }

  async take(piece, model, colour) {
    const { app, version, edits } = this.tab;
    const made = await app.result("swap", { version: version.number, model: model.id, colour });
    if (made) edits.swap(piece, model, made);
  }
}
