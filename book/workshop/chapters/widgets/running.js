// Charts that run with time, on canvases. Samples are the world's.

import { sheet, stroke } from "ddlib/canvas.js";
import { make } from "ddlib/elements.js";
import { JOINTS } from "ddlib/engine.js";

const SHOWN = 300; // samples of a chart: 3 s
const MARGIN = { left: 40, right: 6 };

// A legend's entry: a line of a kind, and what it is.
export function keyOf(kind, text) {
  const line = make("path", { class: `key ${kind}`, d: "M0 5H22" });
  return make("span", {}, make("svg", { width: 22, height: 10, "aria-hidden": "true" }, line), text);
}

// A round step of which about `count` fill the range.
function roundStep(range, count) {
  const rough = range / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  return power * [1, 2, 2.5, 3, 4, 5, 10].find((m) => m * power >= rough * 0.999);
}

// A chart of the last seconds. `lines`: { colour, width, dash, of(sample) -> number or undefined };
// [low, high] is the range that it shows at least; `bottom` says whether it has the axis of time.
export function timeChart({ height, label, low, high, lines, bottom = false }) {
  const place = sheet(height, label);
  const { pen } = place;
  place.drawnBy((samples, phase, colours) => {
    const { width } = place;
    const [top, floor] = [6, height - (bottom ? 34 : 8)];
    const first = Math.max(0, samples.length - SHOWN - 1);
    let [a, b] = [low, high];
    for (let i = first; i < samples.length; i++) {
      for (const { of } of lines) {
        const value = of(samples[i]);
        if (value < a) a = value;
        if (value > b) b = value;
      }
    }
    const step = roundStep(b - a, 4);
    [a, b] = [step * Math.floor(a / step + 0.01), step * Math.ceil(b / step - 0.01)];
    const room = width - MARGIN.left - MARGIN.right;
    const x = (i) => MARGIN.left + room * (1 - (samples.length - 1 - i + phase) / SHOWN);
    const y = (value) => top + ((b - value) / (b - a)) * (floor - top);
    pen.clearRect(0, 0, width, height);
    pen.font = "12px 'Source Sans 3', system-ui, sans-serif";
    pen.fillStyle = colours.ink;
    pen.textBaseline = "middle";
    pen.textAlign = "right";
    for (let value = a; value <= b + step / 2; value += step) {
      const text = String(Number(value.toPrecision(6))).replace("-", "−");
      pen.fillText(text, MARGIN.left - 6, y(value));
      pen.beginPath();
      pen.moveTo(MARGIN.left, y(value));
      pen.lineTo(width - MARGIN.right, y(value));
      stroke(pen, Math.abs(value) < step / 2 ? colours.soft : colours.line, 1);
    }
    if (bottom) {
      pen.textBaseline = "alphabetic";
      for (let s = 0; s <= 3; s++) {
        pen.textAlign = s ? (s === 3 ? "left" : "center") : "right";
        pen.fillText(s ? `−${s}` : "now", MARGIN.left + room * (1 - s / 3), floor + 15);
      }
      pen.textAlign = "center";
      pen.fillText("time, s", MARGIN.left + room / 2, height - 4);
    }
    pen.save();
    pen.beginPath();
    pen.rect(MARGIN.left, 0, room, floor + 4);
    pen.clip();
    pen.lineJoin = "round";
    for (const { of, colour, width: wide, dash } of lines) {
      pen.beginPath();
      let going = false;
      for (let i = first; i < samples.length; i++) {
        const value = of(samples[i]);
        if (value === undefined) going = false;
        else if (going) pen.lineTo(x(i), y(value));
        else pen.moveTo(x(i), y(value));
        going = value !== undefined;
      }
      stroke(pen, colours[colour], wide, dash);
    }
    pen.restore();
  });
  return place;
}

