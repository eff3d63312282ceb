#!/usr/bin/env python3
"""The Python package against the program, which WELLGYRO_PROGRAM names, and against numpy."""
import contextlib
import json
import math
import os
import random
import re
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np
import pandas as pd

import wellgyro as wg
from small_runs import JOB, SIMULATION

PROGRAM = os.path.abspath(os.environ["WELLGYRO_PROGRAM"])
TOP = os.path.realpath(os.path.join(os.path.dirname(__file__), "..", ".."))
DEMO = os.path.join(TOP, "data", "demo")
DEG = math.pi / 180


def Run(*arguments):
    return subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, check=False,
                          timeout=300)


def Memory(name):
    """Of this process, now (VmRSS) or at most (VmHWM) [MB]."""
    with open("/proc/self/status", encoding="ascii") as file:
        return int(re.search(rf"^{name}:\s+(\d+) kB", file.read(), re.M).group(1)) / 1024


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = folder.name
        cls.Write("job.toml", JOB.format(latitude=61.0))

    @classmethod
    def Path(cls, *names):
        return os.path.join(cls.folder, *names)

    @classmethod
    def Write(cls, name, text):
        with open(cls.Path(name), "w", encoding="utf-8") as file:
            file.write(text)
        return cls.Path(name)

    @classmethod
    def Log(cls, seed, inclination=25.0, azimuth=300.0):
        path = cls.Path(f"run-{seed}.lcm")
        if not os.path.exists(path):
            plan = cls.Write(f"s-{seed}.toml", SIMULATION.format(
                seed=seed, inclination=inclination, azimuth=azimuth, hz=20.0))
            done = Run("simulate", "--job", plan, "--out", path)
            assert done.returncode == 0, done.stderr
        return path


