"""Window networks: windows of positions, weights, and ways to train them.

- ``windows``: windows of positions, cut from a recording, and their scaling
- ``network``: `Weights` as arrays, the same network in PyTorch, `TorqueModel` from rad to N m
- ``training``, ``descent``: training sets, and descent with momentum, of one network or many
- ``surrogates``: targets that look like torques and have nothing to do with the motion
- ``levenberg_marquardt``, ``gauss_newton``: the optimum by second-order steps
- ``span``: directions of the windows, how fast each is learnt, training of the linearised network
- ``parity_networks``: the parity example of section 1.1
"""

from ddlib._names import hand_on

__getattr__, __dir__, __all__ = hand_on(
    __name__,
    windows="Scaler check_width sliding_windows",
    surrogates="KINDS LEAST_SHIFT MATCHED p_value related surrogate surrogates",
    network="TorqueModel Weights WindowNetwork kernels",
    descent="Descent prepare",
    training=(
        "BLOCK History MAX_RATE TARGET_RANGE TrainingDiverged TrainingSet WARM_UP_MOMENTUM WORKERS "
        "cases check_points default_rate train train_ensemble"
    ),
    gauss_newton="Objective penalty",
    levenberg_marquardt="NotConverged Solution solve",
    span="Course Directions Lazy effective_steps jacobian moved rows with_ones",
    parity_networks=(
        "CODINGS MOST_BITS NETWORKS UnitNetwork counter direct learn monomials one_layer parity "
        "parity_cases patterns right tree"
    ),
)