// The strip of positions under a window that stands: two rows of dots, the newest at the right.
export function strip({ height, label, width: samplesInWindow, lows, highs }) {
  const place = sheet(height, label);
  const { pen } = place;
  const format = (x) => `${Math.round((x * 180) / Math.PI)}°`.replace("-", "−");
  place.drawnBy((samples, phase, colours) => {
    const { width } = place;
    const [left, right] = [4, width - 14];
    const count = samplesInWindow * 2 + 1;
    const pitch = (right - left) / (count - 1);
    const from = right - (samplesInWindow - 0.5) * pitch;
    pen.clearRect(0, 0, width, height);
    pen.beginPath();
    pen.roundRect(from, 3, right - from + pitch / 2 + 2, height - 6, 6);
    pen.globalAlpha = 0.12;
    pen.fillStyle = colours.window;
    pen.fill();
    pen.globalAlpha = 1;
    stroke(pen, colours.window, 2);
    const middle = right - (samplesInWindow >> 1) * pitch;
    pen.beginPath();
    pen.moveTo(middle, 4);
    pen.lineTo(middle, height - 4);
    stroke(pen, colours.window, 1, [3, 3]);
    pen.save();
    pen.beginPath();
    pen.rect(left - 4, 0, width, height);
    pen.clip();
    const first = Math.max(0, samples.length - count - 1);
    const ranges = [];
    for (const j of JOINTS) {
      let [a, b] = [lows[j], highs[j]];
      for (let i = first; i < samples.length; i++) {
        a = Math.min(a, samples[i].q[j]);
        b = Math.max(b, samples[i].q[j]);
      }
      ranges.push([a, b]);
      const [top, floor] = [16 + (j * height) / 2, height / 2 - 8 + (j * height) / 2];
      pen.fillStyle = colours[j ? "elbow" : "shoulder"];
      for (let i = first; i < samples.length; i++) {
        const x = right - (samples.length - 1 - i + phase) * pitch;
        const y = top + ((b - samples[i].q[j]) / (b - a)) * (floor - top);
        pen.globalAlpha = x > from ? 1 : 0.45;
        pen.beginPath();
        pen.arc(x, y, x > from ? 3 : 2.2, 0, 7);
        pen.fill();
      }
    }
    pen.restore();
    pen.globalAlpha = 1;
    pen.font = "12px 'Source Sans 3', system-ui, sans-serif";
    pen.textBaseline = "middle";
    pen.textAlign = "left";
    JOINTS.forEach((j) => {
      pen.fillStyle = colours[j ? "elbow" : "shoulder"];
      const [low, high] = ranges[j].map((x) => format(x));
      pen.fillText(`${j ? "elbow" : "shoulder"}, ${low} to ${high}`, 0, 8 + (j * height) / 2);
    });
  });
  return place;
}

// Weights over a window as stems; `values` and the size of the largest are given at each drawing,
// and what stands pale behind them, if anything does.
export function stems({ height, label, colour }) {
  const place = sheet(height, label);
  const { pen } = place;
  place.drawnBy((values, largest, colours, pale = []) => {
    const { width } = place;
    const pitch = (width - 16) / (values.length - 1);
    const y = (value) => height / 2 - (value / largest) * (height / 2 - 5);
    pen.clearRect(0, 0, width, height);
    pen.beginPath();
    pen.moveTo(2, y(0));
    pen.lineTo(width - 2, y(0));
    stroke(pen, colours.soft, 1);
    pen.fillStyle = colours[colour];
    const size = Math.min(3, 0.45 * pitch);
    const each = (value, i) => {
      const x = 8 + i * pitch;
      pen.beginPath();
      pen.moveTo(x, y(0));
      pen.lineTo(x, y(value));
      stroke(pen, colours[colour], 1.5);
      pen.beginPath();
      pen.arc(x, y(value), size, 0, 7);
      pen.fill();
    };
    pen.globalAlpha = 0.3;
    pale.forEach(each);
    pen.globalAlpha = 1;
    values.forEach(each);
  });
  return place;
}
