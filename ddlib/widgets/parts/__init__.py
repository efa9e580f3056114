"""What widgets are made of: parameters with their ranges, and panels that show curves.

- ``parameters``: `Parameter` and `Choice`, what a reader can change
- ``panels``: charts, numbers and a pad, as plain descriptions
"""
