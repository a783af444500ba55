// The page: which house and which tab are shown, and what is at work on it.
import { ask, choices, house as fetchHouse, isOver, post } from "./api.js";
import { button, complain, el } from "./dom.js";
import { home } from "./home.js";
import { planTab } from "./plan_tab.js";
import { certificateTab, filesTab, picturesTab } from "./results.js";

const LOOK_AGAIN_MS = 250;

const TABS = {
  plan: ["Plan", planTab],
  // Three.js is ten times the rest of the page: it comes when there is a house to see.
  house: ["House", async (app) => (await import("./house_tab.js")).houseTab(app)],
  certificate: ["Certificate", certificateTab],
  pictures: ["Pictures", picturesTab],
  files: ["Files", filesTab],
};

const main = document.getElementById("main");

/** What tabs know of the page. */
const app = {
  choices: null,
  house: null,
  tab: "",
  /** Tabs may listen: called with the house each time that it was looked at. */
  seen: () => {},
  /** Called when a tab is left. */
  left: () => {},
  /** Where a tab was asked to begin: a piece, a room. */
  target: null,

  /** Look at the house again, and follow its jobs. */
  async refresh() {
    if (!app.house) return;
    const id = app.house.id;
    const shown = await fetchHouse(id);
    if (app.house?.id !== id) return;
    const before = app.house;
    app.house = shown;
    showJob();
    showTitle();
    // A new version is what was waited for, but not by one who corrects the plan meanwhile.
    const made = shown.versions.length > before.versions.length ? shown.versions.at(-1) : null;
    const viewOf = (house) => house.versions.find((one) => one.number === house.shown)?.view;
    if (app.tab === "house" && viewOf(shown) !== viewOf(before)) {
      go(id, "house");
    } else if (made && (app.tab !== "plan" || made.plan === shown.plan)) {
      go(id, "house");
    } else {
      app.seen(shown);
    }
    follow();
  },

  /** Ask for a job and follow it. */
  async start(kind, given = {}) {
    complain();
    const job = await post(`/api/houses/${app.house.id}/jobs`, { kind, given });
    await app.refresh();
    return job;
  },

  /** Ask for a job and wait for what it answers; null where another house is looked at meanwhile. */
  async result(kind, given) {
    const { id } = app.house;
    const asked = await app.start(kind, given);
    for (;;) {
      const job = app.house?.id === id && app.house.jobs.find((one) => one.id === asked.id);
      if (!job) return null;
      if (job.state === "done") return job.answer;
      if (isOver(job)) throw new Error(job.error || "That was cancelled.");
      await new Promise((go) => setTimeout(go, LOOK_AGAIN_MS));
    }
  },

  /** Show another tab, perhaps with something chosen in it. */
  open(tab, target = null) {
    app.target = target;
    go(app.house.id, tab);
  },

  version() {
    return app.house?.versions.find((one) => one.number === app.house.shown) ?? null;
  },
};

function go(id, tab) {
  const hash = `#/${id}/${tab}`;
  if (location.hash === hash) showSafely();
  else location.hash = hash;
}

let timer = 0;
function follow() {
  clearTimeout(timer);
  if (app.house?.jobs.some((job) => !isOver(job))) {
    timer = setTimeout(() => app.refresh().catch(complain), LOOK_AGAIN_MS);
  }
}

const WORDS = {
  read: "Reading the plan", divide: "Dividing it into rooms", furnish: "Furnishing", refurnish: "Furnishing the room", say: "Changing the house", view: "Drawing the house",
  check: "Checking", render: "Rendering", pack: "Packing", models: "Looking for others", swap: "Bringing it",
};

const noted = new Set();
function showJob() {
  const place = document.getElementById("job");
  const jobs = app.house?.jobs ?? [];
  const job = jobs.find((one) => !isOver(one));
  for (const over of jobs.filter((one) => isOver(one) && !noted.has(one.id))) {
    noted.add(over.id);
    if (over.state === "failed") complain(over.error);
  }
  const ended = jobs.at(-1)?.state === "ended" ? jobs.at(-1) : null;
  place.hidden = !job && !ended;
  if (job) {
    const bar = el("progress", { "aria-label": "progress" });
    if (job.state === "running" && job.done) bar.value = job.done / job.total;
    const told = job.state === "queued" ? `waiting, ${job.ahead} before it` : job.step;
    place.replaceChildren(
      el("span", {}, `${WORDS[job.kind]}: ${told}`),
      bar,
      button("Cancel", async () => {
        await ask("DELETE", `/api/jobs/${job.id}`);
        await app.refresh();
      }),
    );
  } else if (ended) {
    place.replaceChildren(
      el("span", { class: "wrong" }, `${WORDS[ended.kind]}: ${ended.error}`),
      button("Again", async () => {
        await post(`/api/jobs/${ended.id}/again`);
        await app.refresh();
      }),
    );
  } else {
    place.replaceChildren();
  }
}

function showTitle() {
  const title = app.house?.name ?? "";
  document.getElementById("title").textContent = title;
  document.title = title ? `${title} – chord-usd` : "chord-usd";
  const tabs = document.getElementById("tabs");
  tabs.hidden = !app.house;
  if (!app.house) return;
  const known = app.house.versions.length ? Object.keys(TABS) : ["plan"];
  if (tabs.dataset.known !== known.join()) {
    tabs.dataset.known = known.join();
    tabs.replaceChildren(...known.map((name) => tabButton(name)));
  }
  for (const node of tabs.children) {
    const chosen = node.dataset.tab === app.tab;
    node.setAttribute("aria-selected", chosen);
    node.tabIndex = chosen ? 0 : -1;
  }
}

function tabButton(name) {
  const node = button(TABS[name][0], () => app.open(name), { role: "tab", "data-tab": name });
  node.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    const other = step && (step > 0 ? node.nextElementSibling : node.previousElementSibling);
    if (other) {
      other.focus();
      other.click();
    }
  });
  return node;
}

let shows = 0;
async function show() {
  const own = (shows += 1);
  app.left();
  app.left = app.seen = () => {};
  complain();
  const [id, tab] = location.hash.replace(/^#\/?/, "").split("/");
  if (!id) {
    app.house = null;
    app.tab = "";
    showJob();
    showTitle();
    const page = await home(app);
    if (own === shows) main.replaceChildren(page);
    return;
  }
  if (app.house?.id !== id) app.house = await fetchHouse(id);
  app.tab = TABS[tab] && (tab === "plan" || app.house.versions.length) ? tab : "plan";
  showJob();
  showTitle();
  const page = await TABS[app.tab][1](app);
  // Whoever went on meanwhile sees the other tab, and this one is not heard of again.
  if (own !== shows) return;
  main.replaceChildren(page);
  follow();
}

function showSafely() {
  show().catch((error) => {
    if (error.status === 404) location.hash = "#/";
    complain(error);
  });
}

addEventListener("hashchange", showSafely);
app.choices = await choices();
showSafely();
