"""*Run this page*: in a page this is `ipywidgets`: sliders, `interact` and `link`, nothing else."""

from __future__ import annotations

import functools

import anywidget
import kernel
import traitlets
from traitlets import dlink, link  # noqa: F401

ESM = """
export default { render({ model, el }) {
  const label = document.createElement("label");
  const range = document.createElement("input");
  const shown = document.createElement("output");
  range.type = "range";
  const show = () => {
    for (const name of ["min", "max", "step", "value"]) range[name] = model.get(name);
    shown.textContent = model.get("value");
  };
  range.addEventListener("input", () => {
    model.set("value", Number(range.value));
    model.save_changes();
    show();
  });
  model.on("change", show);
  show();
  label.append(model.get("description"), range, shown);
  label.style.cssText = "display:flex;flex-wrap:wrap;gap:.6rem;align-items:center";
  el.append(label);
  return () => model.off("change", show);
} };
"""


class _Slider(anywidget.AnyWidget):
    """A number within its range; what is set beyond it ends on it."""

    _esm = ESM
    description = traitlets.Unicode().tag(sync=True)

    @traitlets.validate("value")
    def _within(self, proposal):
        return min(max(proposal["value"], self.min), self.max)


class FloatSlider(_Slider):
    """A slider of numbers."""

    min, max = traitlets.CFloat(0.0).tag(sync=True), traitlets.CFloat(100.0).tag(sync=True)
    step, value = traitlets.CFloat(0.1).tag(sync=True), traitlets.CFloat().tag(sync=True)


class IntSlider(_Slider):
    """A slider of whole numbers."""

    min, max = traitlets.CInt(0).tag(sync=True), traitlets.CInt(100).tag(sync=True)
    step, value = traitlets.CInt(1).tag(sync=True), traitlets.CInt().tag(sync=True)

    def __init__(self, value=0, **traits):
        super().__init__(**{"value": value, **traits})


def interact(function=None, **sliders):
    """Call a function now, and again whenever one of the sliders of its arguments moves."""
    if function is None:
        return functools.partial(interact, **sliders)

    def call(*_):
        return function(**{name: slider.value for name, slider in sliders.items()})

    for name, slider in sliders.items():
        slider.description = slider.description or name
        kernel.display(slider)
        slider.observe(call, "value")
    call()
    return function


def __getattr__(name):
    if name.startswith("__"):
        raise AttributeError(name)
    raise ImportError(
        f"ipywidgets.{name} is not in this page, which has sliders, interact and link"
    )
