"""What the paper claims, what was measured, and the verdicts: the ledger.

- ``claims``: a `Claim` is an entry of ``book/claims.yml``; its bands judge what is measured
- ``expressions``: what a claim reads from committed results, and how; ``measures``: the functions
  that measure all else, a module for each part of the paper
- ``verdicts``: `Measured`, and how sure a verdict is; ``judging``: written beside fresh verdicts
- ``committed``: recordings and trained networks that several measures look at
- ``statements``: words of direction in prose, checked; ``ledger``, ``ledger_tables``, ``chart``:
  the page of all claims; ``wall``: claims as tiles to open
"""
