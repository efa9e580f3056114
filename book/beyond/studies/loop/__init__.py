"""Studies of *Closing the loop*.

Two modules make what several of them run: ``feedforwards`` the torques given in advance, and
``adaptive_laws`` the controllers that learn, many of them in one batch.
"""
