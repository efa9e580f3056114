// Drawing on canvases in the colours of the page.

import { make } from "./elements.js";

// A canvas as wide as its place and `place.height` high, drawn in pixels of the page.
export function sheet(height, label = "") {
  const el = make("canvas", { role: "img", "aria-label": label, style: `height: ${height}px` });
  const pen = el.getContext("2d");
  const place = { el, pen, width: 0, height };
  // What draws on it, which nothing does while it has no width.
  place.drawnBy = (draw) => (place.draw = (...given) => place.width && draw(...given));
  place.resize = () => {
    const ratio = window.devicePixelRatio || 1;
    place.width = el.clientWidth;
    el.style.height = `${place.height}px`;
    el.width = Math.round(place.width * ratio);
    el.height = Math.round(place.height * ratio);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  };
  return place;
}

const TONES = ["ink", "soft", "line", "paper", "shoulder", "elbow", "network", "window", "constant", "even", "odd", "wanted"];

// The colours of the page, by the names of their variables.
export function coloursOf(el) {
  const probe = el.appendChild(make("span"));
  const colours = TONES.map((name) => {
    probe.style.color = `var(--${name})`;
    return [name, getComputedStyle(probe).color];
  });
  probe.remove();
  return Object.fromEntries(colours);
}

export function stroke(pen, colour, width, dash = []) {
  pen.strokeStyle = colour;
  pen.lineWidth = width;
  pen.setLineDash(dash);
  pen.stroke();
}
