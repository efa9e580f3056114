"""Parameters, panels and pads as plain descriptions."""