class Surveys(Package):
    def Same(self, result, folder):
        for name in ("survey.csv", "passes.csv", "checks.csv", "diagnosis.csv", "reliability.csv",
                     "stretches.csv"):
            with open(os.path.join(folder, name), encoding="utf-8", newline="") as file:
                self.assertEqual(result.csv(name), file.read(), f"{folder} {name}")

    def test_logs_give_the_bytes_of_the_program(self):
        job = wg.Job.load(self.Path("job.toml"))
        for seed in range(LOGS):
            log = self.Log(seed, inclination=5 + 70 * (seed / LOGS), azimuth=7 * seed)
            out = self.Path(f"out-{seed}")
            done = Run("survey", "--job", self.Path("job.toml"), "--from", log, "--out", out)
            self.assertIn(done.returncode, (0, 3, 4), done.stderr)
            self.Same(wg.survey(job, log), out)

    def Arrays(self):
        log = self.Log(3)
        samples, depths = self.Path("samples.csv"), self.Path("samples.depth.csv")
        if not os.path.exists(samples):
            assert Run("convert", log, samples).returncode == 0
        return pd.read_csv(samples), pd.read_csv(depths), samples, depths

    def test_arrays_tables_and_the_program_agree(self):
        samples, depths, *paths = self.Arrays()
        out = self.Path("out-tables")
        done = Run("survey", "--job", self.Path("job.toml"), "--from", paths[0], "--from", paths[1],
                   "--out", out)
        self.assertIn(done.returncode, (0, 4), done.stderr)
        self.Same(wg.survey(self.Path("job.toml"), paths), out)
        self.assertEqual(self.Pushed(samples, depths).csv(),
                         wg.survey(self.Path("job.toml"), paths).csv())

    def Pushed(self, samples, depths, pieces=1):
        survey = wg.Survey(self.Path("job.toml"))
        def Ns(frame, name):
            column = next(c for c in frame if c.startswith(name + "["))
            scale = {"s": 10**9, "us": 1000, "ns": 1}[column[len(name) + 1:-1]]
            values = frame[column]
            return np.ascontiguousarray(np.round(values.to_numpy() * scale).astype(np.int64))
        def Columns(frame, names, unit):
            found = [next(c for c in frame if c.startswith(n + "[")) for n in names]
            self.assertTrue(all(unit in c for c in found), found)
            return np.ascontiguousarray(frame[found].to_numpy())
        t, utc = Ns(samples, "TOOL"), Ns(samples, "UTC")
        gyro, accel = Columns(samples, ("GX", "GY"), "rad/s"), Columns(
            samples, ("AX", "AY", "AZ"), "m/s2")
        survey.push_depth(Ns(depths, "UTC"), Columns(depths, ("MD",), "m")[:, 0].copy(),
                          stopped=depths.STOPPED.to_numpy().astype(bool))
        edges = np.linspace(0, len(t), pieces + 1).astype(int)
        for a, b in zip(edges[:-1], edges[1:]):
            survey.push_imu(t[a:b], gyro[a:b], accel[a:b], utc_ns=utc[a:b],
                            temperature_degc=np.full(b - a, 20.0), run=1)
        return survey.finish()

    def test_pieces_make_no_difference(self):
        samples, depths, *_ = self.Arrays()
        whole, cut = self.Pushed(samples, depths), self.Pushed(samples, depths, pieces=7)
        self.assertEqual(whole.csv(), cut.csv())

    def test_a_result_has_what_its_files_have(self):
        told = []
        result = wg.survey(wg.Job.load(self.Path("job.toml")), self.Log(3), progress=told.append)
        stations = result.stations
        self.assertEqual(list(stations.md_m), [0, 20, 40, 60, 80])
        self.assertEqual(result.cov.shape, (5, 3, 3))
        np.testing.assert_allclose(result.cov, result.cov.transpose(0, 2, 1), rtol=1e-12,
                                   atol=1e-15)
        self.assertTrue((np.linalg.eigvalsh(result.cov[1:]) > 0).all())
        inclination, azimuth = np.radians(stations.inclination_deg), np.radians(stations.azimuth_true_deg)
        np.testing.assert_allclose(
            result.tangent, np.column_stack([np.sin(inclination) * np.cos(azimuth),
                                             np.sin(inclination) * np.sin(azimuth),
                                             np.cos(inclination)]), atol=1e-14)
        across = np.einsum("nij,nj->ni", result.cov_tangent, result.tangent)
        self.assertLess(np.abs(across).max(), 1e-12)
        self.assertEqual(str(stations.utc.dtype), "datetime64[ns, UTC]")
        self.assertIn(result.verdict, ("pass", "warn"))
        self.assertIn("gravity", set(result.checks.code))
        self.assertEqual(list(result.runs.run), [1])
        self.assertEqual(told, sorted(told))
        self.assertEqual(told[-1], 1.0)
        result.write(self.Path("written"))
        with open(self.Path("written", "survey.csv"), encoding="utf-8") as file:
            self.assertEqual(file.read(), result.csv())

    def test_a_report_is_the_programs(self):
        log, out = self.Log(3), self.Path("out-report")
        done = Run("survey", "--job", self.Path("job.toml"), "--from", log, "--out", out, "--report")
        self.assertIn(done.returncode, (0, 3, 4), done.stderr)
        result = wg.survey(self.Path("job.toml"), log)
        self.assertEqual(list(result.diagnosis.columns)[:2], ["RUN", "CODE"])
        self.assertAlmostEqual(result.diagnosis.POSTERIOR.sum(), 1, delta=1e-6)
        self.assertGreater(len(result.reliability), 10)
        self.assertTrue((result.stretches["T[s]"].diff().dropna() > 0).all())
        result.report(self.Path("of-python.html"))
        def Document(path):
            with open(path, encoding="utf-8") as file:
                page = file.read()
            self.assertTrue(page.endswith("</html>\n"))
            return json.loads(re.search(r'id="survey">(.*?)</script>', page, re.S).group(1))
        ours, theirs = Document(self.Path("of-python.html")), Document(os.path.join(out, "report.html"))
        self.assertEqual(set(ours), set(theirs))
        for part in ("job", "stations", "passes", "checks", "diagnosis", "stretches", "end"):
            self.assertEqual(ours[part], theirs[part], part)
        for arguments in ({"units": "yards"}, {"paper": "a3"}):
            with self.assertRaises(ValueError):
                result.report(self.Path("none.html"), **arguments)
        with self.assertRaises(TypeError):
            result.report(3)

    def test_what_the_callback_raises_ends_the_work(self):
        def Stop(share):
            raise KeyError(f"at {share}")
        with self.assertRaises(KeyError):
            wg.survey(self.Path("job.toml"), self.Log(3), progress=Stop)

    def test_other_threads_run_meanwhile(self):
        ticks, done = [], threading.Event()
        def Tick():
            while not done.is_set():
                ticks.append(time.monotonic())
                time.sleep(0.002)
        thread = threading.Thread(target=Tick)
        thread.start()
        samples, depths, *_ = self.Arrays()
        begin = time.monotonic()
        self.Pushed(samples, depths)
        end = time.monotonic()
        done.set()
        thread.join()
        inside = [t for t in ticks if begin < t < end]
        gaps = np.diff([begin, *inside, end])
        self.assertLess(gaps.max(), max(0.25, 0.5 * (end - begin)))

    def test_jobs_of_keywords(self):
        job = wg.Job(well={"name": "Own-1", "latitude_deg": 58.44},
                     noise={"angle_random_walk_deg_per_sqrt_h": 0.005}, stations={"every_m": 10})
        self.assertEqual(job.name, "Own-1")
        self.assertAlmostEqual(job.latitude_deg, 58.44, places=12)
        for tables, says in (({"well": {"name": "x", "latitude": 3}}, "latitude_deg"),
                             ({"well": {"name": "x", "latitude_deg": 99}}, "latitude_deg"),
                             ({"wel": {}}, "wel"),
                             ({"well": {"name": "x", "latitude_deg": 3}, "noise": {"b": 1}}, "b")):
            with self.assertRaisesRegex(wg.FileError, says):
                wg.Job(**tables)
        with self.assertRaisesRegex(ValueError, "well.latitude_deg"):
            wg.Job(well={"latitude_deg": math.nan})
        with self.assertRaisesRegex(TypeError, "well"):
            wg.Job(well=3)
        with self.assertRaisesRegex(wg.FileError, "none.toml"):
            wg.Job.load(self.Path("none.toml"))
        with self.assertRaisesRegex(wg.FileError, "none.lcm"):
            wg.survey(self.Path("job.toml"), self.Path("none.lcm"))

    def test_ten_million_samples_cost_no_copy(self):
        n = SAMPLES
        survey = wg.Survey(self.Path("job.toml"))
        t = np.arange(n, dtype=np.int64) * 1_000_000 + 10**18
        gyro = np.zeros((n, 2))
        gyro[:] = (3e-5, 2e-5)
        accel = np.zeros((n, 3))
        accel[:] = (4.0, 0.5, -8.94)
        accel[::3] += 1e-3
        gyro[::3] += 1e-6
        before = Memory("VmRSS")
        # The highest so far is forgotten: arrays in the making would hide what is asked for here.
        with contextlib.suppress(OSError), open("/proc/self/clear_refs", "w",
                                                encoding="ascii") as file:
            file.write("5")
        survey.push_depth(t[[0, -1]].copy(), np.zeros(2))
        survey.push_imu(t, gyro, accel)
        grown = Memory("VmHWM") - before
        self.assertLess(grown, 50, "MB above the arrays")
        print(f"{n:.0e} samples: {grown:.1f} MB above the arrays")


