"""What the paper claims, what was measured, and the verdicts: the ledger."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__,
    submodules=["committed", "chart", "claims", "judging", "ledger", "ledger_tables", "measures"],
    submod_attrs={
        "verdicts": [
            "CONTRADICTS",
            "DECIDED",
            "DRAWS",
            "FEWEST",
            "Measured",
            "STANDS",
            "VERDICTS",
            "bootstrap",
            "fresh",
            "mean",
            "median",
            "over_members",
            "shares",
            "stands",
            "turns_at",
        ],
        "statements": ["SURE", "resampled", "stated"],
    },
)
