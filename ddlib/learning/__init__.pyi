from .autograd import (
    TorqueNetwork as TorqueNetwork,
    WindowNetwork as WindowNetwork,
    module_gradient as module_gradient,
    train as train,
)
from .descent import (
    Descent as Descent,
    kernels as kernels,
    prepare as prepare,
    train_ensemble as train_ensemble,
)
from .levenberg_marquardt import (
    NotConverged as NotConverged,
    Solution as Solution,
    solve as solve,
)
from .network import (
    INITIAL as INITIAL,
    TorqueModel as TorqueModel,
    Weights as Weights,
)
from .span import (
    Directions as Directions,
    Lazy as Lazy,
    effective_steps as effective_steps,
    jacobian as jacobian,
    with_change as with_change,
    with_ones as with_ones,
)
from .surrogates import (
    MATCHED as MATCHED,
    p_value as p_value,
    related as related,
    surrogate as surrogate,
    surrogates as surrogates,
)
from .training import (
    TARGET_RANGE as TARGET_RANGE,
    WARM_UP_MOMENTUM as WARM_UP_MOMENTUM,
    History as History,
    TrainingDiverged as TrainingDiverged,
    TrainingInterrupted as TrainingInterrupted,
    TrainingSet as TrainingSet,
    WorseThanMean as WorseThanMean,
    cases as cases,
    default_rate as default_rate,
)
from .windows import (
    Scaler as Scaler,
    check_width as check_width,
    sliding_windows as sliding_windows,
)
