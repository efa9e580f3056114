from .log import (
    Log as Log,
    LoggedRecording as LoggedRecording,
    LoggedRun as LoggedRun,
)