class Arguments(Package):
    """What is wrong is said with the argument's name and what it should be."""

    def Good(self, n=50):
        return {"t_ns": np.arange(n, dtype=np.int64) * 10**7 + 10**18, "gyro": np.zeros((n, 2)),
                "accel": np.tile([0.0, 0.0, -9.8], (n, 1))}

    def test_each_mistake_has_its_name(self):
        good = self.Good()
        survey = wg.Survey(self.Path("job.toml"))
        nan = good["gyro"].copy()
        nan[7, 1] = math.nan
        for change, error, says in (
                ({"gyro": [[0, 0]]}, TypeError, "gyro: a numpy array of float64"),
                ({"gyro": good["gyro"].astype(np.float32)}, TypeError, "gyro: .* not of float32"),
                ({"gyro": np.zeros((50, 4))}, ValueError, r"gyro: .*\(50, 2\|3\).*\(50, 4\)"),
                ({"gyro": np.zeros((49, 2))}, ValueError, "gyro: "),
                ({"gyro": np.asfortranarray(good["gyro"])}, ValueError, "gyro: a C-contiguous"),
                ({"gyro": np.zeros((50, 4))[:, ::2]}, ValueError, "gyro: a C-contiguous"),
                ({"gyro": nan}, ValueError, r"gyro\[7, 1\] is nan"),
                ({"accel": np.full((50, 3), math.inf)}, ValueError, r"accel\[0, 0\] is inf"),
                ({"t_ns": good["t_ns"].astype(float)}, TypeError, "t_ns: an array of int64"),
                ({"gyro_unit": "deg/h"}, ValueError, "gyro_unit: one of rad_per_s"),
                ({"accel_unit": 3}, TypeError, "accel_unit: a text"),
                ({"period_ns": 0}, ValueError, "period_ns"),
                ({"period_ns": 1.5}, TypeError, "period_ns"),
                ({"run": -1}, ValueError, "run"),
                ({"mag": np.zeros(50)}, ValueError, "mag"),
                ({"units": "mps2"}, TypeError, "units")):
            with self.assertRaisesRegex(error, says):
                survey.push_imu(**{**good, **change})
        with self.assertRaisesRegex(ValueError, "md: "):
            survey.push_depth(good["t_ns"], np.zeros(3))
        with self.assertRaisesRegex(TypeError, "job: a Job"):
            wg.Survey(3)
        with self.assertRaisesRegex(TypeError, "progress"):
            wg.survey(self.Path("job.toml"), "x.lcm", progress=3)
        survey.push_imu(**good)
        survey.finish()
        with self.assertRaisesRegex(ValueError, "finished"):
            survey.push_imu(**good)

    def test_a_thousand_random_calls_raise_or_work(self):
        rng = random.Random(22)
        odd = [None, 3, -1, 1e400, math.nan, "", "x", b"x", [], {}, (), object(), np.zeros(0),
               np.zeros((3, 2)), np.zeros((50, 3)), np.zeros((50, 2), dtype=np.float32),
               np.zeros(50), np.zeros((50, 2))[::-1], np.array("a"), np.zeros((2, 2, 2)), True,
               np.int64(4), np.float64(2), pd.DataFrame(), np.full((50, 2), math.nan),
               np.zeros((50, 2), dtype=object), 2**70, self.Path("job.toml"), "\0", slice(3)]
        frame = pd.DataFrame({"md_m": [0.0, 100.0], "inclination_deg": [0.0, 5.0],
                              "azimuth_true_deg": [0.0, 5.0]})
        calls = {
            "push_imu": ({**self.Good(), "gyro_unit": "rad_per_s", "run": 0, "period_ns": 10**7},
                         None),
            "push_depth": ({"utc_ns": np.arange(50), "md": np.zeros(50)}, None),
            "allan": ({"x": np.random.default_rng(1).normal(size=100), "rate_hz": 1.0,
                       "fit": False}, wg.allan),
            "compare": ({"a": frame, "b": frame, "model_a": "GYRO-NS-CT", "model_b": "GYRO-NS-CT",
                         "latitude_deg": 60.0, "every": 50.0}, wg.compare),
            "uncertainty": ({"survey": frame, "model": "GYRO-NS-CT", "latitude_deg": 60.0},
                            wg.uncertainty),
            "merge": ({"legs": [{"survey": frame, "model": "GYRO-NS-CT"}], "latitude_deg": 60.0},
                      wg.merge),
            "read": ({"path": self.Path("job.toml")}, wg.read),
            "write": ({"table": frame, "path": self.Path("w.csv")}, wg.write),
            "Job": ({"well": {"name": "a", "latitude_deg": 3.0}}, wg.Job),
            "survey": ({"job": self.Path("job.toml"), "data": self.Path("none")}, wg.survey),
            "calibrate": ({"data": [pd.DataFrame({"inc": [0.0], "fx": [1.0]})], "level_deg": 0.5,
                           "latitude_deg": 60.0, "tool": False, "channels": [0], "date": ""},
                          wg.calibrate),
        }
        raised = 0
        for i in range(1000):
            name = rng.choice(list(calls))
            arguments, function = calls[name]
            if function is None:
                function = getattr(wg.Survey(self.Path("job.toml")), name)
            changed = dict(arguments)
            for key in rng.sample(list(changed), rng.randint(1, min(2, len(changed)))):
                changed[key] = rng.choice(odd)
            try:
                function(**changed)
            except (TypeError, ValueError, OverflowError, wg.FileError) as error:
                raised += 1
                self.assertTrue(str(error), name)
        self.assertGreater(raised, 500)


