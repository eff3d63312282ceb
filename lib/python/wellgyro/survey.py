"""Jobs, surveys of arrays, logs and tables, and what comes of them."""
from __future__ import annotations

import io
import os
import tempfile
from collections.abc import Callable, Sequence

import numpy as np
import pandas as pd

from . import _checks, _toml, _wellgyro

PathLike = str | os.PathLike

_GYRO = {"rad_per_s": 1.0, "deg_per_s": np.pi / 180, "deg_per_h": np.pi / 180 / 3600}
_FILES = ("survey.csv", "passes.csv", "checks.csv", "diagnosis.csv", "reliability.csv",
          "stretches.csv")
_ACCEL = {"mps2": 1.0, "g": 9.80665}


class Job:
    """What the well, the tool and the survey are: a job file, or its tables as keywords.

    Job(well={"name": "Own-1", "latitude_deg": 58.44},
        noise={"angle_random_walk_deg_per_sqrt_h": 0.005}, stations={"every_m": 10})

    A table or key that there is none of, or a value out of range, raises FileError with its name.
    """

    def __init__(self, *, folder: PathLike = ".", **tables):
        for name, table in tables.items():
            if not isinstance(table, (dict, list, tuple)):
                raise TypeError(f"{name}: a dict of keys is expected, not {type(table).__name__}")
        text = _toml.dumps({"format": "wellgyro.job/1", **tables})
        self._job = _wellgyro.parse_job(text, "job", _checks.path("folder", folder))

    @classmethod
    def load(cls, path: PathLike) -> Job:
        """Reads a job file, and the files it names."""
        job = cls.__new__(cls)
        job._job = _wellgyro.read_job(_checks.path("path", path))
        return job

    @classmethod
    def parse(cls, text: str, folder: PathLike = ".") -> Job:
        """The same of text; files that it names are relative to `folder`."""
        job = cls.__new__(cls)
        text = _checks.word("text", text, None)
        job._job = _wellgyro.parse_job(text, "job", _checks.path("folder", folder))
        return job

    @property
    def name(self) -> str:
        """Of the well."""
        return self._job.name

    @property
    def latitude_deg(self) -> float:
        return self._job.latitude_deg

    @property
    def tool_serial(self) -> str:
        """Of the tool that the job names; empty: it names none."""
        return self._job.tool_serial

    def __repr__(self):
        return f"<wellgyro.Job {self.name!r}, latitude {self.latitude_deg:g} deg>"


def _job_of(name, job):
    if isinstance(job, Job):
        return job._job
    if isinstance(job, (str, os.PathLike)):
        return Job.load(job)._job
    raise TypeError(f"{name}: a Job or the path of one is expected, not {type(job).__name__}")


def _write(path, text):
    with tempfile.NamedTemporaryFile("w", dir=os.path.dirname(path) or ".", delete=False,
                                     encoding="utf-8", newline="") as file:
        file.write(text)
    os.replace(file.name, path)


def _frame(columns):
    frame = pd.DataFrame({("pass" if k == "pass_" else k): v for k, v in columns.items()
                          if k not in ("cov", "tangent", "cov_tangent")})
    if "utc_ns" in frame:
        frame.insert(frame.columns.get_loc("utc_ns"), "utc",
                     pd.to_datetime(frame.pop("utc_ns"), unit="ns", utc=True))
    return frame


