// What StirringPicker (beyond/stirring.py) adds to a CurveWidget: the workspace as a pad, in which
// the circle is dragged, and the refusal of circles that the hand cannot follow.

// Elbow and hand, m, of two links of given lengths at joint angles in degrees.
function armAt([l1, l2], first, second) {
  const [a, b] = [first, first + second].map((angle) => (angle * Math.PI) / 180);
  const elbow = [l1 * Math.cos(a), l1 * Math.sin(a)];
  return [elbow, [elbow[0] + l2 * Math.cos(b), elbow[1] + l2 * Math.sin(b)]];
}

extras.push((view) => {
  const { spec } = view;
  const { lengths, reach, box } = view.model.get("workspace");
  const [x0, y0, x1, y1] = box;
  const scale = 300 / (x1 - x0);
  const x = (v) => short(scale * (v - x0));
  const y = (v) => short(scale * (y1 - v));
  const places = ["distance", "bearing"].map((name) => spec.parameters.find((p) => p.name === name));
  const keys = places.map((p) => p.options.map(([key]) => key));
  const centreOf = (d, b) => [d * Math.cos((b * Math.PI) / 180), d * Math.sin((b * Math.PI) / 180)];
  const far = () => view.get("distance") + view.get("radius");
  const refused = () => far() >= reach[1] || view.get("distance") - view.get("radius") <= reach[0];

  const id = `${view.id}-clip`;
  const size = { width: 300, height: y(y0) };
  const clip = make("clipPath", { id }, make("rect", { x: 0, y: 0, ...size }));
  const area = make("circle", { class: "region", cx: x(0), cy: y(0), r: short(scale * reach[1]) });
  const grid = keys[0].flatMap((d) =>
    keys[1].map((b) => make("circle", { class: "place", cx: x(centreOf(d, b)[0]), cy: y(centreOf(d, b)[1]), r: 2 })),
  );
  const links = ["upper", "fore"].map((name) => make("line", { class: `link ${name}` }));
  const ring = make("circle", { class: "ring" });
  const handle = make("g", { class: "handle" }, make("circle", { r: 10 }), make("circle", { r: 2 }));
  const base = make("circle", { class: "joint", cx: x(0), cy: y(0), r: 6 });
  const elbow = make("circle", { class: "joint", r: 4 });
  const hand = make("circle", { class: "hand", r: 5 });
  const svg = make(
    "svg",
    { viewBox: `0 0 300 ${size.height}`, class: "pad workspace", tabindex: 0, role: "application" },
    make("rect", { x: 0, y: 0, ...size, class: "frame" }),
    clip,
    make("g", { "clip-path": `url(#${id})` }, area, ...grid, ring, ...links, base, elbow, hand, handle),
  );
  svg.setAttribute("aria-roledescription", "workspace from above");

  // The place of the grid that is nearest to a point, m.
  function nearest(px, py) {
    const [d, b] = [Math.hypot(px, py), (Math.atan2(py, px) * 180) / Math.PI];
    const closest = (list, v) => list.reduce((a, c) => (Math.abs(c - v) < Math.abs(a - v) ? c : a));
    return { distance: closest(keys[0], d), bearing: closest(keys[1], b) };
  }
  const drag = (event) => {
    const frame = svg.getBoundingClientRect();
    const across = (event.clientX - frame.left) / frame.width;
    const down = (event.clientY - frame.top) / frame.height;
    view.set(nearest(x0 + across * (x1 - x0), y1 - down * (y1 - y0)));
  };
  draggable(svg, besideOf(handle), drag);
  const steps = { ArrowRight: [1, 1], ArrowLeft: [1, -1], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  onKeys(svg, (event) => {
    const step = steps[event.key];
    if (!step) return false;
    const [which, by] = step;
    const now = keys[which].indexOf(view.get(places[which].name));
    const next = Math.min(Math.max(now + by, 0), keys[which].length - 1);
    view.set({ [places[which].name]: keys[which][next] });
  });

  const verdict = make("p", { class: "verdict" });
  const metres = (v) => `${v.toFixed(2)}\u00a0m`;
  const words = () =>
    refused()
      ? `Refused: the hand would have to be ${metres(far())} from the shoulder, and the arm would ` +
        `be stretched. It must stay within ${metres(reach[1])}.`
      : `Within reach: the hand comes as far as ${metres(far())} from the shoulder.`;
  view.words = () => [words().slice(0, -1)];
  const hands = view.charts.at(-1); // the hand's errors: beside what is dragged
  view.top.prepend(make("div", { class: "pad-box" }, svg, verdict, hands.el));
  view.el.classList.add("ddlib-stirring");

  const follow = (curves) => {
    const not = refused();
    const [cx, cy] = centreOf(view.get("distance"), view.get("bearing"));
    put(ring, { cx: x(cx), cy: y(cy), r: short(scale * view.get("radius")) });
    ring.classList.toggle("refused", not);
    handle.setAttribute("transform", `translate(${x(cx)} ${y(cy)})`);
    const [a, b] = armAt(lengths, curves["shoulder angle"][0], curves["elbow angle"][0]);
    put(links[0], { x1: x(0), y1: y(0), x2: x(a[0]), y2: y(a[1]) });
    put(links[1], { x1: x(a[0]), y1: y(a[1]), x2: x(b[0]), y2: y(b[1]) });
    put(elbow, { cx: x(a[0]), cy: y(a[1]) });
    put(hand, { cx: x(b[0]), cy: y(b[1]) });
    for (const el of [...links, elbow, hand]) el.style.display = not ? "none" : "";
    for (const el of [view.charts[0].el.parentElement, hands.el]) el.classList.toggle("refused", not); // their place stays
    write(verdict, words());
    const now = places.map((p) => `${p.label} ${show(p, view.get(p.name))}`).join(", ");
    svg.setAttribute(
      "aria-label",
      `Centre of the circle: right and left change its direction, up and down its distance. Now ${now}`,
    );
  };
  view.after.push(follow);
  follow(view.curves);
});
