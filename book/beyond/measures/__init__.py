"""Measures of the claims on rivals: "beyond.module.function" in a claim."""
