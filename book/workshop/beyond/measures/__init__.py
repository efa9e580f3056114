"""Measures of the claims of Part IV: "beyond.module.function" in a claim."""
