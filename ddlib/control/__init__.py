"""Controllers of the joints, and the linear analysis of their loops.

- ``controllers``: proportional, PD and PID control, feedforward, computed torque
- ``linear``: loops as python-control systems: poles, `margins` of gain and phase
- ``velocity``: velocity from position readings, noise against lag
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
