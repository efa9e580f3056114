"""What the paper claims, what was measured, and the verdicts: the ledger.

- ``claims``: a `Claim` is an entry of ``book/claims.yml``; its bands judge what is measured
- ``measures``: the functions that measure, a module for each part of the paper; Table 4-1 in
  ``networks``
- ``verdicts``: `Measured`, and how sure a verdict is; ``judging``: written beside fresh verdicts
- ``committed``: recordings and trained networks that several measures look at
- ``statements``: words of direction in prose, checked; ``ledger``, ``ledger_tables``, ``chart``:
  the page of all claims; ``wall``: claims as tiles to open
"""

from ddlib._names import hand_on

__getattr__, __dir__, __all__ = hand_on(
    __name__,
    "chart",
    "claims",
    "committed",
    "judging",
    "ledger",
    "ledger_tables",
    "measures",
    "wall",
    verdicts=(
        "CONTRADICTS DECIDED DRAWS FEWEST Measured STANDS VERDICTS bootstrap fresh judged "
        "largest_median mean median over_members shares stands turns_at"
    ),
    statements="SURE resampled stated",
)
