"""Measures of Part IV, *Closing the loop*: "loop.module.function" in a claim."""
