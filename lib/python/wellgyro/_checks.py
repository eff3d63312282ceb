"""What arguments must be, said with their names before anything is done with them."""
import math
import numbers
import os

import numpy as np


def array(name, value, shape, dtype=np.float64):
    """`value` itself, held to be an array of `dtype` whose shape is `shape`: a number, None for any,
    or a tuple of the numbers allowed. Never a copy."""
    kind = np.dtype(dtype).name
    if not isinstance(value, np.ndarray):
        raise TypeError(f"{name}: a numpy array of {kind} is expected, not {type(value).__name__}")
    if value.dtype != dtype:
        raise TypeError(f"{name}: an array of {kind} is expected, not of {value.dtype}")
    wanted = "(" + ", ".join("n" if s is None else "|".join(map(str, s)) if isinstance(s, tuple)
                             else str(s) for s in shape) + ("," if len(shape) == 1 else "") + ")"
    fits = value.ndim == len(shape) and all(
        s is None or (n in s if isinstance(s, tuple) else n == s)
        for s, n in zip(shape, value.shape))
    if not fits:
        raise ValueError(f"{name}: an array of shape {wanted} is expected, not of {value.shape}")
    if not value.flags.c_contiguous:
        raise ValueError(f"{name}: a C-contiguous array is expected: numpy.ascontiguousarray makes "
                         "one")
    return value


def number(name, value, low=-math.inf, high=math.inf, *, above=False):
    """A finite number from `low` to `high`, or with `above` above `low`."""
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, numbers.Real):
        raise TypeError(f"{name}: a number is expected, not {type(value).__name__}")
    value = float(value)
    if not math.isfinite(value) or value > high or value < low or (above and value == low):
        bound = f"above {low:g}" if above else f"from {low:g} to {high:g}"
        raise ValueError(f"{name}: a finite number {bound} is expected, not {value}")
    return value


def whole(name, value, low=0, high=2**31 - 1):
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, numbers.Integral):
        raise TypeError(f"{name}: a whole number is expected, not {type(value).__name__}")
    if not low <= int(value) <= high:
        raise ValueError(f"{name}: a whole number from {low} to {high} is expected, not {value}")
    return int(value)


def optional(name, value, *bounds, **options):
    return None if value is None else number(name, value, *bounds, **options)


def flag(name, value):
    if not isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{name}: True or False is expected, not {type(value).__name__}")
    return bool(value)


def word(name, value, words):
    if not isinstance(value, str):
        raise TypeError(f"{name}: a text is expected, not {type(value).__name__}")
    if "\0" in value:
        raise ValueError(f"{name}: a text is expected, not {value!r}")
    if words and value not in words:
        raise ValueError(f"{name}: one of {', '.join(words)} is expected, not {value!r}")
    return value


def path(name, value):
    try:
        text = os.fsdecode(os.fspath(value))
    except TypeError:
        raise TypeError(f"{name}: a path is expected, not {type(value).__name__}") from None
    if "\0" in text or not text:
        raise ValueError(f"{name}: a path is expected, not {text!r}")
    return text


def callback(name, value):
    if value is not None and not callable(value):
        raise TypeError(f"{name}: a function of one number from 0 to 1 is expected, not "
                        f"{type(value).__name__}")
    return value


def depths(name, value):
    """A list of finite numbers, of anything that can be gone through."""
    if value is None:
        return []
    if isinstance(value, (str, bytes)) or not hasattr(value, "__iter__"):
        raise TypeError(f"{name}: a list of depths in m is expected, not {type(value).__name__}")
    return [number(f"{name}[{i}]", v) for i, v in enumerate(value)]
