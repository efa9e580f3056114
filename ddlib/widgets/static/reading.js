// Values of a chart: at the sample nearest to the pointer, or with focus at one that the arrow keys
// choose.

import { make, onKeys, put, short, swatch, write } from "./elements.js";
import { format, powerText } from "./numbers.js";

// A label such as "time, s" as a quantity and what follows a number.
export function unitOf(label) {
  const cut = label.lastIndexOf(", ");
  const unit = label.slice(cut + 2);
  return cut > 0 && unit.length <= 10 ? [label.slice(0, cut), unit] : [label, ""];
}

// `plot` has: el, svg, panel, curves, samples (places in px), top(), bottom(), left(), right(),
// base() of stems and bars, text(curve, i) and place(curve, i) of a value, in words and in px,
// and say(text).
export function readerOf(plot) {
  const { el, svg, panel, curves } = plot;
  const [quantity, unit] = unitOf(panel.x_label);
  const [low, high] = [panel.x[0], panel.x.at(-1)];
  const dots = curves.map(({ look }) => make("circle", { class: look, r: 4 }));
  const line = make("line", {});
  const marks = make("g", { class: "reading", visibility: "hidden", "aria-hidden": "true" }, line, ...dots);
  const where = make("div", { class: "where" });
  const outputs = curves.map(() => make("b"));
  const labels = curves.map(() => make("span"));
  const rows = curves.map((curve, i) => make("div", {}, swatch(curve.kind, curve.look), labels[i], outputs[i]));
  const box = make("div", { class: "readout", "aria-hidden": "true", hidden: "" }, where, ...rows);
  svg.append(marks);
  el.append(box);
  let index = null;

  function nameOf(i) {
    const tick = panel.ticks.find(([at]) => at === panel.x[i]);
    if (tick) return tick[1];
    const { x, x_scale } = panel;
    if (x_scale === "linear") return `${quantity} ${format(x[i], low, high, unit)}`;
    return `${quantity} ${powerText(Math.log10(x[i]))}${unit && `\u00a0${unit}`}`;
  }
  function show(i) {
    index = Math.min(panel.x.length - 1, Math.max(0, i));
    const x = plot.samples()[index];
    put(line, { x1: x, x2: x, y1: plot.top(), y2: plot.bottom() });
    curves.forEach((curve, k) => {
      const y = plot.place(curve, index);
      const inside = y >= plot.top() - 4 && y <= plot.bottom() + 4;
      dots[k].setAttribute("visibility", inside ? "inherit" : "hidden"); // a run may be over
      if (inside) dots[k].setAttribute("transform", `translate(${plot.across(curve, index)} ${short(y)})`);
      if (curves.length > 1) write(labels[k], `${curve.legend} `);
      write(outputs[k], plot.text(curve, index));
    });
    write(where, nameOf(index));
    marks.setAttribute("visibility", "visible");
    box.hidden = false;
    stand(x);
    const told = curves.map((curve, k) => `${curves.length > 1 ? `${curve.legend} ` : ""}${outputs[k].textContent}`);
    return `${where.textContent}: ${told.join(", ")}`;
  }
  // The box stands beside what is read, where it covers least of the curves.
  function stand(x) {
    const { width, height } = box.getBoundingClientRect();
    const [left, right] = [plot.left() + 6, plot.right() - width];
    const far = x < (plot.left() + plot.right()) / 2 ? [right, left] : [left, right];
    const away = (a) => a >= left && a <= right && (x < a - 8 || x > a + width + 8);
    const free = [...far, x - 10 - width, x + 10].filter(away);
    const drawn = curves.flatMap((curve) =>
      plot.samples().map((at, i) => {
        const y = plot.place(curve, i);
        const foot = curve.kind === "line" ? y : plot.base();
        return [at, Math.min(y, foot), Math.max(y, foot)];
      }),
    );
    const covered = ([a, b]) => {
      const under = ([at, top, foot]) => at > a && at < a + width && top < b + height && foot > b;
      return drawn.filter(under).length;
    };
    const levels = [plot.top(), plot.bottom() - height];
    const places = (free.length ? free : far).flatMap((a) => levels.map((b) => [a, b]));
    const counts = places.map(covered);
    const [across, down] = places[counts.indexOf(Math.min(...counts))];
    const top = svg.getBoundingClientRect().top - el.getBoundingClientRect().top;
    box.style.left = `${across}px`;
    box.style.top = `${Math.round(top + down)}px`;
  }
  function hide() {
    index = null;
    marks.setAttribute("visibility", "hidden");
    box.hidden = true;
  }
  const at = (event) => {
    const x = event.clientX - svg.getBoundingClientRect().left;
    const away = plot.samples().map((place) => Math.abs(place - x));
    show(away.indexOf(Math.min(...away)));
  };
  svg.addEventListener("pointermove", at);
  svg.addEventListener("pointerdown", at);
  svg.addEventListener("pointercancel", hide); // the page is being scrolled
  svg.addEventListener("pointerleave", (event) => {
    if (event.pointerType !== "touch" && document.activeElement !== svg) hide();
  });
  svg.addEventListener("blur", hide);
  let speaking = 0;
  function speak(text) {
    clearTimeout(speaking);
    speaking = setTimeout(() => plot.say(text), 200); // not every sample of a key held down
  }
  svg.addEventListener("focus", () => index ?? speak(show(Math.floor(panel.x.length / 2))));
  onKeys(svg, (event) => {
    const step = event.shiftKey ? 10 : 1;
    const now = index ?? 0;
    const next = { ArrowRight: now + step, ArrowLeft: now - step, Home: 0, End: panel.x.length - 1 };
    if (event.key === "Escape") hide();
    if (next[event.key] === undefined) return false;
    speak(show(next[event.key]));
  });
  return () => index === null || show(index);
}
