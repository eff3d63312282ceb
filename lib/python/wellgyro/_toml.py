"""Plain values as TOML; the library reads it and says what is wrong with it."""
import json
import math
import numbers
import os
import re

import numpy as np


def _key(key):
    if not isinstance(key, str):
        raise TypeError(f"{key!r}: a key is a text")
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else json.dumps(key)


def _value(name, value):
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, numbers.Integral):
        return str(int(value))
    if isinstance(value, numbers.Real):
        value = float(value)
        if not math.isfinite(value):
            raise ValueError(f"{name}: a finite number is expected, not {value}")
        return repr(value)
    if isinstance(value, (str, os.PathLike)):
        text = json.dumps(os.fsdecode(os.fspath(value)), ensure_ascii=False)
        return text.replace("\x7f", "\\u007f")
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(_value(f"{name}[{i}]", v) for i, v in enumerate(value)) + "]"
    raise TypeError(f"{name}: a number, text, flag or list is expected, not "
                    f"{type(value).__name__}")


def _table(path, table, lines):
    nested = {}
    for key, value in table.items():
        whole = isinstance(value, (list, tuple)) and value and all(
            isinstance(v, dict) for v in value)
        if isinstance(value, dict) or whole:
            nested[key] = value
        elif value is not None:
            lines.append(f"{_key(key)} = {_value('.'.join([*path, key]), value)}")
    for key, value in nested.items():
        name = ".".join(map(_key, [*path, key]))
        for element in value if isinstance(value, (list, tuple)) else [value]:
            lines.append(f"[{name}]" if isinstance(value, dict) else f"[[{name}]]")
            _table([*path, key], element, lines)


def dumps(table):
    """Text of a dict of dicts; what is None is left out."""
    lines = []
    _table([], table, lines)
    return "\n".join(lines) + "\n"
