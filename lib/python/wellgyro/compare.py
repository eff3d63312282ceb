"""Error models: what a survey is worth, two surveys of one hole, many in one."""
from __future__ import annotations

import dataclasses
import io
import os
import tempfile
from collections.abc import Iterable, Sequence

import numpy as np
import pandas as pd

from . import _checks, _toml, _wellgyro
from .survey import PathLike, Result, _frame

_AZIMUTHS = ("azimuth_true_deg", "azimuth_deg", "azimuth_grid_deg")
_COVARIANCES = ("var_nn_m2", "cov_ne_m2", "cov_nv_m2", "var_ee_m2", "cov_ev_m2", "var_vv_m2")
SurveyLike = "PathLike | Result | pd.DataFrame"


def _place(latitude_deg, convergence_deg, gravity_mps2, field_nt, dip_deg, declination_deg):
    return _wellgyro.Place(
        _checks.optional("latitude_deg", latitude_deg, -90, 90),
        _checks.optional("convergence_deg", convergence_deg, -180, 180),
        _checks.optional("gravity_mps2", gravity_mps2, 9, 11),
        _checks.optional("field_nt", field_nt, 1e3, 1e6),
        _checks.optional("dip_deg", dip_deg, -90, 90),
        _checks.optional("declination_deg", declination_deg, -180, 180))


def _column(name, frame, key):
    values = np.ascontiguousarray(frame[key].to_numpy(dtype=np.float64))
    if not np.isfinite(values).all():
        row = int(np.flatnonzero(~np.isfinite(values))[0])
        raise ValueError(f"{name}: finite {key} is expected, row {row} has {values[row]}")
    return values


def _sigmas(frame, cov):
    """(n, 8) of what a table says of its own errors, or None."""
    if cov is None and all(c in frame for c in _COVARIANCES):
        six = frame[list(_COVARIANCES)].to_numpy(dtype=np.float64)
    elif cov is not None:
        six = np.stack([cov[:, i, j] for i, j in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))],
                       axis=1)
    else:
        return None
    names = ["sigma_inclination_deg", "sigma_azimuth_deg"]
    if not all(n in frame for n in names):
        return None
    own = np.hstack([frame[names].to_numpy(dtype=np.float64), six])
    return np.ascontiguousarray(own) if np.isfinite(own).all() else None


def _known(name, survey, model, place_convergence):
    """A survey of any of the kinds that the functions take, with its model or its own sigmas."""
    model = "" if model is None else _checks.word(f"model of {name}", os.fspath(model) if isinstance(
        model, os.PathLike) else model, None)
    if isinstance(survey, (str, os.PathLike)):
        place = _wellgyro.Place(None, place_convergence, None, None, None, None)
        return _wellgyro.survey_of_file(_checks.path(name, survey), model, place)
    cov = None
    if isinstance(survey, Result):
        survey, cov = survey.stations, survey.cov
    if not isinstance(survey, pd.DataFrame):
        raise TypeError(f"{name}: a path, a Result or a DataFrame is expected, not "
                        f"{type(survey).__name__}")
    azimuths = [a for a in _AZIMUTHS if a in survey]
    for key in ("md_m", "inclination_deg"):
        if key not in survey:
            raise ValueError(f"{name}: a column {key} is expected; there are {list(survey)}")
    if not azimuths:
        raise ValueError(f"{name}: a column azimuth_true_deg is expected; there are {list(survey)}")
    if len(survey) < 2:
        raise ValueError(f"{name}: at least two stations are expected")
    start = [0.0, 0.0, float(survey["md_m"].iloc[0])]
    places = ("north_m", "east_m", "tvd_m")
    if all(p in survey for p in places) and survey[list(places)].iloc[0].notna().all():
        start = [float(survey[p].iloc[0]) for p in places]
    return _wellgyro.survey_of_arrays(
        _column(name, survey, "md_m"), _column(name, survey, "inclination_deg"),
        _column(name, survey, azimuths[0]), start, model,
        None if model else _sigmas(survey, cov))


