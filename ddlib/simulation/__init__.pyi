from .loops import (
    feedforward_system as feedforward_system,
    predicted_response as predicted_response,
    run_system as run_system,
    simulated_response as simulated_response,
)
from .recording import (
    Recording as Recording,
    residual_torque as residual_torque,
    rms as rms,
    score as score,
)
from .simulate import (
    CONTROL_STEP as CONTROL_STEP,
    LOG_STEP as LOG_STEP,
    REST as REST,
    follow as follow,
    record as record,
)
