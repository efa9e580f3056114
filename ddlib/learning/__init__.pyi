from .autograd import (
    WindowNetwork as WindowNetwork,
)
from .autograd import (
    train as train,
)
from .descent import (
    Descent as Descent,
)
from .descent import (
    kernels as kernels,
)
from .descent import (
    prepare as prepare,
)
from .descent import (
    train_ensemble as train_ensemble,
)
from .levenberg_marquardt import (
    NotConverged as NotConverged,
)
from .levenberg_marquardt import (
    Solution as Solution,
)
from .levenberg_marquardt import (
    solve as solve,
)
from .network import (
    TorqueModel as TorqueModel,
)
from .network import (
    Weights as Weights,
)
from .span import (
    Directions as Directions,
)
from .span import (
    Lazy as Lazy,
)
from .span import (
    effective_steps as effective_steps,
)
from .span import (
    jacobian as jacobian,
)
from .span import (
    moved as moved,
)
from .span import (
    rows as rows,
)
from .span import (
    with_ones as with_ones,
)
from .surrogates import (
    MATCHED as MATCHED,
)
from .surrogates import (
    p_value as p_value,
)
from .surrogates import (
    related as related,
)
from .surrogates import (
    surrogate as surrogate,
)
from .surrogates import (
    surrogates as surrogates,
)
from .training import (
    TARGET_RANGE as TARGET_RANGE,
)
from .training import (
    WARM_UP_MOMENTUM as WARM_UP_MOMENTUM,
)
from .training import (
    History as History,
)
from .training import (
    TrainingDiverged as TrainingDiverged,
)
from .training import (
    TrainingSet as TrainingSet,
)
from .training import (
    WorseThanMean as WorseThanMean,
)
from .training import (
    cases as cases,
)
from .training import (
    default_rate as default_rate,
)
from .windows import (
    Scaler as Scaler,
)
from .windows import (
    check_width as check_width,
)
from .windows import (
    sliding_windows as sliding_windows,
)