@dataclasses.dataclass(frozen=True)
class Uncertainty:
    """Position covariances of a survey by an error model, 1 sigma."""
    stations: pd.DataFrame  #: md_m, and the horizontal ellipse's semi-axes at `confidence`
    cov: np.ndarray  #: (n, 3, 3) of north, east, down [m2]
    terms: dict[str, np.ndarray]  #: the same of each term, where asked for
    confidence: float
    notes: list[str]  #: assumptions that were made
    refusal: str | None  #: where the model ends before the survey does


def uncertainty(survey: SurveyLike, model: str | PathLike | None = None, *,
                latitude_deg: float | None = None, convergence_deg: float | None = None,
                gravity_mps2: float | None = None, field_nt: float | None = None,
                dip_deg: float | None = None, declination_deg: float | None = None,
                confidence: float = 0.95, terms: bool = False) -> Uncertainty:
    """Covariances of a survey (path, Result, DataFrame) by an error model, a name of `models()` or
    a file; or of a program of legs (.toml), which names its models."""
    place = _place(latitude_deg, convergence_deg, gravity_mps2, field_nt, dip_deg, declination_deg)
    confidence = _checks.number("confidence", confidence, 1e-6, 1 - 1e-9)
    known = _known("survey", survey, model, convergence_deg)
    made = _wellgyro.uncertainty(known, place, confidence, _checks.flag("terms", terms))
    names = ("md_m", "semi_major_m", "semi_minor_m", "azimuth_major_deg")
    return Uncertainty(pd.DataFrame({n: made[n] for n in names}), made["cov"], made["terms"],
                       confidence, known.notes + made["notes"], made["refusal"])


@dataclasses.dataclass(frozen=True)
class Shift:
    """A part of a difference that is the same all along."""
    value: float
    sigma: float
    smallest: float  #: that would be found four times in five


@dataclasses.dataclass(frozen=True)
class Comparison:
    """Two surveys of one hole at equal depths: the second less the first, 1 sigma."""
    places: pd.DataFrame  #: of d_north_m.. what different stations make is between_north_m..
    cov: np.ndarray  #: (n, 3, 3) of the rest of the difference, north, east, down [m2]
    checks: pd.DataFrame
    verdict: str  #: pass, warn or fail
    causes: list[str]
    depth_offset_m: Shift | None  #: None where the surveys cannot show it
    depth_stretch_m_per_km: Shift | None
    azimuth_offset_deg: Shift | None
    kink_deg2_per_m: float  #: how the hole leaves the arcs between stations: its curvature as
    wander_deg2_per_m3: float  #: white noise, and as a random walk
    notes: list[str]


def compare(a: SurveyLike, b: SurveyLike, *, model_a: str | PathLike | None = None,
            model_b: str | PathLike | None = None, latitude_deg: float | None = None,
            convergence_deg: float | None = None, gravity_mps2: float | None = None,
            field_nt: float | None = None, dip_deg: float | None = None,
            declination_deg: float | None = None, at: Iterable[float] | None = None,
            every: float | None = None, same_run: bool = False,
            local_sigma_deg: float = 0.05) -> Comparison:
    """Holds two surveys (path, Result, DataFrame) against each other, each by its error model or,
    without one, by the sigmas that it has.

    at: depths [m]; every: whole multiples of so many metres; else the stations of the coarser one.
    Places are held against each other summed over stations in common, that a coarser survey's arcs
    are no difference.
    same_run: both are passes of one tool in one run. local_sigma_deg: of each difference of
    direction, for what no model speaks of."""
    place = _place(latitude_deg, convergence_deg, gravity_mps2, field_nt, dip_deg, declination_deg)
    at = _checks.depths("at", at)
    every = 0.0 if every is None else _checks.number("every", every, 0, above=True)
    local_sigma_deg = _checks.number("local_sigma_deg", local_sigma_deg, 0, 50, above=True)
    same_run = _checks.flag("same_run", same_run)
    first = _known("a", a, model_a, convergence_deg)
    second = _known("b", b, model_b, convergence_deg)
    made = _wellgyro.compare(first, second, place, at, every, same_run, local_sigma_deg)
    shifts = [None if made[n] is None else Shift(*made[n])
              for n in ("depth_offset_m", "depth_stretch_m_per_km", "azimuth_offset_deg")]
    return Comparison(_frame(made["places"]), made["places"]["cov"], _frame(made["checks"]),
                      made["verdict"], made["causes"], *shifts, made["kink_deg2_per_m"],
                      made["wander_deg2_per_m3"], first.notes + second.notes + made["notes"])


