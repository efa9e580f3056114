"""The report's experiments as this book repeats them: studies, results, measures, verdicts.

- ``studies``: what is too slow for a chapter, a function for each result
- ``reproduce``: runs studies, ``make reproduce``; an outcome lies in ``book/results/NAME.json``
- ``results``: reads these files; ``code_hash``: tells which code made them
- ``sweeps``: one experiment over many settings, kept and resumed
- ``measures``: what claims measure; ``committed``: recordings and networks that several look at
- ``evidence``: claims, verdicts, the ledger
- ``exact_states``: section 6; ``two_harmonics``: other motions;
  ``parity``: the example of section 1.1
"""
