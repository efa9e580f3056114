"""Window filters learnt with the equations: beside the rivals, one by one, on a real arm, read.

Expected before the study ran, after trials of days 1 to 3 (medians): .031 to .036 on trajectory 6,
.042 to .048 inside, .040 to .045 outside with 21 samples; the acceleration filter alone gains more
than half of it; on the real arm .16 to .18 with 21 samples, where the equations alone leave .21.
Positions from an encoder that the controller does not see have not been tried before.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import joblib
import numpy as np

from beyond.rivals.identified import Linear
from beyond.rivals.protocol import Cases
from beyond.studies.lineup import _DAYS
from beyond.studies.rivals import _EVERY, SQUARE_POINTS, WINDOW, square_recordings
from beyond.studies.tx40 import BLOCKS, Windowed, known_structure, wrong
from ddlib.analysis import frequency_response
from ddlib.identification import (
    FRICTION,
    RIGID,
    FilteredEquations,
    joint_terms,
    true_parameters,
)
from ddlib.metrics import rmss
from ddlib.setups import JOINT_DAMPING, split
from ddlib.simulation import LOG_STEP, Recording
from workshop.report.code_hash import study

PARAMETER_NAMES = RIGID + FRICTION
_FILTERS = ("position", "velocity", "acceleration")
_WIDTHS = (WINDOW, 31)  # that of the rivals, and a wider one
_REAL = ((100, 5), (100, 11), (100, 21))  # samples a second and window of the real arm
_CARRIED = 1e-3  # pull on the real arm: what leaving out runs chose on the other arm's first day
_HERTZ = np.linspace(0, 50, 101)


def _other_encoder(recording: Recording, day: int) -> Recording:
    """The same motions as a second encoder reads them, whose rounding the controller never saw."""
    (encoder,), rng = JOINT_DAMPING.effects.encoder, np.random.default_rng((day, 2))
    zero = rng.uniform(0, encoder.step, 2)
    q = np.round((recording.q_true + zero) / encoder.step) * encoder.step - zero
    return replace(recording, q=q)


def recorded_parts(day: int) -> dict[str, tuple[Recording, int]]:
    """As in the study of rivals: recordings, and every how many samples they are asked."""
    setup = JOINT_DAMPING.repeated(day)
    training, six = split(setup.record())
    whole = square_recordings(setup, SQUARE_POINTS)
    inside, outside = whole.recording[whole.inside], whole.recording[~whole.inside]
    return {"training": (training, 1), "trajectory 6": (six, 1), "inside": (inside, _EVERY),
            "outside": (outside, _EVERY)}  # fmt: skip


def _errors(predict, parts, width) -> dict[str, float]:
    """RMSS of each part, pooled over joints, over the part's own deviation."""
    sets = {name: Cases.windows(r, width)[::every] for name, (r, every) in parts.items()}
    return {name: float(rmss(predict(c.x), c.torque)) for name, c in sets.items()}


def _fitted(parts, width, pull=None, learn=_FILTERS) -> tuple[FilteredEquations, dict]:
    """The equations with learnt filters, and their errors."""
    training = parts["training"][0]
    equations = FilteredEquations(PARAMETER_NAMES, width, training.step, pull, learn).fit(training)
    return equations, _errors(equations.predict, parts, width)


def _day(day: int) -> dict:
    """All of one day of the simulated arm."""
    parts, result = recorded_parts(day), {"errors": {}, "found": {}}
    for width in _WIDTHS:
        equations, result["errors"][str(width)] = _fitted(parts, width)
        fixed, result["errors"][f"{width}, none learnt"] = _fitted(parts, width, 1.0, ())
        true = true_parameters(JOINT_DAMPING.arm, JOINT_DAMPING.effects, PARAMETER_NAMES)
        result["found"][str(width)] = {
            "pull": equations.pull,
            "filters": equations.filters,
            "errors of filters": equations.filter_errors,
            "parameters": equations.estimate.values,
            "fixed": fixed.estimate.values,
            "covered": replace(equations.estimate, unsure=None).covers(true),
        }
        if width == WINDOW:
            for number in (1, 2):
                for learn in combinations(_FILTERS, number):
                    name = " and ".join(learn)
                    result["errors"][name] = _fitted(parts, width, equations.pull, learn)[1]
    others = {name: (_other_encoder(r, day), every) for name, (r, every) in parts.items()}
    equations, result["errors"]["other encoder"] = _fitted(others, WINDOW)
    result["found"]["other encoder"] = {"filters": equations.filters}
    result["errors"]["other encoder, none learnt"] = _fitted(others, WINDOW, 1.0, ())[1]
    linear = Linear().fit(Cases.windows(others["training"][0], WINDOW))
    result["errors"]["other encoder, linear filter"] = _errors(linear._torque, others, WINDOW)
    return result