@dataclasses.dataclass(frozen=True)
class Merged:
    """One definitive survey out of legs."""
    stations: pd.DataFrame
    cov: np.ndarray  #: (n, 3, 3) of north, east, down [m2]
    files: dict[str, str]  #: as the program writes them: definitive.csv, choices.csv ...
    verdict: str
    causes: list[str]
    notes: list[str]
    summary: str


def merge(legs: Sequence[dict] | PathLike, policy: dict | None = None, *,
          parent: dict | None = None, tie_in: dict | None = None, name: str = "",
          latitude_deg: float | None = None, convergence_deg: float | None = None,
          gravity_mps2: float | None = None, field_nt: float | None = None,
          dip_deg: float | None = None, declination_deg: float | None = None,
          at: Iterable[float] | None = None, every: float | None = None) -> Merged:
    """One survey out of legs that may overlap, follow each other or begin below each other.

    legs: dicts of survey (path, Result, DataFrame) and model, with name, run, from_md_m, to_md_m,
    left_out; or the path of a plan (.toml) with all of it. policy, parent, tie_in: as in a plan,
    see `wellgyro merge --help`."""
    place = _place(latitude_deg, convergence_deg, gravity_mps2, field_nt, dip_deg, declination_deg)
    at = _checks.depths("at", at)
    every = 0.0 if every is None else _checks.number("every", every, 0, above=True)
    if isinstance(legs, (str, os.PathLike)):
        if policy is not None or parent is not None or tie_in is not None:
            raise ValueError("policy: the plan names policy, parent and tie-in itself")
        plan = _checks.path("legs", legs)
        return _merged(_wellgyro.merge("", plan, place, at, every))
    if not isinstance(legs, (list, tuple)) or not all(isinstance(leg, dict) for leg in legs):
        raise TypeError("legs: a list of dicts, or the path of a plan, is expected")
    with tempfile.TemporaryDirectory() as folder:
        listed = []
        for i, leg in enumerate(legs):
            if "survey" not in leg:
                raise ValueError(f"legs[{i}]: a survey is expected")
            listed.append({"name": f"leg {i + 1}", **leg,
                           "survey": _leg_file(f"legs[{i}]", leg["survey"], folder, i)})
            if isinstance(leg.get("model"), (str, os.PathLike)) and os.path.exists(leg["model"]):
                listed[-1]["model"] = os.path.abspath(leg["model"])
        if parent is not None and "program" in parent:
            parent = {**parent, "program": os.path.abspath(parent["program"])}
        text = _toml.dumps({"format": "wellgyro.merge/1", "name": name or None,
                            "policy": policy, "parent": parent, "tie_in": tie_in, "leg": listed})
        return _merged(_wellgyro.merge(text, folder, place, at, every))


def _leg_file(name, survey, folder, number):
    """The absolute path of a leg's survey, written where it is none yet, with every digit."""
    if isinstance(survey, (str, os.PathLike)):
        return os.path.abspath(_checks.path(name, survey))
    if isinstance(survey, Result):
        survey = survey.stations
    if not isinstance(survey, pd.DataFrame):
        raise TypeError(f"{name}: a path, a Result or a DataFrame is expected, not "
                        f"{type(survey).__name__}")
    columns = {"md_m": "MD[m]", "inclination_deg": "INC[deg]"}
    columns |= {a: h for a, h in (("azimuth_true_deg", "AZI_TRUE[deg]"), ("azimuth_deg", "AZI[deg]"))
                if a in survey}
    for key in columns:
        if key not in survey:
            raise ValueError(f"{name}: a column {key} is expected; there are {list(survey)}")
    if len(columns) == 2:
        raise ValueError(f"{name}: a column azimuth_true_deg is expected; there are {list(survey)}")
    path = os.path.join(folder, f"leg-{number + 1}.csv")
    survey[list(columns)].rename(columns=columns).to_csv(path, index=False)
    return path


