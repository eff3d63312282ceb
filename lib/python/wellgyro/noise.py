"""Allan deviation of static logs."""
from __future__ import annotations

import dataclasses
import io
import tomllib
from collections.abc import Iterable

import numpy as np
import pandas as pd

from . import _checks, _wellgyro

_UNITS = ("rad_per_s", "deg_per_s", "deg_per_h", "mps2", "milli_g")


@dataclasses.dataclass(frozen=True)
class Allan:
    """The deviation at each averaging time, and the noise that explains it."""
    table: pd.DataFrame
    coefficients: dict[str, float]  #: as a noise file has them; empty where nothing was fitted
    noise: str | None  #: the noise file, for a job or `uncertainty --noise`
    summary: str
    notes: list[str]


def allan(x: np.ndarray, rate_hz: float, *, unit: str = "rad_per_s", deviation: str = "oadev",
          taus_s: Iterable[float] | None = None, fit: bool = True) -> Allan:
    """Allan deviation of x (n,) float64, mean rates over successive periods, with chi-square bounds;
    with `fit` quantisation, angle random walk, bias instability, rate random walk and ramp.

    deviation: adev, oadev or mdev. taus_s: averaging times; octaves where absent. NaN is a gap."""
    x = _checks.array("x", x, (None,))
    if len(x) < 3:
        raise ValueError(f"x: at least three samples are expected, not {len(x)}")
    rate_hz = _checks.number("rate_hz", rate_hz, 0, 1e9, above=True)
    unit = _checks.word("unit", unit, _UNITS)
    deviation = _checks.word("deviation", deviation, ("adev", "oadev", "mdev"))
    taus = [] if taus_s is None else [
        _checks.number(f"taus_s[{i}]", t, 0, above=True) for i, t in enumerate(taus_s)]
    made = _wellgyro.allan(x, rate_hz, unit, 1.0, deviation, taus, _checks.flag("fit", fit))
    coefficients = tomllib.loads(made["noise"])["coefficients"] if made["noise"] else {}
    return Allan(pd.read_csv(io.StringIO(made["table"])), coefficients, made["noise"],
                 made["summary"], made["notes"] + ([made["unfit"]] if made["unfit"] else []))