def Tangent(inc, azi):
    return np.array([np.sin(inc) * np.cos(azi), np.sin(inc) * np.sin(azi), np.cos(inc)])


class Reference:
    """A survey by numpy alone: minimum curvature, and errors of listed depth, inclination and
    azimuth from weights written out here."""

    def __init__(self, md, inc_deg, azi_deg):
        self.md = np.asarray(md)
        self.inc, self.azi = np.radians(inc_deg), np.radians(azi_deg)
        self.t = Tangent(self.inc, self.azi).T
        self.p = [np.zeros(3)]
        for k in range(1, len(md)):
            self.p.append(self.p[-1] + self.Leg(k, 1.0))

    def Dogleg(self, k):
        cross = np.linalg.norm(np.cross(self.t[k - 1], self.t[k]))
        return math.atan2(cross, float(self.t[k - 1] @ self.t[k]))

    def At(self, k, f):
        b = self.Dogleg(k)
        if b < 1e-9:
            return (1 - f) * self.t[k - 1] + f * self.t[k]
        return (math.sin((1 - f) * b) * self.t[k - 1] + math.sin(f * b) * self.t[k]) / math.sin(b)

    def Leg(self, k, f):
        b = f * self.Dogleg(k)
        ratio = 1 + b * b / 12 + b**4 / 120 if b < 1e-3 else 2 / b * math.tan(b / 2)
        s = f * (self.md[k] - self.md[k - 1])
        return s / 2 * ratio * (self.t[k - 1] + self.At(k, f))

    def Place(self, md):
        k = min(max(1, int(np.searchsorted(self.md, md))), len(self.md) - 1)
        f = (md - self.md[k - 1]) / (self.md[k] - self.md[k - 1])
        return k, f

    def Position(self, md):
        k, f = self.Place(md)
        return self.p[k - 1] + self.Leg(k, f)

    def Sources(self):
        """Errors of direction and depth at the stations, a pair a source: AZ and XYM1 systematic,
        DREF systematic, AZ random; the model of MODEL below, not doubled at the surface."""
        n = len(self.md)
        t_azi = np.stack([-np.sin(self.inc) * np.sin(self.azi), np.sin(self.inc) * np.cos(self.azi),
                          0 * self.inc], axis=1)
        t_inc = np.stack([np.cos(self.inc) * np.cos(self.azi), np.cos(self.inc) * np.sin(self.azi),
                          -np.sin(self.inc)], axis=1)
        measured = np.arange(n)[:, None] > 0
        sources = [(0.3 * DEG * t_azi * measured, np.zeros(n)),
                   (0.1 * DEG * np.abs(np.sin(self.inc))[:, None] * t_inc * measured, np.zeros(n)),
                   (np.zeros((n, 3)), np.full(n, 0.35))]
        for j in range(1, n):
            one = np.zeros((n, 3))
            one[j] = 0.2 * DEG * t_azi[j]
            sources.append((one, np.zeros(n)))
        return sources

    def Spline(self, md):
        """By the cubic spline through all stations, not a knot at either second one: a cubic a leg
        in f, its four coefficients each from the conditions on them, one after the other."""
        legs, h = len(self.md) - 1, np.diff(self.md)
        rows, right = [], []

        def Row(*parts, equals=np.zeros(3)):
            row = np.zeros(4 * legs)
            for leg, powers in parts:
                row[4 * leg:4 * leg + 4] += powers
            rows.append(row)
            right.append(equals)
        for j in range(legs):
            Row((j, [1, 0, 0, 0]), equals=self.t[j])
            Row((j, [1, 1, 1, 1]), equals=self.t[j + 1])
        for j in range(legs - 1):
            Row((j, np.array([0, 1, 2, 3]) / h[j]), (j + 1, np.array([0, -1, 0, 0]) / h[j + 1]))
            Row((j, np.array([0, 0, 2, 6]) / h[j]**2), (j + 1, np.array([0, 0, -2, 0]) / h[j + 1]**2))
        for j in (0, legs - 2):
            Row((j, np.array([0, 0, 0, 1]) / h[j]**3), (j + 1, np.array([0, 0, 0, -1]) / h[j + 1]**3))
        k, f = self.Place(md)
        cubic = np.linalg.solve(np.array(rows), np.array(right))[4 * k - 4:4 * k]
        t = np.array([1, f, f**2, f**3]) @ cubic
        return t / np.linalg.norm(t)

    def Through(self, nodes):
        """Its listing at `nodes`, and its sources there, straight between stations."""
        t = np.array([self.Spline(md) for md in nodes])
        other = Reference(nodes, np.degrees(np.arctan2(np.hypot(t[:, 0], t[:, 1]), t[:, 2])),
                          np.degrees(np.arctan2(t[:, 1], t[:, 0])))

        def At(x):
            return np.array([np.interp(nodes, self.md, column) for column in x.T]).T
        other.sources = [(At(e), At(m[:, None])[:, 0]) for e, m in self.Sources()]
        return other

    def Errors(self, md):
        """Position errors at a listed depth, a column a source of `sources`."""
        k, f = self.Place(md)
        here = self.At(k, f)
        columns = []
        for e, m in self.sources:
            total = np.zeros(3)
            for j in range(1, k):
                gained = m[j] - (m[j - 1] if j > 1 else 0)
                total += (self.md[j] - self.md[j - 1]) / 2 * (e[j - 1] + e[j])
                total += gained / 2 * (self.t[j - 1] + self.t[j])
            e_here = (1 - f) * e[k - 1] + f * e[k]
            m_here = (1 - f) * m[k - 1] + f * m[k]
            total += f * (self.md[k] - self.md[k - 1]) / 2 * (e[k - 1] + e_here)
            total += (m_here - (m[k - 1] if k > 1 else 0)) / 2 * (self.t[k - 1] + here)
            columns.append(total - here * m_here)
        return np.array(columns).T

    def OffSpline(self, md, kink, wander):
        """Variance of how far the hole is from the spline at a depth: of four even stations' cubic
        in the middle, less as a bow towards the ends."""
        k, f = self.Place(md)
        length = self.md[k] - self.md[k - 1]
        return (66 * kink * length + 3 * wander * length**3) / 256 * (4 * f * (1 - f))**2

    def Local(self, md, variance, other):
        """Covariance of the place where the direction at each node has `variance` across the mean
        of both listings."""
        k, f = self.Place(md)
        total = np.zeros((3, 3))
        for j in range(k + 1):
            gained = 0.0  # the integral of the hat of node j down to md
            if 0 < j <= k:
                part = f if j == k else 1.0
                gained += (self.md[j] - self.md[j - 1]) * part**2 / 2
            if j < k:
                part = f if j == k - 1 else 1.0
                gained += (self.md[j + 1] - self.md[j]) * (part - part**2 / 2)
            t = (self.t[j] + other.t[j]) / np.linalg.norm(self.t[j] + other.t[j])
            total += variance[j] * gained**2 * (np.eye(3) - np.outer(t, t))
        return total


