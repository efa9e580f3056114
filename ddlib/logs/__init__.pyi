from .findings import (
    Check as Check,
    Finding as Finding,
)
from .log import (
    Log as Log,
    LoggedRecording as LoggedRecording,
    LoggedRun as LoggedRun,
)
from .reading import (
    read_csv as read_csv,
    read_frame as read_frame,
    read_log as read_log,
    write_csv as write_csv,
)
from .readings import (
    DoubtfulRecording as DoubtfulRecording,
    warn_of as warn_of,
)
from .resampling import (
    LogWarning as LogWarning,
    resample as resample,
)
