"""Measures of *Closing the loop*, and of all verdicts together: "beyond.loop.module.function"."""
