"""Parameters, panels and pads as plain descriptions, and what every widget has."""