def Nodes(a, b):
    """Stations of the coarser of two surveys wherever it is so, from 0 to where both end."""
    end, nodes = min(a[-1], b[-1]), [0.0]
    while (further := max(a[a > nodes[-1]][0], b[b > nodes[-1]][0])) < end:
        nodes.append(further)
    return np.array(nodes + [end])


MODEL = """format = "wellgyro.error-model/1"
name = "numpy"
revision = "1"
source = "test"
inclination_max_deg = 180.0
vertical_limit_deg = 0.0001
surface_tie_on = "single"
[[term]]
name = "AZ"
weight = "AZ"
magnitude = 0.3
unit = "deg"
propagation = "systematic"
[[term]]
name = "XYM1"
weight = "XYM1"
magnitude = 0.1
unit = "deg"
propagation = "systematic"
[[term]]
name = "DREF"
weight = "DREF"
magnitude = 0.35
unit = "m"
propagation = "systematic"
[[term]]
name = "AZR"
weight = "AZ"
magnitude = 0.2
unit = "deg"
propagation = "random"
"""


class Comparisons(Package):
    def Drawn(self, rng, spacing):
        md = np.arange(0.0, 900.0, spacing)
        md[1:] += rng.uniform(-0.3, 0.3, len(md) - 1) * spacing
        inc = 20 + 15 * np.sin(md / 300) + rng.normal(0, 0.2, len(md))
        azi = 80 + 30 * np.sin(md / 400) + rng.normal(0, 0.3, len(md))
        return pd.DataFrame({"md_m": md, "inclination_deg": inc, "azimuth_true_deg": azi})

    def test_pairs_as_numpy_has_them(self):
        model = self.Write("numpy.toml", MODEL)
        rng = np.random.default_rng(22)
        worst = worst_cov = 0.0
        for _ in range(40):
            a, b = self.Drawn(rng, 90.0), self.Drawn(rng, 60.0)
            end = min(a.md_m.iloc[-1], b.md_m.iloc[-1])
            at = sorted(rng.uniform(1.0, end, 3))
            c = wg.compare(a, b, model_a=model, model_b=model, at=at, local_sigma_deg=1e-7)
            first, second = Reference(*a.to_numpy().T), Reference(*b.to_numpy().T)
            nodes = Nodes(first.md, second.md)
            alike = [s.Through(nodes) for s in (first, second)]
            roughness = c.kink_deg2_per_m * DEG**2, c.wander_deg2_per_m3 * DEG**2
            local = [sum(s.OffSpline(md, *roughness) for s in (first, second)) for md in nodes]
            for i, md in enumerate(at):
                expected = second.Position(md) - first.Position(md)
                found = c.places[["d_north_m", "d_east_m", "d_down_m"]].iloc[i].to_numpy()
                worst = max(worst, float(np.abs(found - expected).max()))
                rest = found - c.places[["between_north_m", "between_east_m",
                                         "between_down_m"]].iloc[i].to_numpy()
                d = alike[1].Position(md) - alike[0].Position(md)
                worst = max(worst, float(np.abs(rest - d).max()))
                cov = sum((e := s.Errors(md)) @ e.T for s in alike) + alike[0].Local(md, local, alike[1])
                worst_cov = max(worst_cov, np.abs(c.cov[i] - cov).max() / np.abs(cov).max())
                sigmas = math.sqrt(d @ np.linalg.solve(cov, d))
                self.assertAlmostEqual(c.places.position_sigmas.iloc[i], sigmas, delta=1e-6)
        print(f"40 pairs: {worst:.1e} m, covariances {worst_cov:.1e} of their largest")
        self.assertLess(worst, 1e-9)
        self.assertLess(worst_cov, 1e-9)

    def test_a_result_and_a_file_and_a_table(self):
        result = wg.survey(self.Path("job.toml"), self.Log(3))
        result.write(self.Path("own"))
        by_file = wg.compare(result, self.Path("own", "survey.csv"))
        self.assertEqual(by_file.verdict, "pass")
        self.assertIsNone(by_file.depth_offset_m)
        turned = result.stations.copy()
        turned["azimuth_true_deg"] += 25.0
        c = wg.compare(turned, result.stations, model_a="GYRO-NS-CT", model_b="GYRO-NS-CT",
                       latitude_deg=61.0, same_run=True)
        self.assertEqual(c.verdict, "fail")
        self.assertAlmostEqual(c.azimuth_offset_deg.value, -25.0, delta=1.0)
        with self.assertRaisesRegex(ValueError, "b: has no covariances"):
            wg.compare(result, turned[["md_m", "inclination_deg", "azimuth_true_deg"]])

    def test_uncertainty_is_the_programs(self):
        table = self.Drawn(np.random.default_rng(5), 30.0)
        wg.write(table, self.Path("u.csv"))
        made = wg.uncertainty(table, "GYRO-NS-CT", latitude_deg=60.0, terms=True)
        done = Run("uncertainty", "--survey", self.Path("u.csv"), "--model", "GYRO-NS-CT",
                   "--latitude-deg", "60", "--out", self.Path("u"))
        self.assertEqual(done.returncode, 0, done.stderr)
        theirs = pd.read_csv(self.Path("u", "covariance.csv"))
        np.testing.assert_allclose(made.cov[:, 0, 0], theirs["VAR_NN[m2]"], rtol=1e-8, atol=1e-12)
        np.testing.assert_allclose(sum(made.terms.values()), made.cov, rtol=1e-9, atol=1e-12)
        self.assertIn("GYRO-NS-CT", wg.models())

    def test_merge_of_tables(self):
        rng = np.random.default_rng(6)
        upper, lower = self.Drawn(rng, 30.0), self.Drawn(rng, 25.0)
        merged = wg.merge([{"survey": upper, "model": "GYRO-NS-CT", "name": "gyro",
                            "to_md_m": 500.0},
                           {"survey": lower, "model": "GYRO-NS", "name": "lower",
                            "from_md_m": 400.0}],
                          {"choose": "order", "on_disagreement": "note"}, latitude_deg=60.0)
        self.assertEqual(merged.stations.md_m.iloc[-1], lower.md_m.iloc[-1])
        self.assertEqual(merged.cov.shape, (len(merged.stations), 3, 3))
        self.assertIn("first in the list", merged.files["choices.csv"])
        with self.assertRaisesRegex(wg.FileError, "choose"):
            wg.merge([{"survey": upper, "model": "GYRO-NS-CT"}], {"choose": "any"},
                     latitude_deg=60.0)


