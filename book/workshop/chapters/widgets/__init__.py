"""Widgets of single chapters, with their scripts beside them; those for any arm are in ddlib."""

CENTRE = "time from the centre, ms"
