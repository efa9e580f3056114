"""Products with one matrix that stays the same, by oneDNN where it is there and worth it.

Descent multiplies by the same inputs in every epoch. oneDNN packs such a matrix once, and its
kernels take the widest registers of any processor, those of MKL only of Intel's. PyTorch has no
public door to it: the operators are those that its compiler uses, and their names begin with an
underscore. So they stand here and nowhere else. Where they are missing, or the product is small, it
is `torch.mm`. The two ways round their sums differently, by some units in the last place.
"""

from __future__ import annotations

import platform
from collections.abc import Callable

import torch

_HAS_ONEDNN = (
    torch.backends.mkldnn.is_available()
    and platform.machine().lower() in {"x86_64", "amd64"}
    and all(
        hasattr(torch.ops.mkldnn, f"_{op}") for op in ("reorder_linear_weight", "linear_pointwise")
    )
)
_WORTH_PACKING = 300_000  # multiplications from which a product is worth oneDNN's longer way


def product_with(matrix: torch.Tensor, rows: int) -> Callable[[torch.Tensor], torch.Tensor]:
    """The function ``left -> left @ matrix`` for left-hand matrices of some `rows`."""
    if not _HAS_ONEDNN or rows * matrix.numel() < _WORTH_PACKING:
        return lambda left: torch.mm(left, matrix)
    packed = torch.ops.mkldnn._reorder_linear_weight(matrix.t().contiguous(), rows)
    linear = torch.ops.mkldnn._linear_pointwise
    return lambda left: linear(left, packed, None, "none", [], "")
