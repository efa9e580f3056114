"""What widgets are made of: parameters with their ranges, and panels that show curves."""
