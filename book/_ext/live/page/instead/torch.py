"""*Run this page*: what the book's cells use of PyTorch, by numpy; in a page this is `torch`.

Tensors with reverse-mode derivatives, a few layers and two optimisers. Random numbers are those of
PyTorch, by the same generator. What is not here says so when it is used.
"""

from __future__ import annotations

import contextlib
import functools
import sys
import types

import numpy as np

float32, float64 = np.float32, np.float64
_recording = [True]  # whether operations are kept for derivatives


class Lacks(NotImplementedError):
    """Something of PyTorch is not here."""

    def __init__(self, name):
        self.lacks = f"torch.{name}"
        super().__init__(f"{self.lacks} is not in this page, where numpy stands in for PyTorch")


class _Lacking(type):
    """A name of PyTorch that is not here: it can be passed on and inherited from, not called."""

    def __getattr__(cls, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return _lacking(f"{cls.__name__}.{name}")

    def __call__(cls, *args, **options):
        raise Lacks(cls.__name__)


def _lacking(name):
    if name.startswith("__"):
        raise AttributeError(name)
    return _Lacking(name, (), {})


def _lower(gradient, shape):
    """A derivative summed over what broadcasting had repeated."""
    extra = gradient.ndim - len(shape)
    axes = [k + extra for k, size in enumerate(shape) if size == 1 != gradient.shape[k + extra]]
    return gradient.sum((*range(extra), *axes), keepdims=True).reshape(shape)


def _made(data, *parents):
    """A result, with the functions that pass its derivative on to each tensor it is made of."""
    result = Tensor(data)
    if _recording[0]:
        result._parents = [(t, back) for t, back in parents if t.requires_grad]
        result.requires_grad = bool(result._parents)
    return result


def _both(a, b):
    """Two operands: numbers, and tensors without axes, do not widen the other's type."""
    if not isinstance(a, Tensor):
        a = Tensor(np.asarray(a, b.dtype if np.ndim(a) == 0 and b.floats else None))
    if not isinstance(b, Tensor):
        b = Tensor(np.asarray(b, a.dtype if np.ndim(b) == 0 and a.floats else None))
    x, y = a.data, b.data
    if a.floats and b.floats and x.dtype != y.dtype and bool(x.ndim) != bool(y.ndim):
        x, y = (x.astype(y.dtype), y) if y.ndim else (x, y.astype(x.dtype))
    return a, b, x, y


def _binary(operation, of_a, of_b):
    def method(a, b):
        a, b, x, y = _both(a, b)
        z = operation(x, y)
        return _made(
            z,
            (a, lambda g: _lower(of_a(g, x, y, z), x.shape)),
            (b, lambda g: _lower(of_b(g, x, y, z), y.shape)),
        )

    return method


def _unary(operation, slope):
    """A function of each number; `slope(x, y)` is its derivative there."""

    def method(a):
        y = operation(a.data)
        return _made(y, (a, lambda g: g * slope(a.data, y)))

    return method


def _matmul(a, b):
    a, b, x, y = _both(a, b)
    left, right = np.atleast_2d(x), y[:, None] if y.ndim == 1 else y
    z = left @ right
    turned = np.swapaxes(right, -1, -2), np.swapaxes(left, -1, -2)
    return _made(
        z.reshape(np.shape(x @ y)) if 1 in (x.ndim, y.ndim) else z,
        (a, lambda g: _lower(g.reshape(z.shape) @ turned[0], left.shape).reshape(x.shape)),
        (b, lambda g: _lower(turned[1] @ g.reshape(z.shape), right.shape).reshape(y.shape)),
    )


def _sigmoid(x):
    with np.errstate(over="ignore"):
        return 1 / (1 + np.exp(-x))


def _axes(dim):
    return tuple(dim) if isinstance(dim, (list, tuple)) else dim


def _compared(operation):
    """An operation without a derivative."""

    def method(a, b):
        _, _, x, y = _both(a, b)
        return Tensor(operation(x, y))

    return method


def _in_place(operation):
    def method(a, *given, **options):
        a._may_change()
        plain = [g.data if isinstance(g, Tensor) else g for g in given]
        a.data[...] = operation(a.data, *plain, **options)
        return a

    return method


class Tensor:
    """Numbers with a shape, and how they came about where derivatives are asked for."""

    __array_priority__ = 1000.0  # `number * tensor` is the tensor's
    __hash__ = object.__hash__

    def __init__(self, data):
        self.data, self.grad = np.asarray(data), None
        self.requires_grad, self._parents = False, []

    shape = property(lambda self: self.data.shape)
    ndim = property(lambda self: self.data.ndim)
    dtype = property(lambda self: self.data.dtype.type)
    floats = property(lambda self: self.data.dtype.kind == "f")
    is_leaf = property(lambda self: not self._parents)
    T = property(lambda self: self.permute(*reversed(range(self.ndim))))
    mT = property(lambda self: self.transpose(-1, -2))

    __add__ = add = _binary(np.add, lambda g, x, y, z: g, lambda g, x, y, z: g)
    __sub__ = sub = _binary(np.subtract, lambda g, x, y, z: g, lambda g, x, y, z: -g)
    __mul__ = mul = _binary(np.multiply, lambda g, x, y, z: g * y, lambda g, x, y, z: g * x)
    __truediv__ = div = _binary(
        np.true_divide, lambda g, x, y, z: g / y, lambda g, x, y, z: -g * z / y
    )
    __pow__ = pow = _binary(
        np.power, lambda g, x, y, z: g * y * x ** (y - 1), lambda g, x, y, z: g * z * np.log(x)
    )
    __matmul__ = matmul = _matmul
    __radd__, __rmul__ = __add__, __mul__

    def __rsub__(self, other):
        return Tensor.__sub__(other, self)

    def __rtruediv__(self, other):
        return Tensor.__truediv__(other, self)

    def __rpow__(self, other):
        return Tensor.__pow__(other, self)

    def __rmatmul__(self, other):
        return _matmul(other, self)

    __neg__ = neg = _unary(np.negative, lambda x, y: -1)
    exp = _unary(np.exp, lambda x, y: y)
    log = _unary(np.log, lambda x, y: 1 / x)
    sqrt = _unary(np.sqrt, lambda x, y: 0.5 / y)
    square = _unary(np.square, lambda x, y: 2 * x)
    abs = __abs__ = _unary(np.abs, lambda x, y: np.sign(x))
    sin = _unary(np.sin, lambda x, y: np.cos(x))
    cos = _unary(np.cos, lambda x, y: -np.sin(x))
    tanh = _unary(np.tanh, lambda x, y: 1 - y * y)
    sigmoid = _unary(_sigmoid, lambda x, y: y * (1 - y))
    relu = _unary(lambda x: np.maximum(x, 0), lambda x, y: x > 0)
    softsign = _unary(lambda x: x / (1 + np.abs(x)), lambda x, y: 1 / np.square(1 + np.abs(x)))

    __lt__, __le__ = _compared(np.less), _compared(np.less_equal)
    __gt__, __ge__ = _compared(np.greater), _compared(np.greater_equal)
    __floordiv__, __mod__ = _compared(np.floor_divide), _compared(np.mod)
    __eq__, __ne__ = _compared(np.equal), _compared(np.not_equal)

    add_ = _in_place(lambda x, y, alpha=1: x + alpha * y)
    sub_ = _in_place(lambda x, y, alpha=1: x - alpha * y)
    mul_, div_ = _in_place(np.multiply), _in_place(np.divide)
    zero_ = _in_place(lambda x: 0)
    copy_ = _in_place(lambda x, y: y)
    addmm_ = baddbmm_ = _in_place(lambda x, a, b: x + a @ b)
    sigmoid_ = _in_place(lambda x: _sigmoid(x))
    __iand__ = _in_place(np.logical_and)

    def __iadd__(self, other):
        return self.add_(other)

    def __isub__(self, other):
        return self.sub_(other)

    def __imul__(self, other):
        return self.mul_(other)

    def __itruediv__(self, other):
        return self.div_(other)

    def _may_change(self):
        if self.requires_grad and _recording[0]:
            raise RuntimeError("a tensor that requires grad is changed in place under no_grad only")

    def sum(self, dim=None, keepdim=False):
        shape, axes = self.shape, _axes(dim)

        def back(g):
            if dim is not None and not keepdim:
                g = np.expand_dims(g, axes)
            return np.broadcast_to(g, shape)

        return _made(self.data.sum(axes, keepdims=keepdim), (self, back))

    def mean(self, dim=None, keepdim=False):
        total = self.sum(dim, keepdim)
        return total / (self.data.size / max(total.data.size, 1))

    def var(self, dim=None, correction=1, keepdim=False):
        deviations = self - self.mean(dim, True)
        squares = deviations.square().sum(dim, keepdim)
        return squares / (self.data.size / max(squares.data.size, 1) - correction)

    def std(self, dim=None, correction=1, keepdim=False):
        return self.var(dim, correction, keepdim).sqrt()

    def max(self):
        return Tensor(self.data.max())

    def min(self):
        return Tensor(self.data.min())

    def all(self, dim=None):
        return Tensor(self.data.all(_axes(dim)))

    def any(self, dim=None):
        return Tensor(self.data.any(_axes(dim)))

    def clamp(self, min=-np.inf, max=np.inf):
        inside = (self.data >= min) & (self.data <= max)
        return _made(self.data.clip(min, max), (self, lambda g: g * inside))

    clamp_min = clamp

    def reshape(self, *shape):
        shape = shape[0] if len(shape) == 1 and not isinstance(shape[0], int) else shape
        return _made(self.data.reshape(shape), (self, lambda g: g.reshape(self.shape)))

    view = reshape

    def flatten(self, start_dim=0, end_dim=-1):
        end = end_dim % max(self.ndim, 1)
        return self.reshape(*self.shape[:start_dim], -1, *self.shape[end + 1 :])

    def permute(self, *order):
        order = order[0] if len(order) == 1 and not isinstance(order[0], int) else order
        back = np.argsort([k % self.ndim for k in order]) if order else ()
        return _made(self.data.transpose(order), (self, lambda g: g.transpose(back)))

    def transpose(self, a, b):
        order = list(range(self.ndim))
        order[a], order[b] = order[b], order[a]
        return self.permute(*order)

    def t(self):
        return self.T

    def unsqueeze(self, dim):
        return _made(np.expand_dims(self.data, dim), (self, lambda g: g.reshape(self.shape)))

    def squeeze(self, dim=None):
        return _made(self.data.squeeze(dim), (self, lambda g: g.reshape(self.shape)))

    def __getitem__(self, key):
        key = _plain(key)

        def back(g):
            full = np.zeros(self.shape, g.dtype)
            np.add.at(full, key, g)
            return full

        return _made(self.data[key], (self, back))

    def __setitem__(self, key, value):
        self._may_change()
        self.data[_plain(key)] = _plain(value)

    def diagonal(self):
        return Tensor(np.einsum("ii->i", self.data))  # it may be written to

    def clone(self):
        return _made(self.data.copy(), (self, lambda g: g))

    def contiguous(self):
        return _made(np.ascontiguousarray(self.data), (self, lambda g: g))

    def to(self, dtype):
        old = self.data.dtype
        return _made(self.data.astype(dtype, copy=False), (self, lambda g: g.astype(old)))

    def type(self, dtype):
        return self.to(dtype)

    def float(self):
        return self.to(float32)

    def double(self):
        return self.to(float64)

    def detach(self):
        return Tensor(self.data)

    def requires_grad_(self, requires_grad=True):
        if not self.floats:
            raise RuntimeError("only tensors of floating point numbers can require gradients")
        self.requires_grad = requires_grad
        return self

    def numpy(self):
        if self.requires_grad:
            raise RuntimeError(
                "Can't call numpy() on a tensor that requires grad: tensor.detach().numpy()"
            )
        return self.data

    def __array__(self, dtype=None, copy=None):
        return np.asarray(self.numpy(), dtype)

    def backward(self):
        for leaf, gradient in _gradients(self).values():
            leaf.grad = Tensor(gradient if leaf.grad is None else leaf.grad.data + gradient)

    def item(self):
        return self.data.item()

    def tolist(self):
        return self.data.tolist()

    def numel(self):
        return self.data.size

    def size(self, dim=None):
        return self.shape if dim is None else self.shape[dim]

    def dim(self):
        return self.ndim

    def __len__(self):
        return len(self.data)

    def __iter__(self):
        return (self[k] for k in range(len(self)))

    def __float__(self):
        return float(self.data)

    def __int__(self):
        return int(self.data)

    def __bool__(self):
        return bool(self.data)

    def __format__(self, spec):
        return format(self.item() if not self.ndim else str(self), spec)

    def __repr__(self):
        numbers = np.array2string(self.data, separator=", ", prefix="tensor(")
        return f"tensor({numbers}{', requires_grad=True' if self.requires_grad else ''})"

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        raise Lacks(f"Tensor.{name}")


def _plain(value):
    if isinstance(value, tuple):
        return tuple(map(_plain, value))
    return value.data if isinstance(value, Tensor) else value


def _gradients(result, wanted=None):
    """Derivatives of a number by the tensors it came from: by its leaves, or as wanted."""
    if result.data.size != 1:
        raise RuntimeError("grad can be implicitly created only for scalar outputs")
    if not result.requires_grad:
        raise RuntimeError("the result does not depend on a tensor that requires grad")
    order, seen, stack = [], set(), [(result, False)]
    while stack:
        tensor, done = stack.pop()
        if done:
            order.append(tensor)
        elif id(tensor) not in seen:
            seen.add(id(tensor))
            stack.append((tensor, True))
            stack += [(parent, False) for parent, _ in tensor._parents]
    slopes, gradients = {id(result): np.ones_like(result.data)}, {}
    for tensor in reversed(order):
        slope = slopes.pop(id(tensor))
        if tensor.is_leaf if wanted is None else id(tensor) in wanted:
            gradients[id(tensor)] = tensor, slope.astype(tensor.dtype, copy=False)
        for parent, back in tensor._parents:
            more = back(slope)
            slopes[id(parent)] = slopes[id(parent)] + more if id(parent) in slopes else more
    return gradients


def _grad(outputs, inputs, retain_graph=None):
    single = isinstance(inputs, Tensor)
    inputs = [inputs] if single else list(inputs)
    gradients = _gradients(outputs, {id(tensor) for tensor in inputs})
    if any(id(tensor) not in gradients for tensor in inputs):
        raise RuntimeError("One of the differentiated tensors was not used in the graph")
    return tuple(Tensor(gradients[id(tensor)][1]) for tensor in inputs)


class no_grad(contextlib.ContextDecorator):
    """Nothing is kept for derivatives within."""

    def __init__(self, mode=True):
        self.before = []

    def __enter__(self):
        self.before.append(_recording[0])
        _recording[0] = False

    def __exit__(self, *error):
        _recording[0] = self.before.pop()


inference_mode = no_grad


# --- tensors, and functions of them ---


def tensor(data, dtype=None, requires_grad=False):
    if dtype is None and not hasattr(data, "dtype"):  # numbers of Python
        dtype = float32 if np.asarray(data).dtype.kind == "f" else None
    made = Tensor(np.array(_plain(data), dtype))
    return made.requires_grad_() if requires_grad else made


def as_tensor(data, dtype=None):
    data = data if isinstance(data, Tensor) else Tensor(np.asarray(data))
    return data if dtype is None else data.to(dtype)


def from_numpy(array):
    return Tensor(array)


def _filled(value):
    def function(*shape, dtype=float32):
        shape = (
            shape[0] if len(shape) == 1 and not isinstance(shape[0], (int, np.integer)) else shape
        )
        return Tensor(np.full(shape, value, dtype))

    return function


zeros, ones, empty = _filled(0), _filled(1), _filled(0)


def zeros_like(like):
    return Tensor(np.zeros_like(like.data))


def ones_like(like):
    return Tensor(np.ones_like(like.data))


def eye(n, m=None, dtype=float32):
    return Tensor(np.eye(n, m, dtype=dtype))


def arange(*given, dtype=None):
    return Tensor(np.arange(*given, dtype=dtype))


def linspace(start, end, steps, dtype=float32):
    return Tensor(np.linspace(start, end, steps, dtype=dtype))


def tril_indices(rows, columns):
    return Tensor(np.stack(np.tril_indices(rows, 0, columns)))


def cat(tensors, dim=0):
    ends = np.cumsum([t.shape[dim] for t in tensors])[:-1]
    parts = [(t, lambda g, k=k: np.split(g, ends, dim)[k]) for k, t in enumerate(tensors)]
    return _made(np.concatenate([t.data for t in tensors], dim), *parts)


def stack(tensors, dim=0):
    parts = [(t, lambda g, k=k: np.take(g, k, dim)) for k, t in enumerate(tensors)]
    return _made(np.stack([t.data for t in tensors], dim), *parts)


def where(condition, a, b):
    a, b, x, y = _both(a, b)
    chosen = _plain(condition)
    return _made(
        np.where(chosen, x, y),
        (a, lambda g: _lower(np.where(chosen, g, 0), x.shape)),
        (b, lambda g: _lower(np.where(chosen, 0, g), y.shape)),
    )


def _into(operation, by_numpy):
    """An operation of two tensors, whose result may go where another one is."""

    def function(a, b, out=None):
        if out is None:
            return operation(a, b)
        by_numpy(a.data, _plain(b), out=out.data)
        return out

    return function


mul, sub = _into(Tensor.mul, np.multiply), _into(Tensor.sub, np.subtract)
mm = bmm = matmul = _into(_matmul, np.matmul)


def _sigmoid_backward(gradient, activity, grad_input):
    grad_input.data[...] = gradient.data * (activity.data * (1 - activity.data))


def addmm(total, a, b):
    return total + a @ b


def isfinite(a):
    return Tensor(np.isfinite(a.data))


def _function(name):
    return lambda a, *given, **options: getattr(a, name)(*given, **options)


for _name in (
    *("sigmoid", "tanh", "relu", "exp", "log", "sqrt", "square", "abs", "sin", "cos", "sum"),
    *("mean", "var", "std", "flatten", "reshape", "transpose", "clone", "add"),
):
    globals()[_name] = _function(_name)

_source = [np.random.RandomState()]


def manual_seed(seed):
    """The same generator as PyTorch's, started in the same way."""
    _source[0] = np.random.RandomState(int(seed) % 2**32)


def rand(*shape):
    shape = shape[0] if len(shape) == 1 and not isinstance(shape[0], int) else shape
    draws = _source[0].randint(0, 2**32, shape, np.uint32)
    return Tensor((draws & (2**24 - 1)).astype(float32) * float32(2.0**-24))


def set_num_threads(count):
    pass


def get_num_threads():
    return 1


def _factor(matrix):
    try:
        return Tensor(np.linalg.cholesky(matrix.data)), Tensor(0)
    except np.linalg.LinAlgError:
        return matrix, Tensor(1)


def cholesky_solve(right, lower):
    half = np.linalg.solve(lower.data, right.data)
    return Tensor(np.linalg.solve(lower.data.T, half))


# --- layers and optimisers ---


class Module:
    """A part of a network: its tensors, and those of its parts, are what is learnt."""

    def parameters(self):
        for part in vars(self).values():
            if isinstance(part, Tensor) and part.requires_grad:
                yield part
            for inside in part if isinstance(part, tuple) else (part,):
                if isinstance(inside, Module):
                    yield from inside.parameters()

    def to(self, dtype):
        for part in self.parameters():
            part.data = part.data.astype(dtype)
        return self

    def double(self):
        return self.to(float64)

    def float(self):
        return self.to(float32)

    def zero_grad(self):
        for part in self.parameters():
            part.grad = None

    def __call__(self, *given):
        return self.forward(*given)


class Linear(Module):
    """A product with weights, and a bias; the start is PyTorch's."""

    def __init__(self, inputs, outputs, bias=True):
        most = float32(1 / np.sqrt(inputs)).astype(float64)
        shapes = [(outputs, inputs), (outputs,)][: 1 + bias]
        drawn = [Tensor(rand(*s).data * (2 * most) - most).float() for s in shapes]  # rounded once
        self.weight, self.bias = (*(part.requires_grad_() for part in drawn), None)[:2]

    def forward(self, x):
        y = x @ self.weight.T
        return y if self.bias is None else y + self.bias


class Sequential(Module):
    """Layers, one after the other."""

    def __init__(self, *layers):
        self.layers = layers

    def forward(self, x):
        return functools.reduce(lambda y, layer: layer(y), self.layers, x)


def _layer(name):
    forward = lambda self, x: getattr(x, name)()  # noqa: E731
    return type(name.capitalize(), (Module,), {"forward": forward})


class _Optimiser:
    def __init__(self, params, **options):
        self.param_groups = [{"params": list(params), **options}]
        self.state = {}

    def zero_grad(self):
        for group in self.param_groups:
            for part in group["params"]:
                part.grad = None

    def step(self):
        for group in self.param_groups:
            for part in group["params"]:
                if part.grad is not None:
                    state = self.state.setdefault(id(part), {})
                    part.data = part.data - self._step(part.grad.data, state, group)


class SGD(_Optimiser):
    """Descent with momentum."""

    def __init__(self, params, lr=1e-3, momentum=0.0):
        super().__init__(params, lr=lr, momentum=momentum)

    def _step(self, slope, state, group):
        step = slope * 1  # the first step has no momentum
        if "step" in state:
            step = state["step"] * slope.dtype.type(group["momentum"]) + slope
        state["step"] = step
        return slope.dtype.type(group["lr"]) * step


class Adam(_Optimiser):
    """Steps by the mean and the mean square of the slopes so far."""

    def __init__(self, params, lr=1e-3, betas=(0.9, 0.999), eps=1e-8):
        super().__init__(params, lr=lr, betas=betas, eps=eps)

    def _step(self, slope, state, group):
        (a, b), count = group["betas"], state.get("count", 0) + 1
        mean = state.get("mean", 0) * a + (1 - a) * slope
        square = state.get("square", 0) * b + (1 - b) * slope * slope
        state.update(count=count, mean=mean, square=square)
        size = np.sqrt(square) / np.sqrt(1 - b**count) + group["eps"]
        return group["lr"] / (1 - a**count) * mean / size


def _namespace(name, **inside):
    """A module of PyTorch's with a few names; the others say that they are not here."""
    module = types.ModuleType(f"torch.{name}")
    vars(module).update(inside, __getattr__=lambda lost: _lacking(f"{name}.{lost}"))
    return module


def Parameter(data):
    return data.detach().requires_grad_()


Softsign, Sigmoid, Tanh, ReLU = map(_layer, ("softsign", "sigmoid", "tanh", "relu"))
nn = _namespace(
    "nn", Module=Module, Linear=Linear, Sequential=Sequential, Parameter=Parameter,
    Softsign=Softsign, Sigmoid=Sigmoid, Tanh=Tanh, ReLU=ReLU,
)  # fmt: skip
optim = _namespace("optim", SGD=SGD, Adam=Adam)
autograd = _namespace("autograd", grad=_grad)
linalg = _namespace(
    "linalg",
    cholesky_ex=_factor,
    eigh=lambda matrix: tuple(map(Tensor, np.linalg.eigh(matrix.data))),
)
backends = _namespace("backends", mkldnn=types.SimpleNamespace(is_available=lambda: False))
_backward = types.SimpleNamespace(grad_input=_sigmoid_backward)
ops = types.SimpleNamespace(aten=types.SimpleNamespace(sigmoid_backward=_backward))

if __name__ == "torch":
    sys.modules |= {module.__name__: module for module in (nn, optim, autograd, linalg)}


def __getattr__(name):
    return _lacking(name)
