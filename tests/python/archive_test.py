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

import dask
import pandas as pd
from distributed import Client, LocalCluster

from wellgyro import archive
from package_test import JOB, PROGRAM, SIMULATION

RUNS, LOGS, KILLS = 40, 8, 5
DAMAGED, WRONG = (3, 17), (5, 23)


dask.config.set({"distributed.scheduler.allowed-failures": 50})


def Cluster(workers):
    return LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None,
                        host="127.0.0.1", silence_logs=50)


def Files(out):
    """Every file of the archive with its bytes, but for files half written."""
    found = {}
    for where, _, names in os.walk(out):
        for name in names:
            path = os.path.join(where, name)
            with open(path, "rb") as file:
                found[os.path.relpath(path, out)] = file.read()
    return found


class Archive(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = folder.name
        cls.Write("job.toml", JOB)
        cls.Write("wrong.toml", JOB.replace("61.0", "1.0"))
        for i in range(LOGS):
            plan = cls.Write("s.toml", SIMULATION.format(seed=i, inclination=5 + 7 * i, azimuth=40 * i))
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

    @classmethod
    def Path(cls, name):
        return os.path.join(cls.folder, name)

    @classmethod
    def Write(cls, name, text):
        with open(cls.Path(name), "w", encoding="utf-8") as file:
            file.write(text)
        return cls.Path(name)

    def Process(self, out, workers=2):
        with Cluster(workers) as cluster, Client(cluster) as client:
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
        with Cluster(2) as cluster, Client(cluster) as client:
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
        for text in ("run-003", "run-005", "gravity", f"Archive of {RUNS} runs"):
            self.assertIn(text, page)

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
