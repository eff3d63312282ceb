"""Figures that people expect, by matplotlib (`pip install wellgyro[plot]`): each function draws into
`ax`, or a figure of its own, and gives the axes."""
from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from .noise import Allan
from .survey import Result


def _stations(survey):
    stations = survey.stations if isinstance(survey, Result) else survey
    if not isinstance(stations, pd.DataFrame):
        raise TypeError(f"survey: a Result or a DataFrame is expected, not {type(survey).__name__}")
    return stations


def plan(survey, *, sigmas: float = 2.0, every: int = 5, ax=None):
    """The hole from above, with every so many stations' horizontal ellipse of `sigmas` (a Result)."""
    stations = _stations(survey)
    ax = ax or plt.subplots()[1]
    ax.plot(stations.east_m, stations.north_m)
    if isinstance(survey, Result):
        turn = np.linspace(0, 2 * np.pi, 73)
        for i in range(len(stations) - 1, -1, -every):
            cov = survey.cov[i, :2, :2]
            if not np.isfinite(cov).all():
                continue
            root = np.linalg.eigh(cov)
            shape = root.eigenvectors * np.sqrt(np.maximum(root.eigenvalues, 0)) * sigmas
            north, east = shape @ np.stack([np.cos(turn), np.sin(turn)])
            ax.plot(stations.east_m.iloc[i] + east, stations.north_m.iloc[i] + north, lw=0.7,
                    color="0.5")
        ax.set_title(f"plan, ellipses of {sigmas:g} sigma")
    ax.set_aspect("equal", "datalim")
    ax.set_xlabel("east [m]")
    ax.set_ylabel("north [m]")
    return ax


def section(survey, *, azimuth_deg: float | None = None, ax=None):
    """The hole from the side, along `azimuth_deg`, or that of its closure."""
    stations = _stations(survey)
    if azimuth_deg is None:
        azimuth_deg = float(np.degrees(np.arctan2(stations.east_m.iloc[-1],
                                                  stations.north_m.iloc[-1])) % 360)
    along = (stations.north_m * np.cos(np.radians(azimuth_deg))
             + stations.east_m * np.sin(np.radians(azimuth_deg)))
    ax = ax or plt.subplots()[1]
    ax.plot(along, stations.tvd_m)
    ax.invert_yaxis()
    ax.set_aspect("equal", "datalim")
    ax.set_xlabel(f"section along {azimuth_deg:.1f} deg [m]")
    ax.set_ylabel("TVD [m]")
    return ax


def hole(survey, *, ax=None):
    """The hole in three dimensions."""
    stations = _stations(survey)
    ax = ax or plt.figure().add_subplot(projection="3d")
    ax.plot(stations.east_m, stations.north_m, stations.tvd_m)
    ax.invert_zaxis()
    ax.set_xlabel("east [m]")
    ax.set_ylabel("north [m]")
    ax.set_zlabel("TVD [m]")
    return ax


def in_out(result: Result, *, ax=None):
    """Azimuth of every pass against depth, less that of the chosen stations, with bands of 2 sigma;
    where it is surer than a degree: near vertical it says nothing."""
    stations = result.stations
    ax = ax or plt.subplots()[1]
    turns = np.unwrap(np.radians(stations.azimuth_true_deg))
    for (run, name), rows in result.passes.groupby(["run", "pass"]):
        known = ~rows.quality.str.contains("vertical") & ~(rows.sigma_azimuth_deg > 1)
        rows = rows[known].sort_values("md_m")
        off = (rows.azimuth_true_deg - np.degrees(np.interp(rows.md_m, stations.md_m, turns))
               + 180) % 360 - 180
        line, = ax.plot(off, rows.md_m, ".-", label=f"run {run}, {name}")
        band = 2 * rows.sigma_azimuth_deg
        ax.fill_betweenx(rows.md_m, off - band, off + band, color=line.get_color(), alpha=0.15, lw=0)
    ax.invert_yaxis()
    ax.set_xlabel("azimuth less the chosen one's [deg]")
    ax.set_ylabel("MD [m]")
    ax.legend()
    return ax


def allan(result: Allan, *, ax=None):
    """The deviation against averaging time, with its bounds of 95 %."""
    table = result.table
    tau, value = table.columns[0], table.columns[1]
    ax = ax or plt.subplots()[1]
    ax.loglog(table[tau], table[value])
    low = [c for c in table if c.startswith("lower95")]
    high = [c for c in table if c.startswith("upper95")]
    if low and high:
        ax.fill_between(table[tau], table[low[0]], table[high[0]], alpha=0.3)
    ax.set_xlabel("averaging time [s]")
    ax.set_ylabel(value)
    return ax
