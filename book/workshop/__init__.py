"""What works only with the book: its measurements, its verdicts, and what one chapter alone shows.

- ``report``: the report's claims, verdicts, ledger and committed results; studies of Parts I to III
- ``chapters``: what one chapter alone shows

``report`` uses nothing of ``chapters``, and `ddlib` nothing of both. Part IV is a package beside
this one, ``book/beyond``, and nothing here uses it. Both packages are imported with the folder
``book`` on the path, as `make` and pytest have it and as every notebook in ``book`` has it.
"""

from pathlib import Path

BOOK = Path(__file__).parents[1]
"""The folder of chapters, claims and committed results."""
