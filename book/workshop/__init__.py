"""What works only with the book: its measurements, its verdicts, and what one chapter alone shows.

- ``report``: the report's claims, verdicts, ledger and committed results; studies of Parts I to III
- ``beyond``: Part IV: rivals, adaptive and on-line control, a real arm, and their studies
- ``chapters``: what one chapter alone shows

``report`` uses nothing of the other two, ``beyond`` nothing of ``chapters``, and `ddlib` nothing of
all three. They are imported with the folder ``book`` on the path, as `make` and pytest have it and
as every notebook in ``book`` has it.
"""

from pathlib import Path

BOOK = Path(__file__).parents[1]
"""The folder of chapters, claims and committed results."""
