// What was made of a house: its certificate, pictures, files and earlier versions.
import { ask, file, isOver } from "./api.js";
import { button, choice, complain, el, field } from "./dom.js";
import { findingsOf } from "./planning.js";

/** A tab that is drawn anew when the house has changed. */
function redrawn(app, draw) {
  const node = el("div", { class: "page" });
  let last = "";
  const show = () => {
    // Not at each look: whoever is choosing something in a list would lose it.
    const now = JSON.stringify([app.version(), app.house.jobs.map((job) => job.state)]);
    if (now === last) return;
    last = now;
    node.replaceChildren(...draw(app, app.version()).filter(Boolean));
  };
  app.seen = show;
  show();
  return node;
}

export const certificateTab = (app) => redrawn(app, certificate);
export const picturesTab = (app) => redrawn(app, pictures);
export const filesTab = (app) => redrawn(app, files);

const leaf = (path) => path.replace("/House/Rooms/", "").replace("/Furniture/", " › ").replace("/Dressing/", " › ").replaceAll("/", " › ");

function certificate(app, version) {
  const told = version.certificate;
  if (!told) {
    const wait = el("p", { class: "quiet" }, "The house is being checked …");
    const again = button("Check it", () => app.start("check", { version: version.number }));
    return [app.house.jobs.some((job) => job.kind === "check" && !isOver(job)) ? wait : again, ...versions(app)];
  }
  const faults = faultsOf(told);
  return [
    el("h2", {}, told.holds ? "The certificate holds" : "The certificate does not hold"),
    told.holds ? el("p", { class: "quiet" }, "Nothing collides, nothing floats, no opening is blocked.") : null,
    told.walkable === undefined ? null : el("p", {}, `Of the walkable floor, ${percent(told.walkable)} hang together; ${percent(told.reachable_rooms)} of the rooms can be reached. Complete rooms: ${percent(told.complete)}.`),
    faults.length
      ? leading(app, faults)
      : told.holds ? el("p", {}, "No fault was found.") : null,
    ...planning(app, told.design),
    button("Check again, with your changes", () => app.start("check", { version: version.number })),
    ...versions(app),
  ];
}

/** A list of what leads to its place in the house. */
const leading = (app, rows) =>
  el("ul", { class: "list" }, ...rows.map(({ text, paths }) => el("li", {}, button(text, () => app.open("house", { paths })))));

/** How the home keeps published planning numbers, and where it does not. */
function planning(app, design) {
  if (!design) return [];
  const findings = findingsOf(design);
  return [
    el("h2", {}, `Planning: ${percent(design.rules_kept)} of the rules are kept`),
    findings.length ? leading(app, findings) : el("p", {}, "Every rule is kept."),
  ];
}

const versions = (app) => [
  el("h2", {}, "Versions"),
  el("ul", { class: "list" }, ...app.house.versions.map((one) => versionRow(app, one)).reverse()),
];

const percent = (share) => `${Math.round((share ?? 0) * 100)} %`;

const PATH = /\/House\/[^\s:,]+/g;

/** What is wrong, in words, with the prims to show for it: all that speaks against the certificate, then advice. */
function faultsOf(told) {
  return [
    ...(told.faults ?? []).map((line) => ({ text: line.replace(PATH, leaf), paths: line.match(PATH) ?? [] })),
    ...(told.missing ?? []).map(({ path, pieces }) => ({ text: `${leaf(path)} lacks ${pieces.join(", ").replaceAll("_", " ")}`, paths: [path] })),
    ...(told.home_lacks ?? []).map((piece) => ({ text: `The home has no ${piece}`, paths: [] })),
    ...(told.misplaced ?? []).map(({ item, fault }) => ({ text: `${leaf(item)} is ${fault}`, paths: [item] })),
  ];
}

function versionRow(app, version) {
  const isShown = version.number === app.house.shown;
  const told = version.certificate;
  const holds = !told ? "not checked" : told.holds ? "certificate holds" : "certificate does not hold";
  return el("li", {}, button(`${version.number}: ${version.label} – ${holds}${isShown ? " (shown)" : ""}`, async () => {
    app.house = await ask("PATCH", `/api/houses/${app.house.id}`, { shown: version.number });
    app.open("house");
  }, { "aria-pressed": isShown }));
}

function pictures(app, version) {
  const cameras = [["Isometric", "All of it, from a corner"], ["Top", "From above"], ...(version.rooms ?? []).map((room) => [room, room])];
  const camera = choice(cameras, "Isometric");
  const quality = choice([["draft", "Draft, in seconds"], ["good", "Good, in minutes"]], "draft");
  const light = choice([["", "as it is"], "day", "evening", "night"], "");
  const made = version.pictures.map((name) => {
    const address = file(app.house.id, version.number, "pictures", name);
    const text = `${name.split("/")[1].replace(".png", "")}, rendered`;
    return el("a", { href: address, target: "_blank" }, el("img", { src: address, alt: text, loading: "lazy" }));
  });
  return [
    el("div", { class: "row" }, field("View", camera), field("Quality", quality), field("Light", light),
      button("Render", () => app.start("render", { version: version.number, camera: camera.value, quality: quality.value, lighting: light.value }), { class: "first" })),
    made.length ? el("div", { class: "pictures" }, ...made.reverse()) : el("p", { class: "quiet" }, "No picture was rendered yet."),
  ];
}

const PACKS = {
  usda: "OpenUSD: the house with its folders",
  web: "USDZ for viewers in a browser",
  ar: "USDZ for AR Quick Look",
  gltf: "GLB",
  blend: "Blender file, pictures within",
  ifc: "IFC, for planners",
  dxf: "DXF, for CAD",
  mujoco: "MJCF, for MuJoCo",
  ros: "Maps for robots (ROS)",
};

function files(app, version) {
  const rows = Object.entries(app.choices.packs).map(([kind, name]) => {
    const address = file(app.house.id, version.number, "packs", name);
    const made = version.packs.includes(name) && el("a", { href: address, download: "" }, `Download ${name}`);
    return el("li", { class: "row" },
      button(PACKS[kind], () => app.start("pack", { version: version.number, for: kind }), { "data-pack": kind }), made || null);
  });
  return [
    el("h2", {}, "Take the house away"),
    el("p", { class: "quiet" }, "A file is made when you ask for it, with your changes in it."),
    el("ul", { class: "list" }, ...rows,
      el("li", { class: "row" }, button("plan.json, the floor plan", () => downloadPlan(app)))),
  ];
}

async function downloadPlan(app) {
  const { plan } = await ask("GET", `/api/houses/${app.house.id}/plan`);
  const url = URL.createObjectURL(new Blob([JSON.stringify(plan, null, 1)], { type: "application/json" }));
  const link = el("a", { href: url, download: "plan.json" });
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
  complain();
}