class Bench(Package):
    """A tool of two gyros and three accelerometers on a bench, axes of the bench the tool's."""

    def Tables(self):
        drawn = np.random.default_rng(4)
        earth, latitude = 15.041067178669, 61 * DEG
        rows = []
        for inc in range(0, 181, 45):
            for az in range(0, 360, 90):
                for tf in range(0, 360, 60):
                    i, a, t = np.array([inc, az, tf]) * DEG
                    rolled = np.array([[np.cos(t), np.sin(t), 0], [-np.sin(t), np.cos(t), 0],
                                       [0, 0, 1]])

                    def In(n, d):
                        return rolled @ [n * np.cos(i) * np.cos(a) - d * np.sin(i), -n * np.sin(a),
                                         n * np.sin(i) * np.cos(a) + d * np.cos(i)]
                    f = 9.8195 * -In(0, 1) + 0.01 + drawn.normal(0, 2e-4, 3)
                    w = In(earth * np.cos(latitude), -earth * np.sin(latitude))[:2]
                    rows.append([inc, az, tf, *f, *(w + 0.5 + drawn.normal(0, 0.02, 2))])
        rest = pd.DataFrame(rows, columns=["inc", "az", "tf", "fx", "fy", "fz", "m_x1", "m_y1"])
        rows = [[axis, rate, *((3600 * rate + earth * np.sin(latitude)) * np.eye(3)[k, :2] + 0.5
                               + drawn.normal(0, 0.5, 2))]
                for k, axis in enumerate("xyz") for rate in (-100, -50, 50, 100)]
        return rest, pd.DataFrame(rows, columns=["axis", "rate_deg_s", "m_x1", "m_y1"])

    def test_a_calibration_is_the_programs(self):
        rest, turned = self.Tables()
        paths = [self.Path("rest.csv"), self.Path("turned.csv")]
        for table, path in zip((rest, turned), paths):
            table.to_csv(path, index=False, float_format="%.17g")
        done = Run("calibrate", "tool", "--data", paths[0], "--data", paths[1], "--latitude-deg",
                   "61", "--gravity-mps2", "9.8195", "--bench-axes", "tool", "--level-deg", "0.3",
                   "--inclination-sigma-deg", "0.2", "--wobble-arcsec", "10",
                   "--out", self.Path("c.toml"), "--tool", self.Path("t.toml"), "--channels",
                   "0,1,2,3,4", "--asset-serial", "A-7", "--date", "2026-01-31")
        self.assertEqual(done.returncode, 0, done.stderr)
        known = dict(latitude_deg=61, gravity_mps2=9.8195, bench_axes="tool", level_deg=0.3,
                     inclination_sigma_deg=0.2, wobble_arcsec=10, tool=True, channels=[0, 1, 2, 3, 4], asset_serial="A-7", date="2026-01-31")
        made = wg.calibrate(paths, **known)
        made.write(self.Path("c2.toml"), tool=self.Path("t2.toml"))
        for name in ("c", "t"):
            with open(self.Path(name + ".toml")) as a, open(self.Path(name + "2.toml")) as b:
                self.assertEqual(a.read(), b.read())
        of_tables = wg.calibrate([rest, turned], **known)
        pd.testing.assert_frame_equal(of_tables.parameters, made.parameters)
        self.assertEqual(of_tables.tool, made.tool)
        bias = made.parameters.set_index("name").loc["gyro_b[0]"]
        self.assertLess(abs(bias.value - 0.5), 4 * bias.sigma)
        self.assertEqual(made.cov.shape, 2 * (len(made.parameters),))
        self.assertIn("wobble", made.budget.columns)  # it was stated
        squares = (made.budget.drop(columns="dof") ** 2).sum(axis=1)
        np.testing.assert_allclose(squares, np.diag(made.cov), rtol=1e-9)
        self.assertIn("north_1", set(made.bench.name))

    def test_what_is_no_bench_has_its_name(self):
        rest, _ = self.Tables()
        for arguments, wrong in (((3,), "data"), (([],), "data"), (([3],), r"data\[0\]")):
            with self.assertRaisesRegex(TypeError, wrong):
                wg.calibrate(*arguments)
        for given in (dict(latitude_deg=91), dict(gravity_g=9.8), dict(level_deg=0.0),
                      dict(inclination_sigma_deg=-1),
                      dict(bench_axes="mine"), dict(max_degree=9), dict(tool=True, date="soon"),
                      dict(gravity_g=1, gravity_mps2=9.81), dict(tool=True, channels=[1])):
            with self.assertRaises(ValueError, msg=given):
                wg.calibrate(rest, **{"latitude_deg": 61, "bench_axes": "tool", **given})
        with self.assertRaisesRegex(ValueError, "latitude"):
            wg.calibrate(rest, gravity_mps2=9.8195, bench_axes="tool")
        with self.assertRaises(wg.FileError):
            wg.calibrate(self.Path("none.csv"))
        with self.assertRaisesRegex(ValueError, "tool"):
            wg.calibrate(rest, latitude_deg=61, gravity_mps2=9.8195, bench_axes="tool").write(
                self.Path("c.toml"), tool=self.Path("t.toml"))


