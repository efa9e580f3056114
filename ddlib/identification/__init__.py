"""Parameters of an arm from recordings of it, with a confidence for each.

- ``equations``: from a recording to linear equations: differences, smoothing, modulation
- ``known_axes``: six joints of which only the axes are known, joint by joint
- ``recursive``: least squares one sample at a time
- ``regression``: weighted least squares on them, `Estimate`, and the true parameters
"""

from ddlib._names import hand_on

__getattr__, __dir__, __all__ = hand_on(
    __name__,
    regression=(
        "Equations Estimate FRICTION GRAVITY RIGID SIGN_SPEED columns excitation from_states "
        "least_squares true_parameters"
    ),
    known_axes="FRICTION_TERMS joint_columns joint_terms",
    recursive="RecursiveLeastSquares",
    equations="SLOW by_differences by_modulation by_smoothing repeat",
)
