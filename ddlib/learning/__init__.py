"""Window networks: windows of positions, weights, and ways to train them.

- ``windows``: windows of positions, cut from a recording, and their scaling
- ``network``: `Weights` as arrays, `TorqueModel` from rad to N m
- ``training``: training sets, and the errors along a training run
- ``autograd``, ``descent``: descent with momentum, of one network in PyTorch or of many
- ``surrogates``: targets that look like torques and have nothing to do with the motion
- ``levenberg_marquardt``, ``gauss_newton``: the optimum by second-order steps
- ``span``: directions of the windows, how fast each is learnt, training of the linearised network
- ``parity_networks``: the parity example of section 1.1

Only ``autograd``, ``descent``, ``levenberg_marquardt`` and ``gauss_newton`` need PyTorch.
"""

from ddlib._names import hand_on

__getattr__, __dir__, __all__ = hand_on(
    __name__,
    windows="Scaler check_width sliding_windows",
    surrogates="MATCHED p_value related surrogate surrogates",
    network="TorqueModel Weights",
    training=(
        "History TARGET_RANGE TrainingDiverged TrainingSet WARM_UP_MOMENTUM WorseThanMean "
        "cases default_rate"
    ),
    autograd="WindowNetwork train",
    descent="Descent kernels prepare train_ensemble",
    levenberg_marquardt="NotConverged Solution solve",
    span="Directions Lazy effective_steps jacobian moved rows with_ones",
    parity_networks=(
        "CODINGS MOST_BITS NETWORKS UnitNetwork counter direct learn monomials one_layer parity "
        "parity_cases patterns right tree"
    ),
)
