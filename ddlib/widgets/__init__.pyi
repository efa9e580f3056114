from .base import (
    SCRIPT as SCRIPT,
)
from .base import (
    STYLE as STYLE,
)
from .base import (
    CurveWidget as CurveWidget,
)
from .base import (
    module as module,
)
from .engine.builder import (
    FilterBuilder as FilterBuilder,
)
from .engine.sentence import (
    LoopSentence as LoopSentence,
)
from .engine.sentence import (
    TorqueSentence as TorqueSentence,
)
from .engine.throw import (
    ThrownArm as ThrownArm,
)
from .engine.trainer import (
    NetworkTrainer as NetworkTrainer,
)
from .explorer import (
    FilterExplorer as FilterExplorer,
)
from .parts.panels import (
    Mark as Mark,
)
from .parts.panels import (
    Pad as Pad,
)
from .parts.panels import (
    Panel as Panel,
)
from .parts.panels import (
    Scalar as Scalar,
)
from .parts.parameters import (
    Choice as Choice,
)
from .parts.parameters import (
    Parameter as Parameter,
)
from .picker import (
    TrajectoryPicker as TrajectoryPicker,
)
from .player import (
    TrainingPlayer as TrainingPlayer,
)
from .spectrum import (
    SpectrumExplorer as SpectrumExplorer,
)
from .switches import (
    RealArmSwitches as RealArmSwitches,
)
from .tuner import (
    PIDTuner as PIDTuner,
)
from .window import (
    SlidingWindow as SlidingWindow,
)
