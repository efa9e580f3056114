"""Widgets that compute in the page, and the live engine that they share.

- ``trainer``: a network that the reader trains from random weights, on trajectories of her own

The engine is ``static/physics.js``, its equations, ``static/engine.js``, the loop and the network,
and ``static/descent.js``, training.
"""
