// Elements without markup: texts of users and of files are never read as HTML.

/** An element. Properties that begin with "on" listen; others are attributes; false leaves out. */
export function el(tag, properties = {}, ...children) {
  const node = document.createElement(tag);
  assign(node, properties);
  node.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return node;
}

/** The same for drawings. */
export function svg(tag, properties = {}, ...children) {
  const node = document.createElementNS("http://www.w3.org/2000/svg", tag);
  assign(node, properties);
  node.append(...children);
  return node;
}

function assign(node, properties) {
  for (const [name, value] of Object.entries(properties)) {
    if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else if (name === "value") node.value = value;
    else if (value === true) node.setAttribute(name, "");
    else if (value !== false && value !== null && value !== undefined) {
      node.setAttribute(name, value);
    }
  }
}

/** A button that can be pressed once at a time. */
export function button(text, act, properties = {}) {
  const node = el("button", { type: "button", ...properties }, text);
  node.addEventListener("click", async () => {
    if (node.dataset.busy) return;
    node.dataset.busy = "1";
    try {
      await act(node);
    } catch (error) {
      complain(error);
    } finally {
      delete node.dataset.busy;
    }
  });
  return node;
}

/** A field under its name. */
export const field = (name, input) => el("label", {}, name, input);

/** A box to tick. */
export function check(name, checked, act) {
  const box = el("input", { type: "checkbox", onchange: () => act(box.checked) });
  box.checked = checked;
  return el("label", { class: "check" }, box, name);
}

/** The input of a row of the option table; a change is stored in values, by name. */
export function optionInput(option, values) {
  const { name, kind, help } = option;
  const store = (value) => { values[name] = value; };
  if (kind === "choice") {
    // An empty choice is the usual value, which the help names in brackets.
    const usual = /\((\w+)\)$/.exec(help)?.[1] ?? "usual";
    const choices = option.choices.includes("") ? option.choices.filter((c) => c !== usual) : option.choices;
    return choice(choices.map((c) => [c, c || usual]), values[name], store);
  }
  if (kind === "number") {
    const { least: min, most: max } = option;
    const input = el("input", { type: "number", min, max, value: values[name], title: help });
    input.addEventListener("change", () => store(Number(input.value) || option.default));
    return input;
  }
  const text = el("textarea", { rows: 2, placeholder: help, maxlength: 2000, value: values[name] });
  text.addEventListener("change", () => store(text.value));
  return text;
}

/** A list to choose from: names, or pairs of value and name. */
export function choice(options, value, act = () => {}) {
  const list = el("select", { onchange: () => act(list.value) });
  for (const option of options) {
    const [key, name] = Array.isArray(option) ? option : [option, option];
    list.append(el("option", { value: key }, String(name).replaceAll("_", " ")));
  }
  list.value = value;
  return list;
}

const MISTAKE = "Something in this page went wrong, and nothing was changed. Try: reload the page.";

/** What of an error is meant for people: only plain Errors carry sentences. */
function sentenceOf(error) {
  if (!(error instanceof Error)) return error;
  if (error.constructor === Error) return error.message;
  console.error(error);
  return MISTAKE;
}

/** Say what went wrong, or nothing. */
export function complain(error = "") {
  const place = document.getElementById("message");
  place.textContent = sentenceOf(error);
  place.hidden = !place.textContent;
}