class Result:
    """What a survey came to, of one tool of the string; angles deg, lengths m, 1 sigma."""

    def __init__(self, outcome, tool: int | None = None):
        self._outcome = outcome
        self.tools: list[int] = outcome.tools()
        self.tool: int = self.tools[0] if tool is None else _checks.whole("tool", tool)
        if self.tool not in self.tools:
            raise ValueError(f"tool: one of {self.tools} is expected, not {self.tool}")

    def of(self, tool: int) -> Result:
        """The same survey's result of another tool."""
        return Result(self._outcome, tool)

    @property
    def unusable(self) -> str:
        """Why there is no survey; empty: there is one."""
        return self._outcome.unusable(self.tool)

    @property
    def stations(self) -> pd.DataFrame:
        """One chosen station a depth, the tie-in first."""
        return _frame(self._outcome.stations(self.tool))

    @property
    def passes(self) -> pd.DataFrame:
        """Every station of every run and pass."""
        return _frame(self._outcome.passes(self.tool))

    @property
    def cov(self) -> np.ndarray:
        """(n, 3, 3): of north, east and TVD of the stations [m2]; NaN where a station is unfit."""
        return self._outcome.stations(self.tool)["cov"]

    @property
    def tangent(self) -> np.ndarray:
        """(n, 3): the hole's unit tangent, north, east and down; regular at vertical."""
        return self._outcome.stations(self.tool)["tangent"]

    @property
    def cov_tangent(self) -> np.ndarray:
        """(n, 3, 3): of the tangent, across it alone [rad2]; NaN where a station is unfit."""
        return self._outcome.stations(self.tool)["cov_tangent"]

    @property
    def checks(self) -> pd.DataFrame:
        return _frame(self._outcome.checks(self.tool))

    @property
    def diagnosis(self) -> pd.DataFrame:
        """Which fault explains each run, the likeliest first; as diagnosis.csv."""
        return self._table("diagnosis.csv")

    @property
    def reliability(self) -> pd.DataFrame:
        """Of each fault the smallest that would have been noticed, and what it could have done."""
        return self._table("reliability.csv")

    @property
    def stretches(self) -> pd.DataFrame:
        """Every run along time: depth, speed, rotation, temperature, samples lost, residuals."""
        return self._table("stretches.csv")

    def _table(self, name: str) -> pd.DataFrame:
        return pd.read_csv(io.StringIO(self.csv(name)))

    @property
    def runs(self) -> pd.DataFrame:
        return _frame(self._outcome.runs(self.tool))

    @property
    def verdict(self) -> str:
        """pass, warn or fail."""
        return self._outcome.verdict(self.tool)

    @property
    def causes(self) -> list[str]:
        """Why, in words."""
        return self._outcome.causes(self.tool)

    @property
    def faults(self) -> list[str]:
        """What was left out, where and why: the first thousand."""
        return self._outcome.faults

    @property
    def fault_count(self) -> int:
        return self._outcome.fault_count

    def csv(self, name: str = "survey.csv") -> str:
        """The program's survey.csv, passes.csv, checks.csv, diagnosis.csv, reliability.csv or
        stretches.csv, to the byte."""
        name = _checks.word("name", name, _FILES)
        return self._outcome.csv(self.tool, name)

    def _export(self) -> str:
        if self.unusable:
            raise ValueError(f"table: there is no survey: {self.unusable}")
        return self._outcome.export(self.tool)

    def report(self, path: PathLike, *, units: str = "metric", paper: str = "a4") -> None:
        """The report as one HTML page: `units` metric or field, `paper` a4 or letter."""
        path = _checks.path("path", path)
        units = _checks.word("units", units, ("metric", "field"))
        paper = _checks.word("paper", paper, ("a4", "letter"))
        if self.unusable:
            raise ValueError(f"report: there is no survey: {self.unusable}")
        _write(path, _wellgyro.report(self._outcome.survey_json(self.tool), units == "field",
                                      paper == "letter"))

    def write(self, folder: PathLike) -> None:
        """passes.csv, checks.csv and survey.csv into `folder`, which is made: each whole or as it
        was."""
        folder = _checks.path("folder", folder)
        os.makedirs(folder, exist_ok=True)
        for name in ("passes.csv", "checks.csv", "survey.csv"):
            _write(os.path.join(folder, name), self.csv(name))

    def __repr__(self):
        if self.unusable:
            return f"<wellgyro.Result: {self.unusable}>"
        return f"<wellgyro.Result of {len(self.cov)} stations: {self.verdict}>"


