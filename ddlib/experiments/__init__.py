"""The paper's experiments, as this book repeats them: set-ups, studies, committed results.

- ``setups``: the experiment of section 4, every choice in one place; its errors
- ``exact_states``: the same for section 6; ``two_harmonics``: other motions
- ``extents``: trajectories all over the square of extents
- ``knobs``: what decides the table: a design, a regression, what the printed numbers speak for
- ``studies``: what is too slow for a chapter, a function for each result
- ``reproduce``: runs studies, ``make reproduce``; an outcome lies in ``book/results/NAME.json``
- ``results``: reads these files; ``code_hash``: tells which code made them
- ``sweeps``: one experiment over many settings, kept and resumed
- ``status``: tables of the page *Status*
"""

from ddlib._names import hand_on

__getattr__, __dir__, __all__ = hand_on(
    __name__,
    "code_hash",
    "reproduce",
    "results",
    "status",
    "studies",
    "sweeps",
    setups=(
        "COURSE Errors JOINT_DAMPING KD KP LITERATURE POSITION_FEEDBACK SETUPS STATE_FEEDBACK "
        "Setup WINDOWS errors predict solve_windows split train_windows"
    ),
    extents="HULL Square inside_hull square",
    exact_states="EPOCHS RADIUS RATE SAMPLES random_states states_along torque",
    knobs=(
        "Emulator Knob METHODS knobs_of left_out moments screening shares spread_evenly terms "
        "weigh without_start would_tell"
    ),
    two_harmonics=(
        "NEUTRAL ORDER record_circle record_quintic record_two_harmonics second_amplitudes SHARE "
        "true_states"
    ),
)
