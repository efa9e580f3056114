"""Widgets of one chapter each: they show committed results, so they work only with the book."""