class Survey:
    """One job being surveyed from arrays, in the order in which they come.

    Arrays are used where they lie; other threads of Python run on meanwhile. Data that cannot be
    used are left out and counted in `fault_count`; arguments that make no sense raise.
    """

    def __init__(self, job: Job | PathLike):
        self._session = _wellgyro.Session(_job_of("job", job))
        self._period_ns: dict[int, int] = {}

    def push_imu(self, t_ns: np.ndarray, gyro: np.ndarray, accel: np.ndarray, *,
                 utc_ns: np.ndarray | None = None, seq: np.ndarray | None = None,
                 mag: np.ndarray | None = None, temperature_degc: np.ndarray | None = None,
                 gyro_unit: str = "rad_per_s", accel_unit: str = "mps2",
                 period_ns: int | None = None, run: int = 0, tool: int = 0,
                 session: int = 0) -> None:
        """Samples, each the mean over the period that begins at its time, in tool axes: z down-hole,
        x to the reference mark.

        t_ns (n,) int64: the tool's clock. gyro (n, 2|3), accel (n, 3) float64: rates and specific
        forces in `gyro_unit` (rad_per_s, deg_per_s, deg_per_h) and `accel_unit` (mps2, g).
        utc_ns (n,) int64: since 1970; the tool's clock is taken for it where absent.
        seq (n,) int64: numbers of the samples; counted where absent. mag (n, 3) float64 [T].
        temperature_degc (n,). period_ns: of a sample; the mean step of `t_ns` where absent.
        """
        t_ns = _checks.array("t_ns", t_ns, (None,), np.int64)
        n = len(t_ns)
        gyro = _checks.array("gyro", gyro, (n, (2, 3)))
        accel = _checks.array("accel", accel, (n, 3))
        if utc_ns is not None:
            utc_ns = _checks.array("utc_ns", utc_ns, (n,), np.int64)
        if seq is not None:
            seq = _checks.array("seq", seq, (n,), np.int64)
        if mag is not None:
            mag = _checks.array("mag", mag, (n, 3))
        if temperature_degc is not None:
            temperature_degc = _checks.array("temperature_degc", temperature_degc, (n,))
        gyro_unit = _GYRO[_checks.word("gyro_unit", gyro_unit, _GYRO)]
        accel_unit = _ACCEL[_checks.word("accel_unit", accel_unit, _ACCEL)]
        run, tool = _checks.whole("run", run), _checks.whole("tool", tool)
        session = _checks.whole("session", session, -2**31)
        if period_ns is None and n > 1:
            period_ns = self._period_ns.get(tool, round((int(t_ns[-1]) - int(t_ns[0])) / (n - 1)))
        if period_ns is None and tool in self._period_ns:
            period_ns = self._period_ns[tool]
        if period_ns is None:
            raise ValueError("period_ns: needed where less than two samples are pushed at first")
        self._period_ns[tool] = _checks.whole("period_ns", period_ns, 1)
        self._session.push_imu(t_ns, gyro, accel, utc_ns, seq, mag, temperature_degc, gyro_unit,
                               accel_unit, self._period_ns[tool], run, tool, session)

    def push_depth(self, utc_ns: np.ndarray, md: np.ndarray, *, sigma_m: np.ndarray | None = None,
                   stopped: np.ndarray | None = None) -> None:
        """Readings of the depth system: utc_ns (n,) int64 since 1970, md (n,) float64, along-hole
        depth of the string's reference point [m]; sigma_m (n,) float64; stopped (n,) bool, while
        the string is held."""
        utc_ns = _checks.array("utc_ns", utc_ns, (None,), np.int64)
        n = len(utc_ns)
        md = _checks.array("md", md, (n,))
        if sigma_m is not None:
            sigma_m = _checks.array("sigma_m", sigma_m, (n,))
        if stopped is not None:
            stopped = _checks.array("stopped", stopped, (n,), np.bool_)
        self._session.push_depth(utc_ns, md, sigma_m, stopped)

    def adjust(self) -> Result:
        """Revises all stations from what is known so far; changes nothing that follows."""
        self._session.adjust()
        return self.current()

    def current(self) -> Result:
        """The survey as it is now."""
        return Result(self._session.current())

    def finish(self) -> Result:
        """The last revision. Nothing can be pushed after it."""
        return Result(self._session.finish())

    @property
    def fault_count(self) -> int:
        """How many data were left out."""
        return self._session.fault_count


def survey(job: Job | PathLike, data: PathLike | Sequence[PathLike], *,
           progress: Callable[[float], object] | None = None) -> Result:
    """Surveys an LCM log, or tables of sensor data (a list of them), as the program does.

    `progress` hears the share done, about a hundred times; what it raises ends the work.
    """
    held = _job_of("job", job)
    progress = _checks.callback("progress", progress)
    if isinstance(data, (list, tuple)):
        paths = [_checks.path(f"data[{i}]", p) for i, p in enumerate(data)]
        if not paths:
            raise ValueError("data: at least one path is expected")
    else:
        paths = [_checks.path("data", data)]
    if len(paths) > 1 or _wellgyro.is_sensor_table(paths[0]):
        return Result(_wellgyro.survey_tables(held, paths, progress))
    return Result(_wellgyro.survey_log(held, paths[0], progress))
