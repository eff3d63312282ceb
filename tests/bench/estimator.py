#!/usr/bin/env python3
"""What a survey costs, and whether it is adjusted and true, as runs grow long or slow.

  python3 tests/bench/estimator.py PROGRAM [--passes 1,4,16] [--hours 1,4,16] [--slow 20]
                                   [--whirl 0,1,2,5]

--passes: the demonstration's way in and out, so many times in one run. --hours: a slant of 30 deg
at a metre a second, in and out between stops of three minutes a kilometre apart, 10 Hz. --slow: so
many seeds of the demonstration at half and at a quarter of its speed, 3.5 and 7 h. --whirl: an hour
at 60 deg, 100 Hz, whose tool whirls by 0.1 deg at so many Hz, 0: does not. Each line:
processor seconds of the survey (log to files), verdict, whether it was adjusted, and the worst
azimuth of the stations in survey.csv where the hole leans by more than 3 deg, in degrees and in its
sigmas."""
import argparse
import bisect
import csv
import math
import os
import re
import resource
import statistics
import subprocess
import sys
import tempfile
import tomllib

DEMO = os.path.join(os.path.dirname(__file__), "..", "..", "data", "demo")
SLANT = """[well]
name = "laws"
end_md_m = 1105.0
[well.inclination]
start_deg = 30.0
[well.azimuth]
start_deg = 40.0
[earth]
latitude_deg = 60.0
"""


def Demonstration(passes=1, slower=1, seed=None):
    with open(os.path.join(DEMO, "simulation.toml"), encoding="utf-8") as file:
        text = file.read()
    # Depths are true, so that a station's place is: what is compared are directions.
    text = re.sub(r"^depth_sigma_m = .*\n", "", text, flags=re.MULTILINE)
    begin, end = text.index("[[run.step]]"), text.index("[tool]")
    text = text[:begin] + text[begin:end] * passes + text[end:]
    if seed is not None:
        text = re.sub(r"^seed = .*$", f"seed = {seed}", text, flags=re.MULTILINE)
    return re.sub(r"speed_mps = ([0-9.]+)", lambda m: f"speed_mps = {float(m[1]) / slower!r}", text)


def DemonstrationJob():
    with open(os.path.join(DEMO, "job.toml"), encoding="utf-8") as file:
        return file.read().replace('file = "noise.toml"',
                                   f'file = "{os.path.join(DEMO, "noise.toml")}"')


def Hours(hours):
    """An hour has a way of 1 km in and one out, 2000 s, and eight stops of 200 s."""
    text = Demonstration()
    streams, tool = text[text.index("[streams]"):], text[text.index("[tool]"):text.index("[streams]")]
    steps = "start_md_m = 100.0\n"
    for _ in range(hours):
        for to in (350.0, 600.0, 850.0, 1100.0, 850.0, 600.0, 350.0, 100.0):
            steps += "[[run.step]]\nstop_s = 200.0\n"
            steps += f"[[run.step]]\nto_md_m = {to}\nspeed_mps = 1.0\nroll_rpm = 1.0\n"
    steps += "[[run.step]]\nstop_s = 200.0\n"
    simulation = f'format = "wellgyro.simulation/1"\nseed = 5\n{SLANT}[run]\n{steps}{tool}{streams}'
    job = DemonstrationJob().replace("latitude_deg = 28.0", "latitude_deg = 60.0")
    job += '[tie_in]\nmd_m = 100.0\ntvd_m = 86.6\nnorth_m = 0.0\neast_m = 0.0\n'
    return simulation, re.sub(r'\[grid\]\nutm_zone = "15N"\n', "", job)


def Whirling(hz):
    simulation, job = Hours(1)
    simulation = simulation.replace("imu_hz = 10.0", "imu_hz = 100.0")
    simulation = simulation.replace("start_deg = 30.0", "start_deg = 60.0")
    job = job.replace("tvd_m = 86.6", "tvd_m = 50.0")
    if hz > 0:
        simulation += f'[[fault]]\ncause = "whirl"\nsize_deg = 0.1\nevery_s = {1 / hz!r}\n'
    return simulation, job


