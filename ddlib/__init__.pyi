from . import (
    analysis as analysis,
    control as control,
    dynamics as dynamics,
    effects as effects,
    figures as figures,
    identification as identification,
    learning as learning,
    logs as logs,
    metrics as metrics,
    paper as paper,
    setups as setups,
    simulation as simulation,
    tables as tables,
    trajectories as trajectories,
    widgets as widgets,
)
from .analysis import (
    classify as classify,
    decompose as decompose,
    frequency_response as frequency_response,
    gains as gains,
    savitzky_golay as savitzky_golay,
    upright as upright,
)
from .control import (
    PID as PID,
    ComputedTorque as ComputedTorque,
    pd as pd,
    proportional as proportional,
)
from .dynamics import (
    CMU_DD_ARM_II as CMU_DD_ARM_II,
    Arm as Arm,
    Link as Link,
    SerialArm as SerialArm,
    derive as derive,
)
from .effects import (
    CMU_DD_ARM_II_EFFECTS as CMU_DD_ARM_II_EFFECTS,
    CoulombFriction as CoulombFriction,
    Effects as Effects,
    Quantisation as Quantisation,
    ViscousFriction as ViscousFriction,
)
from .identification import (
    by_modulation as by_modulation,
    least_squares as least_squares,
    true_parameters as true_parameters,
)
from .learning import (
    TorqueModel as TorqueModel,
    TrainingSet as TrainingSet,
    Weights as Weights,
    WindowNetwork as WindowNetwork,
    cases as cases,
    sliding_windows as sliding_windows,
    solve as solve,
    train as train,
    train_ensemble as train_ensemble,
)
from .metrics import (
    rmss as rmss,
)
from .setups import (
    JOINT_DAMPING as JOINT_DAMPING,
    POSITION_FEEDBACK as POSITION_FEEDBACK,
    SETUPS as SETUPS,
    STATE_FEEDBACK as STATE_FEEDBACK,
    Setup as Setup,
    errors as errors,
    split as split,
)
from .simulation import (
    Recording as Recording,
    follow as follow,
    record as record,
    simulate as simulate,
)
from .trajectories import (
    APPENDIX_I as APPENDIX_I,
    pick_and_place as pick_and_place,
    random_extents as random_extents,
)

__version__: str
