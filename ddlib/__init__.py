"""A two-link arm, its control, and networks that learn its dynamics.

Record an arm that follows a reference, train window networks on it, read their weights::

    import ddlib

    recording = ddlib.STATE_FEEDBACK.record()            # the six runs of Appendix I
    training, test = ddlib.split(recording)
    data = ddlib.TrainingSet.from_recording(training, width=11)
    weights = ddlib.Weights.random(4, 11)                # four networks
    model, history, _ = ddlib.train_ensemble(weights, data, epochs=500)
    x, torque = ddlib.cases(test, 11)
    print(ddlib.rmss(model.torque(x), torque))           # error on the sixth run
    parts = ddlib.decompose(model.weights.hidden_weights)  # constant, even and odd parts

The names above come from these packages, which hold more; they stand in the order in which data
flows, and each may import those above it, none below it::

    _check            argument checks: errors name the argument, its value and its range
    paper             the paper's printed numbers
    metrics           the paper's error measure, RMSS
    tables            tables, numbers as text, and `quote` for the prose of a page
    trajectories      reference motions: the pick-and-place family of Appendix I
    dynamics          the rigid body: arms, equations of motion, what computing them costs
    effects           what the rigid body leaves out: friction, motors, encoders
    control           controllers, and the linear analysis of their loops
    simulation        arm, controller and sensors together: recordings
    logs              files of a reader's own arm: read, resampled, checked
    identification    parameters of an arm from recordings
    learning          windows, networks and their training (needs PyTorch)
    analysis          what weights do and what data allow: filters, hidden units, noise
    setups            the experiment of section 4: every choice in one place
    figures           the house style, and the kinds of figure that chapters share
    widgets           interactive figures, with a kernel and without
"""

import lazy_loader

__version__ = "0.1.0.dev0"

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