def Truth(path):
    """Azimuth and inclination along the hole, on the way in."""
    rows = []
    with open(path, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            here = [float(row[key]) for key in ("MD[m]", "AZI_TRUE[deg]", "INC[deg]")]
            if not rows or here[0] > rows[-1][0]:
                rows.append(here)
    return rows


def At(rows, md):
    """Azimuth and the lesser inclination."""
    high = min(max(bisect.bisect(rows, [md]), 1), len(rows) - 1)
    a, b = rows[high - 1], rows[high]
    part = (md - a[0]) / (b[0] - a[0])
    return a[1] + part * ((b[1] - a[1] + 180) % 360 - 180), min(a[2], b[2])


def Worst(folder):
    rows = Truth(os.path.join(folder, "truth.csv"))
    off, worst, sigmas = 0.0, 0.0, []
    with open(os.path.join(folder, "out", "passes.csv"), newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            azimuth, inclination = At(rows, float(row["MD[m]"]))
            if inclination < 3 or not row["AZI_TRUE[deg]"]:
                continue
            error = abs((float(row["AZI_TRUE[deg]"]) - azimuth + 180) % 360 - 180)
            off = max(off, error)
            if not row["SIG_AZI[deg]"]:
                continue  # withheld
            sigmas.append(float(row["SIG_AZI[deg]"]))
            worst = max(worst, error / sigmas[-1])
    return off, worst, statistics.median(sigmas or [math.nan])


def Run(program, name, simulation, job):
    with tempfile.TemporaryDirectory() as folder:
        for file_name, text in (("simulation.toml", simulation), ("job.toml", job)):
            with open(os.path.join(folder, file_name), "w", encoding="utf-8") as file:
                file.write(text)
        log, out = os.path.join(folder, "run.lcm"), os.path.join(folder, "out")
        subprocess.run([program, "simulate", "--job", os.path.join(folder, "simulation.toml"), "--out",
                        log, "--truth", os.path.join(folder, "truth.csv")], check=True,
                       capture_output=True)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run([program, "survey", "--job", os.path.join(folder, "job.toml"), "--from",
                               log, "--out", out], check=False, capture_output=True, text=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        if done.returncode not in (0, 3, 4):
            print(f"{name}: exit {done.returncode}: {done.stderr.strip()[-300:]}", flush=True)
            return seconds, False, math.nan
        with open(os.path.join(out, "run.toml"), "rb") as file:
            told = tomllib.load(file)
        with open(os.path.join(out, "checks.csv"), encoding="utf-8") as file:
            checks = [row["CODE"] for row in csv.DictReader(file) if row["VERDICT"] == "fail"]
        off, worst, sigma = Worst(folder)
        adjusted = told["run"][0].get("fit", {}).get("converged", False)
        print(f"{name}: {seconds:.2f} s, {told['verdict']['verdict']}, "
              f"{'adjusted' if adjusted else 'NOT ADJUSTED'}, azimuth {off:.3f} deg, "
              f"{worst:.1f} sigma, median sigma {sigma:.3f} deg"
              + (f", fails {', '.join(checks)}" if checks else "")
              + (f": {told['verdict']['causes'][0]}" if checks else ""), flush=True)
        return seconds, adjusted, sigma


def Numbers(text):
    return [int(part) for part in text.split(",") if part]


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=os.path.abspath)
    parser.add_argument("--passes", type=Numbers, default=[1, 4, 16])
    parser.add_argument("--hours", type=Numbers, default=[1, 4, 16])
    parser.add_argument("--whirl", type=Numbers, default=[0, 1, 2, 5])
    parser.add_argument("--slow", type=int, default=20, help="seeds")
    given = parser.parse_args()
    seconds = [Run(given.program, f"demonstration x {n}", Demonstration(n), DemonstrationJob())[0]
               for n in given.passes]
    if seconds:
        print("over the first:", ", ".join(f"{s / seconds[0]:.1f}" for s in seconds))
    for hours in given.hours:
        Run(given.program, f"{hours} h", *Hours(hours))
    for hz in given.whirl:
        Run(given.program, f"whirl at {hz} Hz" if hz > 0 else "no whirl", *Whirling(hz))
    slow = {slower: [Run(given.program, f"speed / {slower}, seed {seed}",
                         Demonstration(1, slower, seed), DemonstrationJob())
                     for seed in range(1, given.slow + 1)] for slower in (2, 4)}
    for slower, results in slow.items():
        if results:
            sigmas = statistics.median(r[2] for r in results)
            print(f"speed / {slower}: {sum(r[1] for r in results)} of {len(results)} adjusted, median "
                  f"sigma {sigmas:.3f} deg")
    return 0


if __name__ == "__main__":
    sys.exit(main())
