"""Rivals of the window network: what else learns torques from recordings, then and now.

``protocol`` says what every rival learns from and must answer, and tries it.
"""
