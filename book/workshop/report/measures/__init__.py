"""Functions that measure the paper's claims, for `workshop.report.evidence.claims`: a module for each part.

Each returns a `workshop.report.evidence.verdicts.Measured`: the value that is judged and the text that is
shown. A claim names its function in ``book/claims.yml`` as "module.function".

- ``dynamics``, ``backpropagation``, ``control``: sections 1 to 3, the arm and the method
- ``trajectories``, ``windows``: sections 2 to 4, motions and what windows hold
- ``knobs``: Table 4-1, which knobs decide it and what it speaks for
- ``networks``: Tables 4-1 and 6-1, what networks reach and what their weights show
- ``filters``: sections 5 and 7, what filters show
- ``filter_trial``: the same beside networks trained on unrelated torques
- ``beyond``: Part IV, rivals and a real arm
- ``loop``: Part IV, closing the loop
"""
