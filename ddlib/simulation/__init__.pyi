from .loops import (
    Load as Load,
)
from .loops import (
    SecondOrderModel as SecondOrderModel,
)
from .loops import (
    feedforward_system as feedforward_system,
)
from .loops import (
    predicted_response as predicted_response,
)
from .loops import (
    run_system as run_system,
)
from .loops import (
    score as score,
)
from .loops import (
    simulated_response as simulated_response,
)
from .loops import (
    smooth_pick_and_place as smooth_pick_and_place,
)
from .recording import (
    Recording as Recording,
)
from .recording import (
    residual_torque as residual_torque,
)
from .recording import (
    rms as rms,
)
from .simulate import (
    CONTROL_STEP as CONTROL_STEP,
)
from .simulate import (
    LOG_STEP as LOG_STEP,
)
from .simulate import (
    REST as REST,
)
from .simulate import (
    follow as follow,
)
from .simulate import (
    free_motion as free_motion,
)
from .simulate import (
    record as record,
)
