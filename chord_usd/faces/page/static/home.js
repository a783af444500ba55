// Where a house begins: a plan that is dropped or picked, a text, or one that is there already.
import { ask, houses, job, post } from "./api.js";
import { button, check, complain, el, field } from "./dom.js";
import { Outline, openPlan } from "./outline.js";

const EXAMPLE = "a two-bedroom flat with an open kitchen, about 70 m²";

/** Whether a plan is furnished as it was read, without a look at the reading. */
let isAtOnce = true;

export async function home(app) {
  const list = await houseList();
  return el("div", { class: "home" }, dropArea(app), textArea(), outlineArea(), list);
}

function dropArea(app) {
  const picker = el("input", {
    type: "file",
    accept: app.choices.suffixes.join(),
    hidden: true,
    multiple: true,
    id: "file",
    onchange: () => picker.files.length && upload([...picker.files]),
  });
  const area = el(
    "section",
    { class: "card drop", "aria-label": "A plan" },
    el("h2", {}, "Drop a floor plan"),
    button("Choose a file", () => picker.click(), { class: "first" }),
    picker,
    check("Furnish it at once", isAtOnce, (isChecked) => { isAtOnce = isChecked; }),
    el("p", { class: "quiet" }, "A picture, scan, photo, PDF, SVG, DXF, IFC, Sweet Home 3D or plan.json; several are the storeys of one house, the lowest first"),
  );
  const over = (event) => {
    event.preventDefault();
    area.classList.toggle("over", event.type === "dragover");
  };
  area.addEventListener("dragover", over);
  area.addEventListener("dragleave", over);
  area.addEventListener("drop", (event) => {
    over(event);
    const files = [...event.dataTransfer.files];
    if (files.length) upload(files);
  });
  return area;
}

async function upload([file, ...above]) {
  complain();
  try {
    const house = await ask("POST", `/api/houses?name=${encodeURIComponent(file.name)}`, file);
    for (const one of above) await addStorey(house.id, one);
    await begin(house);
  } catch (error) {
    complain(error);
  }
}

/** A plan as the next storey of a house; a number: that part of the house's own file. */
export async function addStorey(below, plan) {
  if (typeof plan === "number") return post("/api/houses", { below, part: plan });
  return ask("POST", `/api/houses?below=${below}&name=${encodeURIComponent(plan.name)}`, plan);
}

async function begin(house) {
  if (isAtOnce) await job(house.id, "furnish");
  location.hash = `#/${house.id}/plan`;
}

function textArea() {
  const text = el("textarea", { rows: 2, placeholder: EXAMPLE, maxlength: 2000 });
  return el(
    "section",
    { class: "card stack" },
    el("h2", {}, "Or say what you want"),
    field("The home, in words", text),
    button("Plan it", async () => {
      await begin(await post("/api/houses", { text: text.value || EXAMPLE }));
    }),
  );
}

function outlineArea() {
  return el("section", { class: "card stack" },
    el("h2", {}, "Or draw its outer walls"),
    el("p", { class: "quiet" }, "They are divided into rooms then."),
    button("Draw an outline", () => {
      const outline = new Outline(async (corners) => {
        const file = new Blob([JSON.stringify(openPlan(corners))]);
        const house = await ask("POST", "/api/houses?name=Outline.json", file);
        location.hash = `#/${house.id}/plan`;
      });
      document.getElementById("main").replaceChildren(outline.node);
    }));
}

async function houseList() {
  const known = (await houses()).houses;
  const list = el("ul", { class: "houses" });
  for (const house of known) {
    const row = el("li", {}, el("a", { href: `#/${house.id}/${house.shown ? "house" : "plan"}` }, house.name));
    const made = new Date(house.made).toLocaleString([], { dateStyle: "medium", timeStyle: "short" });
    row.append(
      el("span", { class: "quiet" }, made),
      button("Delete", async () => {
        if (!confirm(`Delete ${house.name} and all that was made of it?`)) return;
        await ask("DELETE", `/api/houses/${house.id}`);
        row.remove();
      }),
    );
    list.append(row);
  }
  return el("section", { class: "card", hidden: !known.length }, el("h2", {}, "Your houses"), list);
}
