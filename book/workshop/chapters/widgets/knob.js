// What TurnTheParabola (knob.py) and UnitFromFiveStarts (starts.py) add to a CurveWidget: three charts in a
// line that fits a screen with the handle.

import { extras } from "ddlib/curves.js";

extras.push(({ el }) => el.classList.add("ddlib-knob"));
