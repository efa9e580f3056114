// Dragging in a drawing, by mouse, pen or finger.

const GRIP = 24; // px around a handle in which a finger takes hold of it
const ASIDE = 8; // px sideways after which a touch elsewhere is a drag

// Whether a pointer is at a handle.
export const besideOf = (handle) => ({ clientX, clientY }) => {
  const box = handle.getBoundingClientRect();
  const away = [clientX - box.x - box.width / 2, clientY - box.y - box.height / 2];
  return Math.hypot(...away) <= Math.max(GRIP, box.width / 2);
};

// Whether a pointer is above, within or below a band or an upright line.
export const withinOf = (band) => ({ clientX }) => {
  const { x, width } = band.getBoundingClientRect();
  return Math.abs(clientX - x - width / 2) <= Math.max(GRIP, width / 2);
};

// By mouse or pen anywhere; by touch from where `near(event)` holds, or sideways, or by a tap, so that
// a vertical swipe from elsewhere scrolls the page. begin(event) is called where a drag begins,
// move(event) at every place that it reaches.
export function draggable(svg, near, move, begin = move) {
  let waiting = null; // a touch elsewhere, until it is known what it becomes
  const start = (event) => {
    waiting = null;
    svg.setPointerCapture(event.pointerId);
    begin(event);
  };
  svg.style.touchAction = "pan-y";
  svg.addEventListener("touchstart", (event) => near(event.touches[0]) && event.preventDefault(), { passive: false });
  svg.addEventListener("pointerdown", (event) => {
    if (event.button || !event.isPrimary) return;
    svg.focus({ preventScroll: true });
    if (event.pointerType === "touch" && !near(event)) return void (waiting = event);
    event.preventDefault(); // of the focus and the selection that would follow
    start(event);
  });
  svg.addEventListener("pointermove", (event) => {
    if (waiting && Math.abs(event.clientX - waiting.clientX) > ASIDE) start(waiting);
    if (!waiting && event.buttons && svg.hasPointerCapture(event.pointerId)) move(event);
  });
  svg.addEventListener("pointerup", () => {
    if (waiting) begin(waiting); // a tap
    waiting = null;
  });
  svg.addEventListener("pointercancel", () => (waiting = null));
}
