from .checking import (
    DoubtfulRecording as DoubtfulRecording,
    check_recording as check_recording,
    warn_of as warn_of,
)
from .findings import (
    Check as Check,
    Finding as Finding,
)
from .log import (
    Log as Log,
    LoggedRecording as LoggedRecording,
    LoggedRun as LoggedRun,
)
