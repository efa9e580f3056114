// What TurnTheParabola (knob.py) adds to a CurveWidget: charts in a line that fits a screen with the handle.

import { extras } from "ddlib/curves.js";

extras.push(({ el }) => el.classList.add("ddlib-knob"));
