"""Pick-and-place learnt as the report learnt it, by descent; then the hand is asked for circles."""

import numpy as np

from beyond.control.windowed import WindowFeedforward
from beyond.studies.loop import motions, stirring
from ddlib.learning import TrainingSet, Weights, train_ensemble
from ddlib.setups import JOINT_DAMPING
from ddlib.trajectories import pick_and_place, random_extents
from workshop.report.code_hash import study


@study
def _stirring_descent(days: int = 10, members: int = 20) -> dict:
    """Training errors, and medians of the hand's errors on the tests of the study ``stirring``."""
    setup, width, t = JOINT_DAMPING, stirring._WIDTH, motions.times()
    how = {"rate": setup.rate / width, "momentum": setup.momentum, "warm_up": setup.warm_up}
    how |= {"epochs": setup.epochs, "progress": False}
    models, training = [], []
    for day, runs in enumerate(motions.training(setup, range(days))):
        data = TrainingSet.from_recording(runs["pick and place"], width, scaling=setup.scaling)
        start = Weights.random(1, width, setup.hidden, initial=setup.initial, seed=day)
        model, history, _ = train_ensemble(start, data, **how)
        models.append(WindowFeedforward(model[0].torque, width))
        training.append(history.training[-1, 0])
    asked = {
        "circles": motions.stirred(setup.arm, motions.random_circles(members, motions.TEST_DAY), t),
        "pick and place": pick_and_place(random_extents(members, motions.TEST_DAY), t),
    }
    result: dict = {"training": training, "hands": {}}
    for motion, reference in asked.items():
        torques = {"none": [0 * reference.q], "network": [box(*reference) for box in models]}
        hands = stirring.hand_errors(setup.repeated(motions.TEST_DAY), torques, reference)
        result["hands"][motion] = {name: np.median(off, -1) for name, off in hands.items()}
    return result
