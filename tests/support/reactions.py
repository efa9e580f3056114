"""What a reader does with a widget, and what becomes of its picture."""

from __future__ import annotations

# What a widget draws: where its shapes are, and the pixels of its canvases.
PICTURE = """
(widget) => {
  const places = ["d", "points", "transform", "x", "y", "x1", "y1", "x2", "y2", "cx", "cy", "r",
                  "width", "height", "class"];
  const shapes = [...widget.querySelectorAll("svg *")].map(
    (el) => places.map((name) => el.getAttribute(name) ?? "").join(" "));
  const pixels = [...widget.querySelectorAll("canvas")].map((el) => el.toDataURL());
  const words = [...widget.querySelectorAll(".sentence output")].map((el) => el.textContent);
  return [...shapes, ...pixels, ...words].join("\\n");
}
"""
FRAMES = "() => new Promise((f) => requestAnimationFrame(() => requestAnimationFrame(f)))"
DRAWING = 'svg[tabindex="0"]:not(.chart > svg), svg [tabindex="0"]'  # charts only tell values
SLIDER = 'input[type="range"]'
SWITCH = 'input[role="switch"]'
NUMBER = '[role="spinbutton"]'
BUTTON = ".presets button"  # of which one is pressed, the first at the start


def handles(root) -> list[Handle]:
    """The first drawing (or part of one) that can be dragged and the first slider of a widget.

    Where there is neither, the first switch or number, or a button that chooses what is shown.
    A fold is opened first.
    """
    root.locator("details").evaluate_all("(all) => all.forEach((fold) => (fold.open = true))")
    for kinds in ((DRAWING, SLIDER), (SWITCH, NUMBER), (BUTTON,)):
        found = [root.locator(kind).locator("visible=true") for kind in kinds]
        if some := [Handle(root, kind.first) for kind in found if kind.count()]:
            return some
    return []


class Handle:
    """Something in a mounted widget that takes a drag, keys and a touch."""

    def __init__(self, root, handle):
        self.root, self.handle, self.page = root, handle, root.page

    def picture(self) -> str:
        """All that is drawn, two frames from now."""
        self.page.evaluate(FRAMES)
        return self.root.evaluate(PICTURE)

    def _stands(self) -> float | None:
        """How far along its way a slider stands."""
        return self.handle.evaluate(
            "(el) => (el.max ? (el.value - el.min) / (el.max - el.min) : null)"
        )

    def _far(self) -> float:
        """How far across the handle is a place away from where it stands."""
        stands = self._stands()
        return 0.7 if stands is None else 0.9 if stands < 0.5 else 0.1

    def _point(self, across: float, up: float = 0.5) -> tuple[float, float]:
        """A place on the handle, by parts of its width and height."""
        self.handle.scroll_into_view_if_needed()
        box = self.handle.bounding_box()
        return box["x"] + across * box["width"], box["y"] + (1 - up) * box["height"]

    def drag(self) -> None:
        """With the mouse, from the middle to a place far from where the handle stands."""
        if self._is_button():
            return self._next().click()
        far = self._far()
        self.page.mouse.move(*self._point(0.5))
        self.page.mouse.down()
        for part in (0.25, 0.5, 0.75, 1.0):
            self.page.mouse.move(*self._point(0.5 + part * (far - 0.5), 0.5 + 0.1 * part))
        self.page.mouse.up()

    def press(self) -> None:
        """A key that goes to where there is room."""
        if self.handle.get_attribute("role") == "switch":
            return self.handle.press("Space")
        if self._is_button():
            pressed = self.handle.get_attribute("aria-pressed") == "true"
            return (self._next() if pressed else self.handle).press("Enter")
        stands, before = self._stands(), self.picture()
        keys = ("ArrowRight", "ArrowLeft") if stands is None else ("End", "Home")
        self.handle.focus()
        self.page.keyboard.press(keys[0] if (stands or 0) < 0.5 else keys[1])
        if stands is None and self.picture() == before:
            self.page.keyboard.press(keys[1])

    def _is_button(self) -> bool:
        return self.handle.evaluate("(el) => el.matches('button')")

    def _next(self):
        """The button after this one."""
        return self.handle.locator("xpath=following-sibling::button[1]")

    def tap(self) -> None:
        """With a finger."""
        if self._is_button():
            return self._next().tap()
        self.page.touchscreen.tap(*self._point(self._far()))
        plus = self.handle.locator("xpath=following-sibling::*//button").last
        if self.handle.get_attribute("role") == "spinbutton" and plus.is_visible():
            plus.tap()
