"""Widgets of single chapters of Part IV, with their scripts beside them."""