def _read(filters, step: float) -> dict:
    """What filters ``(3, width)`` do: delay at slow motion, s, noise gain, size over frequency."""
    times = (np.arange(filters.shape[1]) - filters.shape[1] // 2) * step
    middle = filters.shape[1] // 2
    return {
        # the response to the next higher power: of a derivative that is late it is minus the delay
        "delay": -np.array([f @ times ** (k + 1) for k, f in enumerate(filters)]) / (1, 2, 6),
        "noise gain": np.linalg.norm(filters, axis=1),
        # how far the middle weight stands out from its neighbours
        "spike": filters[:, middle] - filters[:, [middle - 1, middle + 1]].mean(1),
        "size": np.abs(frequency_response(filters, _HERTZ, step)),
    }


def _real(rate: int, width: int, block: int) -> dict:
    """One block of the real arm, predicted from the others."""
    data = Windowed.of(rate, width)
    training, test = data.fold(block)
    x, current, states = data.x, data.current, data.states
    equations = FilteredEquations(joint_terms, width, data.step, _CARRIED)
    equations.fit([x[training]], [current[training]])
    known = known_structure(states[training], current[training], states[test])
    return {
        "equations": wrong(known, data, test).mean(),
        "learnt": wrong(equations.predict(x[test]), data, test).mean(),
        "training": wrong(equations.predict(x[training]), data, training).mean(),
        "filters": equations.filters,
    }


@study
def _learnt_filters() -> dict:
    """Errors by day, which filters matter, what they are; the real arm's errors by block."""
    jobs = [(*where, block) for where in _REAL for block in range(BLOCKS)]
    with joblib.parallel_config("loky", n_jobs=-1, inner_max_num_threads=1):
        days = joblib.Parallel()(joblib.delayed(_day)(day) for day in range(1, _DAYS + 1))
        blocks = joblib.Parallel()(joblib.delayed(_real)(*job) for job in jobs)
    errors = {
        name: {part: [day["errors"][name][part] for day in days] for part in row}
        for name, row in days[0]["errors"].items()
    }
    readings = {}
    for name, row in days[0]["found"].items():
        each = {key: np.array([day["found"][name][key] for day in days]) for key in row}
        width = each["filters"].shape[-1]
        first = FilteredEquations(PARAMETER_NAMES, width, LOG_STEP).first
        each["spread of filters"] = each["filters"].std(0)
        each["filters"] = each["filters"].mean(0)
        if "errors of filters" in each:
            each["errors of filters"] = np.median(each["errors of filters"], 0)
        readings[name] = each | {
            "read": _read(each["filters"], LOG_STEP),
            "first": _read(first, LOG_STEP),
        }
    real = {}
    for (rate, width, _), block in zip(jobs, blocks):
        row = real.setdefault(f"{rate}, {width}", {key: [] for key in block})
        for key, value in block.items():
            row[key].append(value)
    for row in real.values():
        row["filters"] = np.mean(row["filters"], 0)
    return {
        "days": _DAYS,
        "names": PARAMETER_NAMES,
        "true": true_parameters(JOINT_DAMPING.arm, JOINT_DAMPING.effects, PARAMETER_NAMES),
        "numbers": {str(w): 3 * w + len(PARAMETER_NAMES) for w in _WIDTHS},
        "hertz": _HERTZ,
        "errors": errors,
        "found": readings,
        "carried": _CARRIED,
        "real": real,
    }
