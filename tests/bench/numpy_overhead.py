#!/usr/bin/env python3
"""What a survey costs more from numpy than in the program, with the package of PYTHONPATH:

  python3 tests/bench/numpy_overhead.py PROGRAM [--times 7] [--batch 100]

The demonstration, in turn: by the program from its log (a process, start and files included), by
wellgyro.survey from the same log, and pushed from arrays, `batch` samples a call. Processor seconds,
user and system, of each; the package's are those of the calls and of the listings' text, not of the
interpreter's start. Ends with 1 where the median ratio of log or arrays to the program exceeds 1.05,
or where the listings differ."""
import argparse
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np
import pandas as pd

import wellgyro as wg

DEMO = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "data", "demo")
LISTINGS = ("survey.csv", "passes.csv", "checks.csv", "diagnosis.csv", "reliability.csv",
            "stretches.csv")


def OfProgram(program, out):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([program, "survey", "--job", f"{DEMO}/job.toml", "--from", f"{DEMO}/run.lcm",
                    "--out", out], check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def Timed(work):
    begin = time.process_time()
    listings = work()
    return time.process_time() - begin, listings


def Listings(result):
    return {name: result.csv(name) for name in LISTINGS}


class Arrays:
    """The log as arrays, by the program's own conversion."""

    def __init__(self, program, folder):
        path = os.path.join(folder, "run.csv")
        subprocess.run([program, "convert", f"{DEMO}/run.lcm", path], check=True,
                       capture_output=True)
        samples = pd.read_csv(path)
        depths = pd.read_csv(os.path.join(folder, "run.depth.csv"))
        self.tool = self.Ns(samples, "TOOL")
        self.utc = self.Ns(samples, "UTC")
        self.gyro = self.Columns(samples, "GX[rad/s]", "GY[rad/s]")
        self.accel = self.Columns(samples, "AX[m/s2]", "AY[m/s2]", "AZ[m/s2]")
        self.depth_utc = self.Ns(depths, "UTC")
        self.md = depths["MD[m]"].to_numpy(float)
        self.stopped = depths["STOPPED"].to_numpy(bool)

    @staticmethod
    def Ns(frame, name):
        column = next(c for c in frame if c.startswith(name + "["))
        unit = {"s": 10**9, "us": 1000, "ns": 1}[column[len(name) + 1:-1]]
        values = frame[column].to_numpy()
        return np.round(values * unit).astype(np.int64) if values.dtype.kind == "f" else \
            values.astype(np.int64) * unit

    @staticmethod
    def Columns(frame, *names):
        return np.ascontiguousarray(frame[list(names)].to_numpy(float))

    def Push(self, batch):
        survey = wg.Survey(f"{DEMO}/job.toml")
        survey.push_depth(self.depth_utc, self.md, stopped=self.stopped)
        for a in range(0, len(self.tool), batch):
            b = a + batch
            survey.push_imu(self.tool[a:b], self.gyro[a:b], self.accel[a:b], utc_ns=self.utc[a:b],
                            run=1)
        return Listings(survey.finish())


def Main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--times", type=int, default=7)
    parser.add_argument("--batch", type=int, default=100)
    options = parser.parse_args()
    program = os.path.abspath(options.program)
    log_ratios, array_ratios, different = [], [], set()
    with tempfile.TemporaryDirectory() as folder:
        arrays = Arrays(program, folder)
        for turn in range(options.times):
            out = os.path.join(folder, f"out-{turn}")
            whole = OfProgram(program, out)
            log, listings = Timed(lambda: Listings(wg.survey(f"{DEMO}/job.toml", f"{DEMO}/run.lcm")))
            pushed, _ = Timed(lambda: arrays.Push(options.batch))
            for name, text in listings.items():
                with open(os.path.join(out, name), encoding="utf-8", newline="") as file:
                    if file.read() != text:
                        different.add(name)
            log_ratios.append(log / whole)
            array_ratios.append(pushed / whole)
            print(f"program {whole:.2f} s, log {log:.2f} s, arrays {pushed:.2f} s", flush=True)
    of_log, of_arrays = statistics.median(log_ratios), statistics.median(array_ratios)
    print(f"{len(arrays.tool)} samples, {options.batch} a call; over the program, median of "
          f"{options.times}: log {of_log:.3f}, arrays {of_arrays:.3f}; listings that differ "
          f"{sorted(different)}; load {os.getloadavg()[0]:.1f}")
    return 0 if max(of_log, of_arrays) <= 1.05 and not different else 1


if __name__ == "__main__":
    sys.exit(Main())
