"""What a page shows without a kernel: values computed beforehand, compressed, and a still.

- ``sampled``: curves of a function, one setting at a time or many
- ``baked``: the same on a grid, interpolated; ``compress``: their coefficients as int16
- ``still``: the starting state as a picture
"""
