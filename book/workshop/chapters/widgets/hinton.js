// What WeightReader (weights.py) adds to a CurveWidget: all weights as squares, in the paper's
// layout, and a unit's window that is chosen by pointer or arrow keys.

import { extras } from "ddlib/curves.js";
import { make, onKeys, put } from "ddlib/elements.js";

const BLOB = { width: 240, height: 62, gap: 8, side: 13 }; // of a unit, and its largest square
const CELLS = "weights of all units";

function hintonOf(view) {
  const { units, names, outputs, joints, width } = view.model.get("hinton");
  const blobs = units.map((name, k) => {
    const [column, row] = [k % 2, Math.floor(k / 2)];
    const below = row ? BLOB.gap : 0; // a wider gap between outputs and hidden units
    const tops = k < outputs ? units.length - outputs : outputs;
    return {
      name,
      tops,
      x: column * (BLOB.width + BLOB.gap),
      y: row * (BLOB.height + BLOB.gap) + below,
    };
  });
  const size = [2 * BLOB.width + BLOB.gap, blobs.at(-1).y + BLOB.height];

  // The strip of a blob that stands for one choice, the line of one window.
  const stripe = (blob, j) => ({ x: blob.x, y: blob.y + 24 + 18 * j, width: BLOB.width, height: 20 });
  const id = (k, j) => `${view.id}-unit-${k}-${j}`;
  const words = (k, j) => `${names[k]}, ${joints[j]}'s window`;
  const options = blobs.map((blob, k) =>
    joints.map((_, j) =>
      make("rect", { ...stripe(blob, j), id: id(k, j), class: "option", role: "gridcell", "aria-label": words(k, j) }),
    ),
  );
  const lines = [];
  for (let k = 0; k < units.length; k += 2) {
    joints.forEach((_, j) => {
      lines.push(make("g", { role: "row" }, ...options.slice(k, k + 2).map((cells) => cells[j])));
    });
  }
  const drawn = ["positive", "negative"].map((sign) => make("path", { class: sign }));
  const ring = ["outer", "inner"].map((part) => make("rect", { class: part, rx: 3 }));
  const back = blobs.map(({ x, y }) => make("rect", { x, y, width: BLOB.width, height: BLOB.height, class: "blob" }));
  const picture = make("g", { "aria-hidden": "true" }, ...back, ...drawn, ...ring);
  const svg = make("svg", { viewBox: `-3 -3 ${size[0] + 6} ${size[1] + 6}`, class: "hinton", tabindex: 0 });
  svg.append(picture, ...lines);
  put(svg, { role: "grid", "aria-label": "Weights of all units; arrow keys choose one" });

  const now = () => [units.indexOf(view.get("unit")), joints.indexOf(view.get("joint"))];
  let marked = options[0][0];
  function choose(k, j) {
    const unit = Math.min(units.length - 1, Math.max(0, k));
    view.set({ unit: units[unit], joint: joints[j] });
  }
  function pick(event) {
    const box = picture.getBoundingClientRect();
    const x = ((event.clientX - box.left) / box.width) * size[0];
    const y = ((event.clientY - box.top) / box.height) * size[1];
    const distance = ({ x: a, y: b }) => Math.hypot(x - a - BLOB.width / 2, 4 * (y - b - BLOB.height / 2));
    const k = blobs.reduce((best, blob, i) => (distance(blob) < distance(blobs[best]) ? i : best), 0);
    choose(k, y > blobs[k].y + 43 ? 1 : 0);
  }
  svg.addEventListener("click", pick); // a tap too; a touch that scrolls the page is none
  svg.addEventListener("pointermove", (event) => {
    if (event.buttons & 1 && event.pointerType !== "touch") pick(event);
  });
  onKeys(svg, (event) => {
    const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const move = moves[event.key];
    if (!move) return false;
    const [k, j] = now();
    const column = Math.min(1, Math.max(0, (k % 2) + move[0]));
    const last = Math.ceil(units.length / 2) * joints.length - 1;
    const line = Math.min(last, Math.max(0, Math.floor(k / 2) * joints.length + j + move[1]));
    choose(2 * Math.floor(line / joints.length) + column, line % joints.length);
  });

  const { low, high } = view.spec.curves.find((curve) => curve.name === CELLS);
  const most = Math.max(-low, high); // of all settings
  const pitch = Math.min(BLOB.side + 1, (BLOB.width - 8) / width);
  const side = Math.min(BLOB.side, pitch);
  const tenth = (x) => Math.round(10 * x) / 10; // quicker than toFixed
  function paint(cells) {
    const paths = ["", ""];
    const square = (value, x, y) => {
      const a = tenth(side * Math.sqrt(Math.abs(value) / most));
      if (a > 0.2) paths[value < 0 ? 1 : 0] += `M${tenth(x - a / 2)} ${tenth(y - a / 2)}h${a}v${a}h-${a}z`;
    };
    let at = 0;
    for (const { x, y, tops } of blobs) {
      square(cells[at++], x + 12, y + 13);
      const right = x + BLOB.width - 4 - (tops - 0.5) * (BLOB.side + 1);
      for (let i = 0; i < tops; i++) square(cells[at++], right + i * (BLOB.side + 1), y + 13);
      joints.forEach((_, j) => {
        for (let i = -(width >> 1); i <= width >> 1; i++) {
          square(cells[at++], x + BLOB.width / 2 + i * pitch, y + 34 + 18 * j);
        }
      });
    }
    drawn.forEach((path, i) => path.setAttribute("d", paths[i]));
  }

  let painted = [];
  function update(curves) {
    const cells = curves[CELLS];
    if (cells.some((value, i) => value !== painted[i])) paint((painted = cells));
    const [k, j] = now();
    marked.removeAttribute("aria-selected");
    marked = options[k][j];
    marked.setAttribute("aria-selected", "true");
    svg.setAttribute("aria-activedescendant", marked.id);
    for (const rect of ring) put(rect, stripe(blobs[k], j));
  }

  const key = make("div", { class: "legend" });
  for (const [sign, text] of [["positive", "white: positive"], ["negative", "black: negative"]]) {
    const icon = make("svg", { width: 14, height: 14, class: "hinton-key", "aria-hidden": "true" });
    icon.append(make("rect", { width: 14, height: 14, class: "blob" }), make("path", { d: "M3 3h8v8h-8z", class: sign }));
    key.append(make("span", {}, icon, text));
  }
  key.append(make("span", {}, "area: size"));
  const caption = make("div", { class: "title" }, "All weights, outputs on top");
  return { el: make("div", { class: "hinton-box" }, caption, key, svg), update };
}

extras.push((view) => {
  const diagram = hintonOf(view);
  view.top.prepend(diagram.el);
  view.after.push(diagram.update);
});
