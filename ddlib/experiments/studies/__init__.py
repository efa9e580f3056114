"""What is too slow for a chapter: the studies that ``make reproduce`` repeats.

Every study is a function without required arguments that returns a plain dictionary; `PARTS`
names them all. ``python -m ddlib.experiments.reproduce NAME`` runs one.

- ``table``, ``knobs``: Table 4-1, on other days, longer, with clean sensors; which knobs decide it
- ``windows``, ``inputs``: window sizes, hidden units, states in place of windows, acceleration
- ``nulls``, ``harmonics``: unrelated torques, other starts and ends; other motions
- ``span``: learning curves along the directions of the windows
- ``states``, ``states_sizes``: section 6
- ``beyond``: Part IV, rivals and a real arm
- ``loop``: Part IV, closing the loop
- ``page``: what readers try in the pages: networks trained there, a learner in the loop
"""

from __future__ import annotations

from collections.abc import Callable

from ddlib.experiments.studies import (
    harmonics,
    inputs,
    knobs,
    nulls,
    span,
    states,
    states_sizes,
    table,
    windows,
)
from ddlib.experiments.studies.beyond import (
    characters,
    intervals,
    real_arm,
    rivals,
    rivals_1988,
)
from ddlib.experiments.studies.loop import adaptive, joints, learning, run_time, stirring
from ddlib.experiments.studies.loop.runs import conditions
from ddlib.experiments.studies.page import learner, training

PARTS: dict[str, Callable[[], dict]] = {
    "table-4-1": table.table_4_1,
    "recordings": table.recordings,
    "screened": knobs.screened,
    "longer": table.longer,
    "clean": table.clean,
    "window-sizes": windows.window_sizes,
    "hidden-units": windows.hidden_units,
    "memory": windows.memory,
    "state-inputs": inputs.state_inputs,
    "acceleration": inputs.acceleration,
    "null-controls": nulls.null_controls,
    "filter-trial": nulls.filter_trial,
    "filter-trial-elsewhere": nulls.filter_trial_elsewhere,
    "span": span.span,
    "page-training": training.page_training,
    "loop-learner": learner.loop_learner,
    "harmonics": harmonics.harmonics,
    "table-6-1": states.table_6_1,
    "state-space-choices": states.state_space_choices,
    "state-space-sizes": states_sizes.state_space_sizes,
    "rivals": rivals.rivals,
    "rivals-tables": rivals_1988.rivals_tables,
    "rivals-cmac": rivals_1988.rivals_cmac,
    "rivals-bases": rivals_1988.rivals_bases,
    "real-arm": real_arm.real_arm,
    "characters": characters.characters,
    "gaussian-intervals": intervals.gaussian_intervals,
    "run-time": run_time.run_time,
    "joints": joints.joints,
    "stirring": stirring.stirring,
    "adaptive": adaptive.adaptive,
    "learning-in-the-loop": learning.learning_in_the_loop,
    "loop-conditions": conditions.loop_conditions,
}
"""The studies by the name of their result."""
