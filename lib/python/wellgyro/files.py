"""Survey files of the trade, as tables."""
from __future__ import annotations

import io
import os

import pandas as pd

from . import _checks, _wellgyro
from .survey import PathLike, Result

# Every digit counts; from pandas 3 on that is how it reads.
_EXACT = {} if int(pd.__version__.split(".")[0]) >= 3 else {"float_precision": "round_trip"}
_ENDINGS = {".csv": "csv", ".las": "las", ".p717": "p717", ".p7": "p717", ".xml": "witsml",
            ".dev": "petrel", ".txt": "compass", ".json": "osdu", ".geojson": "geojson",
            ".kml": "kml", ".gpkg": "gpkg"}
_FORMATS = ("csv", "las", "p717", "witsml", "witsml21", "petrel", "compass", "osdu", "geojson",
            "kml", "gpkg")
_NAMES = {"MD[m]": "md_m", "INC[deg]": "inclination_deg", "AZI_TRUE[deg]": "azimuth_true_deg",
          "AZI_GRID[deg]": "azimuth_grid_deg", "AZI_MAG[deg]": "azimuth_magnetic_deg",
          "AZI[deg]": "azimuth_deg", "GTF[deg]": "toolface_deg", "TVD[m]": "tvd_m",
          "N[m]": "north_m", "E[m]": "east_m", "DLS[deg/30m]": "dogleg_deg_per_30m",
          "VAR_NN[m2]": "var_nn_m2", "COV_NE[m2]": "cov_ne_m2", "COV_NV[m2]": "cov_nv_m2",
          "VAR_EE[m2]": "var_ee_m2", "COV_EV[m2]": "cov_ev_m2", "VAR_VV[m2]": "var_vv_m2",
          "SIG_INC[deg]": "sigma_inclination_deg", "SIG_AZI[deg]": "sigma_azimuth_deg",
          "NORTHING[m]": "northing_m", "EASTING[m]": "easting_m", "KIND": "kind",
          "QUALITY": "quality", "STATUS": "status"}


def read(path: PathLike, *, format: str | None = None, columns: dict[str, str] | None = None,
         depth_unit: str | None = None, north: str | None = None,
         convergence_deg: float | None = None, declination_deg: float | None = None,
         well: str | None = None) -> pd.DataFrame:
    """A survey file of any format that `wellgyro convert` reads, in m and deg.

    What the file leaves open is settled by its numbers, or is to be said: format, columns (canonical
    name to heading), depth_unit (m, ft, ftUS), north of its azimuths (true, grid, magnetic).
    `attrs["head"]` holds what the file says besides, `attrs["notes"]` what was settled."""
    path = _checks.path("path", path)
    if columns is not None and not isinstance(columns, dict):
        raise TypeError(f"columns: a dict is expected, not {type(columns).__name__}")
    text, notes = _wellgyro.read_as_csv(
        path, "" if format is None else _checks.word("format", format, (*_FORMATS, "witsml20")),
        [(str(k), str(v)) for k, v in (columns or {}).items()],
        "" if depth_unit is None else _checks.word("depth_unit", depth_unit, ("m", "ft", "ftUS")),
        "" if north is None else _checks.word("north", north, ("true", "grid", "magnetic")),
        _checks.optional("convergence_deg", convergence_deg, -180, 180),
        _checks.optional("declination_deg", declination_deg, -180, 180),
        "" if well is None else _checks.word("well", well, None))
    head = [line for line in text.splitlines() if line.startswith("#")]
    frame = pd.read_csv(io.StringIO(text), skiprows=len(head), **_EXACT)
    frame = frame.rename(columns=_NAMES)
    # A certificate is of the file's own bytes, not of a table that may be changed.
    frame.attrs["head"] = "\n".join(h for h in head if "wellgyro certificate" not in h)
    frame.attrs["notes"] = notes
    return frame


def _text(table):
    back = {v: k for k, v in _NAMES.items()}
    known = [c for c in table.columns if c in back or "[" in str(c) or str(c).isupper()]
    if "revision" in table:  # of a Result: its status says which revision it is of, not what it is
        known = [c for c in known if c != "status"]
    head = table.attrs.get("head", "")
    return (head + "\n" if head else "") + table[known].rename(columns=back).to_csv(index=False)


def write(table: Result | pd.DataFrame, path: PathLike, *,
          format: str | None = None) -> list[str]:
    """Writes a Result, with its covariances and its verdict, or a table as `read` gives it or as
    stations are, in the format that the ending of `path` says, or `format`. Gives what the format
    cannot hold, a sentence each."""
    path = _checks.path("path", path)
    if not isinstance(table, (Result, pd.DataFrame)):
        raise TypeError(f"table: a Result or a DataFrame is expected, not {type(table).__name__}")
    if format is None:
        format = _ENDINGS.get(os.path.splitext(path)[1].lower())
        if format is None:
            raise ValueError(f"path: an ending of {', '.join(_ENDINGS)} is expected, or a format")
    format = _checks.word("format", format, _FORMATS)
    text = table._export() if isinstance(table, Result) else _text(table)
    files, losses = _wellgyro.files_of_csv(text, format, os.path.basename(path))
    folder = os.path.dirname(os.path.abspath(path))
    for name, content in files.items():
        whole = os.path.join(folder, name)
        with open(whole + ".part", "wb") as file:
            file.write(content)
        os.replace(whole + ".part", whole)
    return losses
