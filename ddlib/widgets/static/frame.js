// What all widgets have in common: a title, Reset, a link that restores the state, and the state as
// Python code.

import { buttonOf, make } from "./elements.js";

const LATER = 300; // ms after the last change at which the page's address follows

// The texts that the address holds for a widget, by name. One entry of the query per widget,
// ?picker=shoulder_deg:20,elbow_deg:30, so that anchors and the ledger's hash stay as they are.
function addressed(key) {
  const pairs = (new URLSearchParams(location.search).get(key) ?? "").split(",");
  try {
    return Object.fromEntries(pairs.map((pair) => pair.split(":").map(decodeURIComponent)));
  } catch {
    return {}; // not written by a widget
  }
}

function queryWith(key, state) {
  const query = new URLSearchParams(location.search);
  const pairs = Object.entries(state).map((pair) => pair.map(encodeURIComponent).join(":"));
  if (pairs.length) query.set(key, pairs.join(","));
  else query.delete(key);
  const text = query.toString().replaceAll("%3A", ":").replaceAll("%2C", ",");
  return `${text && "?"}${text}`;
}

// Buttons of a widget; returns their element and functions.
//   el       the widget's element
//   key      its name in the address; with a number from the second such widget of a page on
//   title    shown above it
//   linked   whether the address holds its state: in a page without a kernel
//   reset()  goes back to the start
//   code()   the state as Python code, or "" for none
// keep(name, read, write, start) adds a part of the state: read() is its text, write(text) restores
// it and throws where the text is unfit; it starts as it is, or as `start`. What differs from the
// start is in the address; where that already holds a text, it is written at once. changed() is to
// be called after every change.
export function frameOf({ el, key, title, linked, reset, code }) {
  const others = [...document.querySelectorAll("[data-widget]")].map((x) => x.dataset.widget);
  let name = key;
  for (let k = 2; others.includes(name); k++) name = `${key}${k}`;
  el.dataset.widget = name;
  const given = linked ? addressed(name) : {};
  const parts = {};

  const state = () => {
    const now = Object.entries(parts).map(([part, { read }]) => [part, read()]);
    return Object.fromEntries(now.filter(([part, text]) => text !== parts[part].start));
  };
  const address = () => `${location.pathname}${queryWith(name, state())}`;
  let timer = 0;
  function write() {
    timer = 0;
    try {
      if (el.isConnected) history.replaceState(history.state, "", `${address()}${location.hash}`);
    } catch {
      // a page within another one, or too many changes: the link can still be copied
    }
  }
  function changed() {
    if (linked) timer ||= setTimeout(write, LATER);
  }
  function keep(part, read, restore, start = read()) {
    parts[part] = { read, restore, start };
    if (given[part] === undefined) return;
    try {
      restore(given[part]);
    } catch {
      // an old link, or one that was typed: the start stands
    }
  }

  const said = make("span", { class: "said", role: "status" });
  const field = make("textarea", { class: "copied", readonly: "", spellcheck: "false", hidden: "" });
  async function copy(text, what) {
    field.hidden = true;
    said.textContent = "";
    try {
      await navigator.clipboard.writeText(text);
      said.textContent = `${what} copied`;
    } catch {
      field.hidden = false;
      field.value = text;
      field.rows = text.split("\n").length;
      field.setAttribute("aria-label", what);
      field.focus({ preventScroll: true });
      field.select();
      said.textContent = "Press Ctrl+C: your browser does not copy by itself";
    }
  }
  const button = (text, words, act) => buttonOf(text, act, { "aria-label": words, title: words });
  const link = () => new URL(`${address()}#${name}-widget`, location.href).href;
  const buttons = [
    button("Reset", "Reset to the start", () => {
      field.hidden = true;
      for (const { start, restore } of Object.values(parts)) restore(start);
      reset?.();
      changed();
      said.textContent = "Back at the start";
    }),
    ...(linked ? [button("Link", "Copy link to this state", () => copy(link(), "Link"))] : []),
    ...(code() ? [button("Code", "Copy this state as Python code", () => copy(code(), "Code"))] : []),
  ];
  const actions = make("div", { class: "actions" }, ...buttons);
  const bar = make("div", { class: "bar" }, make("span", { class: "name" }, title), said, actions);
  if (linked) {
    el.id = `${name}-widget`;
    if (location.hash === `#${el.id}`) requestAnimationFrame(() => el.scrollIntoView());
  }
  return { el: make("div", { class: "frame-bar" }, bar, field), keep, changed, stop: () => clearTimeout(timer) };
}

// Python code with texts in place of their names in braces.
export const filled = (code, texts) => code.replace(/\{(\w+)\}/g, (whole, name) => texts[name] ?? whole);

// A value as Python writes it.
export function python(value) {
  if (typeof value === "boolean") return value ? "True" : "False";
  return typeof value === "number" ? String(Number(value.toPrecision(6))) : JSON.stringify(value);
}
