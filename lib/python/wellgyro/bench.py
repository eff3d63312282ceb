"""Bench data of a tool to its calibration."""
from __future__ import annotations

import dataclasses
import os
from collections.abc import Sequence

import numpy as np
import pandas as pd

from . import _checks, _wellgyro
from .survey import PathLike, _write

@dataclasses.dataclass(frozen=True)
class Calibration:
    """What a bench found of a tool; 1 sigma."""
    parameters: pd.DataFrame  #: name, value, sigma, in the units of the calibration file
    cov: np.ndarray  #: (n, n), of the parameters; (0, 0) where none can be stated
    bench: pd.DataFrame  #: level, north, drift ... of the bench itself, against what was known before
    #: What each source contributes to a parameter's sigma, the sum of the squares being its variance:
    #: `readings` by their scatter, the others by what was stated; dof, effective degrees of freedom.
    budget: pd.DataFrame
    left_out: list[str]  #: terms that the readings do not ask for, and below what they lie
    remarks: list[str]
    outlier_lines: list[int]  #: readings that were left out, by their lines in the data
    text: str  #: the calibration file
    tool: str | None  #: the tool file, where one was asked for
    summary: str

    def write(self, path: PathLike, tool: PathLike | None = None) -> None:
        """Writes the calibration file, and the tool file that a job's `[tool] file` names."""
        if tool is not None and self.tool is None:
            raise ValueError("tool: none was made; calibrate(..., tool=True) makes one")
        _write(_checks.path("path", path), self.text)
        if tool is not None:
            _write(_checks.path("tool", tool), self.tool)


def _table(name, table):
    if isinstance(table, (str, os.PathLike)):
        return _checks.path(name, table), None
    if isinstance(table, pd.DataFrame):
        return name, table.to_csv(index=False, float_format="%.17g")
    raise TypeError(f"{name}: a DataFrame or a path is expected, not {type(table).__name__}")


def _tool(tool):
    if tool is None or tool is False:
        return None
    if tool is True:
        return ""
    path = _checks.path("tool", tool)
    try:
        with open(path, encoding="utf-8") as file:
            return file.read()
    except (OSError, UnicodeError) as error:
        raise _wellgyro.FileError(f"{path}: {error}") from None


def calibrate(data: PathLike | pd.DataFrame | Sequence[PathLike | pd.DataFrame], *,
              latitude_deg: float | None = None, gravity_g: float | None = None,
              gravity_mps2: float | None = None, bench_axes: str = "trade",
              level_deg: float | None = None, north_sigma_deg: float | None = None,
              inclination_sigma_deg: float | None = None,
              latitude_sigma_deg: float | None = None, seat_arcsec: float | None = None,
              rate_scale_ppm: float | None = None, drift_deg_per_h: float | None = None,
              second_order_ug_per_g2: float | None = None,
              anisoelastic_deg_per_h_per_g2: float | None = None,
              wobble_arcsec: float | None = None,
              sigma_accel: float | None = None, sigma_deg_per_h: float | None = None,
              sigma_table_deg_per_h: float | None = None, max_degree: int | None = None,
              tool: bool | PathLike = False, channels: Sequence[int] | None = None,
              unit_per_count: Sequence[float] | None = None, asset_serial: str | None = None,
              sensor_serials: str | None = None, date: str = "",
              expires: str = "") -> Calibration:
    """All bench data of a tool in one adjustment, as `wellgyro calibrate tool`.

    data: tables of positions (columns inc, az, tf [deg] and Gx, Gy, Gz or fx, fy, fz or vx, vy,
    vz and m_x1 ..) and of a rate table (axis, rate_deg_s, m_x1 ..), with T_C and t_s where
    written down. Gravity is normal at the latitude unless told, without one 1 g; gyros need the
    latitude. The sigmas are what is known of the bench before its readings; of readings, found
    where absent. tool: True makes a tool file, a path brings that one up to date; channels,
    unit_per_count and what follows go into it.
    A table that cannot be used raises FileError."""
    if isinstance(data, (str, os.PathLike, pd.DataFrame)):
        data = [data]
    if not isinstance(data, Sequence) or len(data) == 0:
        raise TypeError(f"data: a list of tables or paths is expected, not {type(data).__name__}")
    tables = [_table(f"data[{i}]", table) for i, table in enumerate(data)]
    bench, given = _wellgyro.Bench(), dict(locals())
    for name, low, high in (("latitude_deg", -90, 90), ("gravity_g", 0.97, 1.03),
                            ("gravity_mps2", 9.5, 10.1)):
        setattr(bench, name, _checks.optional(name, given[name], low, high))
    if gravity_g is not None and gravity_mps2 is not None:
        raise ValueError("gravity_g: either this or gravity_mps2 is expected")
    # Each option of the program that states a sigma is an argument here.
    for option in _wellgyro.sigma_names():
        name = option.replace("-", "_")
        if given[name] is not None:
            bench.sigmas = {**bench.sigmas, option: _checks.number(name, given[name], 1e-15, 1e15)}
    bench.tool_axes = _checks.word("bench_axes", bench_axes, ("trade", "tool")) == "tool"
    if max_degree is not None:
        bench.max_degree = _checks.whole("max_degree", max_degree, 0, 3)
    bench.tool = _tool(tool)
    if channels is not None:
        bench.channels = [_checks.whole(f"channels[{i}]", c, 0, 255) for i, c in enumerate(channels)]
    if unit_per_count is not None:
        bench.unit_per_count = [_checks.number(f"unit_per_count[{i}]", u, 1e-15, 1e15)
                                for i, u in enumerate(unit_per_count)]
    for name in ("asset_serial", "sensor_serials"):
        if given[name] is not None:
            setattr(bench, name, _checks.word(name, given[name], None))
    bench.date, bench.expires = (_checks.word(n, given[n], None) for n in ("date", "expires"))
    made = _wellgyro.calibrate(tables, bench)
    values, cov = made["values"], made["cov"]
    sigma = np.sqrt(np.diag(cov)) if cov.size else np.full(len(values), np.nan)
    parameters = pd.DataFrame({"name": made["parameters"], "value": values, "sigma": sigma})
    budget = pd.DataFrame(made["budget"], index=made["parameters"])
    return Calibration(parameters, cov, pd.DataFrame(made["bench"]), budget, made["left_out"],
                       made["remarks"], made["outlier_lines"], made["text"], made["tool"],
                       made["summary"])
