#!/usr/bin/env python3
"""wellgyro-archive: damaged and wrong inputs as rows, killed workers, resuming, two processes. The
program is what WELLGYRO_PROGRAM names."""
import contextlib
import io
import os
import random
import shutil
import signal
import subprocess
import tempfile
import threading
import time
import unittest

import numpy as np
import pandas as pd
from distributed import Client

import wellgyro as wg
from wellgyro import _fleet, archive
from small_runs import JOB, SIMULATION, Cluster, Files

PROGRAM = os.path.abspath(os.environ["WELLGYRO_PROGRAM"])

LONG = "WELLGYRO_LONG" in os.environ
RUNS, LOGS, KILLS = (40, 8, 5) if LONG else (16, 4, 3)
DAMAGED, WRONG = (3, 11), (5, 13)


class Archive(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = folder.name
        cls.Write("job.toml", JOB.format(latitude=61.0))
        cls.Write("wrong.toml", JOB.format(latitude=1.0))
        for i in range(LOGS):
            plan = cls.Write("s.toml", SIMULATION.format(seed=i, inclination=5 + 7 * i, azimuth=40 * i,
                                                         hz=20.0))
            subprocess.run([PROGRAM, "simulate", "--job", plan, "--out", cls.Path(f"{i}.lcm")],
                           check=True, capture_output=True)
        cls.Write("bad.lcm", "no log at all" * 100)
        rows = "".join(f"run-{i:03d},{'wrong' if i in WRONG else 'job'}.toml,"
                       f"{'bad' if i in DAMAGED else i % LOGS}.lcm\n" for i in range(RUNS))
        cls.jobs = cls.Write("jobs.csv", "name,job,data\n" + rows)
        cls.runs = archive.read_jobs(cls.jobs)
        # One run after the other in this process: what every other way must give.
        cls.serial = cls.Path("serial")
        program = archive._program()
        rows = [archive.survey_run(run, cls.serial, program) for run in cls.runs]
        archive._gather(cls.serial, rows)
        # Of two workers, which are replaced where a test kills them.
        cls.cluster = cls.enterClassContext(Cluster(2))

    @classmethod
    def Path(cls, name):
        return os.path.join(cls.folder, name)

    @classmethod
    def Write(cls, name, text):
        with open(cls.Path(name), "w", encoding="utf-8") as file:
            file.write(text)
        return cls.Path(name)

    def Process(self, out):
        with Client(self.cluster) as client:
            return archive.process(self.runs, out, client)

    def test_bad_inputs_are_rows_with_their_reasons(self):
        runs = pd.read_csv(os.path.join(self.serial, "runs.csv"), keep_default_na=False)
        self.assertEqual(len(runs), RUNS)
        named = {f"run-{i:03d}" for i in DAMAGED + WRONG}
        self.assertEqual(set(runs.name[runs.verdict.isin(["error", "fail"])]), named)
        errors = runs[runs.verdict == "error"]
        self.assertEqual(set(errors.name), {f"run-{i:03d}" for i in DAMAGED})
        for text in errors.error:
            self.assertIn("bad.lcm", text)
        for text in runs.causes[runs.verdict == "fail"]:
            self.assertTrue("earth_rate" in text or "latitude" in text, text)
        stations = pd.read_parquet(os.path.join(self.serial, "stations.parquet"))
        self.assertEqual(stations.name.nunique(), RUNS - len(DAMAGED))

    def test_killed_workers_leave_the_same_bytes(self):
        out = self.Path("killed")
        rng, over = random.Random(22), threading.Event()
        killed = []
        with Client(self.cluster) as client:
            def Kill():
                while not over.is_set() and len(killed) < KILLS:
                    time.sleep(rng.uniform(0.2, 0.8))
                    pids = list(client.run(os.getpid).values()) if not over.is_set() else []
                    if pids and not over.is_set():
                        with contextlib.suppress(ProcessLookupError):
                            os.kill(rng.choice(pids), signal.SIGKILL)
                            killed.append(time.monotonic())
            thread = threading.Thread(target=Kill)
            thread.start()
            archive.process(self.runs, out, client)
            over.set()
            thread.join()
        self.assertGreater(len(killed), 0)
        again = self.Process(out)
        self.assertEqual(len(again), RUNS)
        whole = {n: b for n, b in Files(out).items() if ".part" not in n}
        self.assertEqual(whole, Files(self.serial))

    def test_workers_that_die_while_they_start_are_replaced(self):
        with Client(self.cluster) as client:
            # Killed, and again as soon as there is another process: Dask gives such workers up.
            for pid in client.run(os.getpid).values():
                os.kill(pid, signal.SIGKILL)
            deadline, struck = time.monotonic() + 60, 0
            while struck < 2 and time.monotonic() < deadline:
                for nanny in list(self.cluster.workers.values()):
                    if pid := nanny.pid:
                        with contextlib.suppress(ProcessLookupError):
                            os.kill(pid, signal.SIGKILL)
                            struck += 1
                time.sleep(0.02)
            self.assertGreaterEqual(struck, 2)
            rows = archive.process(self.runs[:6], self.Path("starting"), client)
        self.assertEqual(len(rows), 6)
        self.assertEqual([r["name"] for r in rows if r["verdict"] == "error"], ["run-003"])

    def test_a_second_call_does_nothing_and_a_changed_input_its_runs(self):
        out = self.Path("again")
        shutil.copytree(self.serial, out)
        before = {n: os.stat(os.path.join(out, n)).st_mtime_ns for n in Files(out) if "/" in n}
        rows = self.Process(out)
        self.assertEqual(sum(r["done_again"] for r in rows), 0)
        after = {n: os.stat(os.path.join(out, n)).st_mtime_ns for n in Files(out) if "/" in n}
        self.assertEqual(before, after)
        os.remove(os.path.join(out, "run-002", "done.json"))
        rows = self.Process(out)
        self.assertEqual([r["name"] for r in rows if r["done_again"]], ["run-002"])
        self.assertEqual(Files(out), Files(self.serial))

    def test_the_command_and_its_report(self):
        out = self.Path("command")
        said, told = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(told):
            code = archive.main([self.jobs, "--out", out, "--workers", "1"])
        self.assertEqual(code, 3)
        self.assertIn(f"{RUNS} runs, {RUNS} done now", said.getvalue())
        self.assertIn("run-003: FileError", told.getvalue())
        with contextlib.redirect_stdout(said):
            self.assertEqual(archive.main(["report", out]), 0)
        with open(os.path.join(out, "report.html"), encoding="utf-8") as file:
            page = file.read()
        for text in ("run-003", "run-005", "gravity", f"Archive of {RUNS} runs", "Causes",
                     "Tool errors against their priors over time", "gyro_bias_x",
                     "not judged: fewer than three tools"):
            self.assertIn(text, page)
        self.assertNotIn("src=", page)
        runs = pd.read_csv(os.path.join(out, "runs.csv"), keep_default_na=False)
        self.assertEqual(set(runs.well[runs.verdict != "error"]), {"Slant"})

    def test_a_tool_that_stands_apart_is_named(self):
        random_ = np.random.default_rng(22)
        errors = pd.DataFrame([(f"tool {t}", code, random_.normal() + 4 * (t == 3 and code == "b"))
                               for t in range(8) for code in "abc" for _ in range(12)],
                              columns=["tool", "code", "ratio"])
        found = _fleet.out_of_family(errors)
        self.assertEqual(list(zip(found.tool, found.code)), [("tool 3", "b")])
        self.assertEqual(len(_fleet.out_of_family(errors[errors.tool < "tool 2"])), 0)

    def test_an_empirical_model_of_runs_of_each_well(self):
        """300 runs of 60 wells as folders of an archive: a misalignment of 0.2 deg, one a run, and
        noise of 0.1 deg in both directions."""
        out, random_ = self.Path("fleet"), np.random.default_rng(5)
        md, rows = np.arange(0.0, 1000.0, 50.0), []
        for well in range(60):
            azimuth = random_.uniform(0, 360)
            for run in range(5):
                name = f"w{well}-{run}"
                inclination = 20 + md / 20
                across = np.sin(np.radians(inclination))
                frame = pd.DataFrame({
                    "md_m": md,
                    "inclination_deg": inclination + random_.normal(0, 0.2) * across
                    + random_.normal(0, 0.1, len(md)),
                    "azimuth_true_deg": (azimuth + md / 30 + random_.normal(0, 0.1, len(md))
                                         / across) % 360})
                os.makedirs(os.path.join(out, name))
                frame.to_parquet(os.path.join(out, name, "stations.parquet"))
                rows.append((name, f"well {well}", 60.0, "pass"))
        rows.append(("gone", "well 0", 60.0, "fail"))
        pd.DataFrame(rows, columns=["name", "well", "latitude_deg", "verdict"]).to_csv(
            os.path.join(out, "runs.csv"), index=False)
        assumed = self.Write("assumed.toml", """format = "wellgyro.error-model/1"
name = "small"
revision = "1"
source = "test"
inclination_max_deg = 100
vertical_limit_deg = 1e-4
surface_tie_on = "doubled"
[[term]]
name = "XYM1"
weight = "XYM1"
magnitude = 0.1
unit = "deg"
propagation = "systematic"
[[term]]
name = "DSTG"
weight = "DST"
magnitude = 2.5e-07
unit = "1/m"
propagation = "global"
""")
        made = self.Path("made.toml")
        with contextlib.redirect_stdout(io.StringIO()) as said:
            code = archive.main(["model", out, "--assumed", assumed, "--out", made])
        self.assertEqual(code, 0)
        self.assertIn("1 of 2 terms estimated from 300 runs in 60 wells", said.getvalue())
        table = pd.read_csv(self.Path("estimates.csv")).set_index("TERM")
        self.assertAlmostEqual(table.MAGNITUDE["XYM1"], 0.2, delta=0.03)
        self.assertLess(table.LOWER95["XYM1"], table.MAGNITUDE["XYM1"])
        self.assertGreater(table.UPPER95["XYM1"], table.MAGNITUDE["XYM1"])
        self.assertAlmostEqual(table.MAGNITUDE["LOCAL"], 0.1, delta=0.005)
        self.assertEqual(table.MAGNITUDE["DSTG"], 2.5e-07)
        # The model is one that `uncertainty` takes: the angle of one term goes into its positions.
        survey = pd.DataFrame({"md_m": [0.0, 500.0, 1000.0], "inclination_deg": [30.0] * 3,
                               "azimuth_true_deg": [0.0] * 3})
        before, after = (wg.uncertainty(survey, m, latitude_deg=60, terms=True).terms["XYM1"]
                         for m in (assumed, made))
        ratio = (table.MAGNITUDE["XYM1"] / 0.1) ** 2
        self.assertAlmostEqual(after[2, 0, 0] / before[2, 0, 0], ratio, delta=1e-6 * ratio)
        with contextlib.redirect_stderr(io.StringIO()) as told:
            self.assertEqual(archive.main(["model", self.serial + "/none", "--assumed", assumed,
                                           "--out", made]), 2)
        self.assertIn("runs.csv", told.getvalue())

    def test_a_list_that_cannot_be_is_refused_by_its_line(self):
        for text, says in (("name,job,data\na,j.toml,\n", ":2: data is missing"),
                           ("name,job,data\n../a,j,d\n", "no name of a folder"),
                           ("name,job,data\na,j,d\na,j,d\n", ":3: a stands twice"),
                           ("name,job,data\n", "no run"), ("x\n1\n", "name is missing")):
            path = self.Write("bad.csv", text)
            with self.assertRaisesRegex(ValueError, says):
                archive.read_jobs(path)
        with contextlib.redirect_stderr(io.StringIO()) as told:
            self.assertEqual(archive.main([self.Path("none.csv"), "--out", "x"]), 2)
        self.assertIn("none.csv", told.getvalue())


if __name__ == "__main__":
    unittest.main()
