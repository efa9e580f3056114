"""What widgets are made of: parameters with their ranges, panels that show curves, and a frame.

- ``parameters``: `Parameter` and `Choice`, what a reader can change
- ``panels``: charts, numbers and a pad, as plain descriptions
- ``common``: the name in the page's address, the state as code, presets
"""
