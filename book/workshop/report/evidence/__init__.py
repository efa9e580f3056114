"""What the paper claims, what was measured, and the verdicts: the ledger.

- ``claims``: a `Claim` is an entry of ``book/claims.yml``; its bands judge what is measured
- ``cards``: claims that judge the same sentence, and the word that follows
- ``expressions``: what a claim reads from committed results, and how; ``measures``: the functions
  that measure all else, a module for each part of the paper
- ``verdicts``: `Measured`, and how sure a verdict is; ``judging``: written beside fresh verdicts,
  and what is kept of every claim, by which a change is seen
- ``statements``: words of direction in prose, checked
- ``ledger_tables``, ``wall``: claims in tables, and as tiles to open
"""