class Plots(Package):
    def test_every_figure_draws_what_it_is_given(self):
        import matplotlib
        matplotlib.use("Agg")
        from wellgyro import plot
        result = wg.survey(self.Path("job.toml"), self.Log(3))
        east, north = plot.plan(result, every=1).lines[0].get_data()
        np.testing.assert_array_equal(east, result.stations.east_m)
        np.testing.assert_array_equal(north, result.stations.north_m)
        along, tvd = plot.section(result).lines[0].get_data()
        closure = np.hypot(result.stations.north_m.iloc[-1], result.stations.east_m.iloc[-1])
        self.assertAlmostEqual(along[-1], closure, places=9)
        self.assertEqual(tvd[-1], result.stations.tvd_m.iloc[-1])
        self.assertEqual(plot.hole(result).name, "3d")
        self.assertEqual(len(plot.in_out(result).lines), len(result.passes.groupby("pass")))
        deviation = wg.allan(np.random.default_rng(1).normal(size=2000), 10.0, fit=False)
        self.assertEqual(len(plot.allan(deviation).lines[0].get_xdata()), len(deviation.table))


class Files(Package):
    def test_what_is_written_comes_back_to_the_last_bit(self):
        table = Comparisons.Drawn(self, np.random.default_rng(7), 30.0)
        wg.write(table, self.Path("a.csv"))
        first = wg.read(self.Path("a.csv"))
        for column in ("md_m", "inclination_deg"):
            np.testing.assert_allclose(first[column], table[column], rtol=1e-15)
        for name in ("b.las", "b.csv"):
            wg.write(first, self.Path(name))
            again = wg.read(self.Path(name))
            for column in ("md_m", "inclination_deg", "azimuth_true_deg", "tvd_m", "north_m"):
                np.testing.assert_allclose(again[column], first[column], rtol=1e-14, atol=1e-12)
        with self.assertRaisesRegex(ValueError, "datum_elevation"):
            wg.write(first, self.Path("c.dev"))
        with self.assertRaisesRegex(ValueError, "ending"):
            wg.write(first, self.Path("c.unknown"))

    def test_a_result_is_written_whole(self):
        result = wg.survey(self.Path("job.toml"), self.Log(1))
        self.assertTrue(wg.write(result, self.Path("r.las")))
        done = Run("survey", "--job", self.Path("job.toml"), "--from", self.Log(1), "--out",
                   self.Path("r"), "--formats", "las")
        self.assertEqual(done.returncode, 0, done.stderr)
        ours, theirs = wg.read(self.Path("r.las")), wg.read(self.Path("r", "survey.las"))
        self.assertEqual(list(ours.columns), list(theirs.columns))
        for column in ("md_m", "inclination_deg", "azimuth_true_deg", "var_nn_m2", "cov_ne_m2"):
            np.testing.assert_allclose(ours[column], theirs[column], rtol=1e-4, atol=1e-6)
        with open(self.Path("r.las")) as file:
            self.assertIn("verdict", file.read())
        wg.write(result.stations, self.Path("stations.csv"))
        again = wg.read(self.Path("stations.csv"))
        np.testing.assert_allclose(again.md_m, result.stations.md_m)

    def test_allan_is_the_programs(self):
        x = np.random.default_rng(8).normal(0, 1e-5, 20_000)
        made = wg.allan(x, 10.0)
        x.tofile(self.Path("x.f64"))
        done = Run("allan", "--data", self.Path("x.f64"), "--rate-hz", "10", "--type", "f64",
                   "--out", self.Path("n.toml"), "--table", self.Path("t.csv"))
        self.assertEqual(done.returncode, 0, done.stderr)
        pd.testing.assert_frame_equal(made.table, pd.read_csv(self.Path("t.csv")))
        walk = made.coefficients["angle_random_walk_deg_per_sqrt_h"]
        expected = 1e-5 / math.sqrt(10) / DEG * 60
        self.assertAlmostEqual(walk, expected, delta=0.05 * expected)


LOGS = 5
SAMPLES = 1_000_000
if __name__ == "__main__":
    if "--full" in sys.argv:
        sys.argv.remove("--full")
        LOGS, SAMPLES = 50, 10_000_000
    unittest.main()
