from .base import (
    CurveWidget as CurveWidget,
    PageWidget as PageWidget,
)
from .engine.trainer import (
    NetworkTrainer as NetworkTrainer,
)
from .parts.panels import (
    Mark as Mark,
    Pad as Pad,
    Panel as Panel,
    Scalar as Scalar,
)
from .parts.parameters import (
    Choice as Choice,
    Parameter as Parameter,
    Presets as Presets,
)
from .picker import (
    TrajectoryPicker as TrajectoryPicker,
)
from .scripts import (
    bundle as bundle,
    styles as styles,
)
from .switches import (
    RealArmSwitches as RealArmSwitches,
)
from .table import (
    Live as Live,
)
