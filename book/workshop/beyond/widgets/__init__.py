"""Widgets of Part IV, *Rivals and beyond*."""
