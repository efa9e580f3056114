"""Measures of the claims of Part IV, *Rivals and beyond*: "beyond.module.function" in a claim."""