def _merged(made):
    position = made["position"]
    stations = pd.DataFrame({
        "md_m": made["md_m"], "inclination_deg": made["inclination_deg"],
        "azimuth_deg": made["azimuth_deg"], "tvd_m": position[:, 2], "north_m": position[:, 0],
        "east_m": position[:, 1], "dogleg_deg_per_30m": made["dogleg_deg_per_30m"]})
    return Merged(stations, made["cov"], made["files"], made["verdict"], made["causes"],
                  made["notes"], made["summary"])


@dataclasses.dataclass(frozen=True)
class EmpiricalModel:
    """Magnitudes of an error model's terms from surveys of the same holes."""
    toml: str  #: the model, for `uncertainty` and every other that takes one
    terms: pd.DataFrame  #: assumed, magnitude, lower95, upper95 in `unit`; kept: why as assumed
    holes: pd.DataFrame  #: chi_square of each over its freedom, by the model that came of all
    files: dict[str, str]  #: model.toml, estimates.csv, holes.csv
    notes: list[str]


def empirical_model(holes: Sequence[dict], assumed: str | PathLike, *,
                    local_sigma_deg: float = 0.05) -> EmpiricalModel:
    """Magnitudes of a model by restricted maximum likelihood from how surveys of one hole differ.

    holes: dicts of surveys (a list of path, Result or DataFrame), name, runs (a number for each
    survey; those of one number are passes of one tool in one run; absent: all of their own) and of
    the place: latitude_deg, convergence_deg, gravity_mps2, field_nt, dip_deg, declination_deg.
    local_sigma_deg: where the search for what no term speaks of begins."""
    local_sigma_deg = _checks.number("local_sigma_deg", local_sigma_deg, 0, 50, above=True)
    if not isinstance(holes, (list, tuple)) or not all(isinstance(h, dict) for h in holes):
        raise TypeError("holes: a list of dicts is expected")
    assumed = os.fspath(assumed) if isinstance(assumed, os.PathLike) else assumed
    assumed = _checks.word("assumed", assumed, None)
    given = []
    for i, hole in enumerate(holes):
        hole = dict(hole)
        surveys = hole.pop("surveys", None)
        if not isinstance(surveys, (list, tuple)):
            raise TypeError(f"holes[{i}]: surveys, a list, is expected")
        runs = hole.pop("runs", list(range(len(surveys))))
        if len(runs) != len(surveys):
            raise ValueError(f"holes[{i}]: as many runs as surveys are expected")
        name = _checks.word(f"name of holes[{i}]", hole.pop("name", f"hole {i + 1}"), None)
        place = {k: hole.pop(k, None) for k in ("latitude_deg", "convergence_deg", "gravity_mps2",
                                                "field_nt", "dip_deg", "declination_deg")}
        if hole:
            raise TypeError(f"holes[{i}]: there is no {sorted(hole)[0]!r}")
        known = [(_known(f"holes[{i}].surveys[{k}]", s, None, place["convergence_deg"]),
                  _checks.whole(f"holes[{i}].runs[{k}]", runs[k])) for k, s in enumerate(surveys)]
        given.append((name, _place(**place), known))
    made = _wellgyro.empirical_model(given, assumed, local_sigma_deg)
    tables = {}
    for name in ("estimates.csv", "holes.csv"):
        table = pd.read_csv(io.StringIO(made["files"][name]), keep_default_na=False,
                            na_values={c: [""] for c in ("LOWER95", "UPPER95")})
        tables[name] = table.rename(columns=str.lower)
    return EmpiricalModel(made["files"]["model.toml"], tables["estimates.csv"],
                          tables["holes.csv"], made["files"], made["notes"])


def models() -> list[str]:
    """Names of the error models that come with the library; each also with _Fl, on a floating rig."""
    return _wellgyro.model_names()
