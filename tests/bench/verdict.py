#!/usr/bin/env python3
"""How often the program's verdict is right: clean runs that fail, faulty runs that are found, and
runs whose end lies beyond its 95 % region without exit code 4 (hazardously misleading).

  python3 tests/bench/verdict.py PROGRAM [--clean 100] [--faulty 5] [--sizes 0.5,1,3]
                                 [--wells slant,s,horizontal] [--causes gyro_step_x,...] [--jobs 2]
                                 [--power 40] [--pairs 4] [--first 1] [--keep FILE]

Simulates tools whose errors are drawn from the job's own priors, and gravity from those of the
Earth model, with and without one [[fault]], surveys the log and compares the deepest station with
the truth. Well `demo`: data/demo with other seeds, without faults; `vertical`, `top`, `kick`: a
hole that is, to its end, to 400 m or to 200 m. `slant@20`: rolling at 20 rpm; `!2`: at 2 m/s;
`~0.2_30`: in a hole whose angles wave by 0.2 deg in 30 m; `%0.5`: depth read to 0.5 m; `^0.1`: with
noise of 0.1 m; `+z`: a third gyro axis; in this order. `found`: no survey is made, or its verdict
is not "pass"; `fail`: of these, those with exit code 2 or 4. `named`: of those found, in how many
the right cause is the first of diagnosis.csv; `in set`: or among those that together have 95 %, or
alike the first. Of clean runs every check of chance is tabled by its share of chance, p, which is
uniform where the check's sigma is true. `--power`: so many runs of each cause in POWER with the
smallest size that reliability.csv of a clean run has, four in five of which are to be noticed.
`--pairs`: so many runs a cause and two of each draw, with the fault at once its size, whose cause
is taken out by what diagnosis.csv has of it, and without. Seeds are fixed: the same figures each
time; `--first`: the first of clean runs. `--keep`: runs, but of power, are added to a file and
taken from it, so that a long row can be run in parts. "Beyond both": beyond the 95 % ellipse and
beyond that in which the end is if one fault stays unseen, as aviation counts it.
"""
import argparse
import concurrent.futures
import csv
import functools
import itertools
import json
import math
import os
import random
import re
import subprocess
import sys
import tempfile
import threading
import tomllib

TOOL = """angle_random_walk_deg_per_sqrt_h = 0.005
bias_instability_deg_per_h = 0.02
bias_instability_correlation_time_h = 0.3
rate_random_walk_deg_per_h_sqrt_h = 0.01
gyro_bias_sigma_deg_per_h = 0.1
mass_unbalance_sigma_deg_per_h_per_g = 0.02
quadrature_sigma_deg_per_h_per_g = 0.02
gyro_scale_sigma = 1e-4
gyro_misalignment_sigma_rad = 1e-4
accel_bias_sigma_mps2 = 5e-4
accel_noise_mps2_per_sqrt_hz = 2e-4
roll_offset_sigma_deg = 0.02
time_skew_sigma_s = 1e-3
accel_scale_sigma = 5e-5
accel_misalignment_sigma_rad = 1e-4
depth_sigma_m = 0.3
depth_scale_sigma = 5.6e-4
"""
NOISE_KEYS = 4  # of them, the first
# What the estimator leaves to the Earth model at the well, and to its growth with depth: 1-sigma.
GRAVITY_MPS2, GRAVITY_GRADIENT_PER_S2 = 5e-4, 2e-7

# Inclination and azimuth laws, latitude, end [m], turns a minute.
WELLS = {
    "slant": ("start_deg = 2.0\n[[well.inclination.term]]\nbegin_md_m = 300.0\nend_md_m = 900.0\n"
              "ramp_m = 50.0\nrate_deg_per_30m = 3.1\n", "start_deg = 40.0\n", 60.0, 1800.0, 1.0),
    "s": ("start_deg = 2.0\n[[well.inclination.term]]\nbegin_md_m = 200.0\nend_md_m = 650.0\n"
          "ramp_m = 50.0\nrate_deg_per_30m = 3.0\n[[well.inclination.term]]\nbegin_md_m = 1000.0\n"
          "end_md_m = 1450.0\nramp_m = 50.0\nrate_deg_per_30m = -2.5\n",
          "start_deg = 120.0\n[[well.azimuth.term]]\nrate_deg_per_30m = 0.5\n", 60.0, 1800.0, 0.3),
    "horizontal": ("start_deg = 5.0\n[[well.inclination.term]]\nbegin_md_m = 300.0\n"
                   "end_md_m = 1200.0\nramp_m = 50.0\nrate_deg_per_30m = 3.0\n",
                   "start_deg = 66.0\n", 60.0, 1800.0, 0.5),
    # Where gravity hardly shows how a tool rolls, or not.
    "vertical": ("start_deg = 0.0\n", "start_deg = 40.0\n", 60.0, 1200.0, 0.0),
    "top": ("start_deg = 0.1\n[[well.inclination.term]]\nbegin_md_m = 400.0\nend_md_m = 900.0\n"
            "ramp_m = 50.0\nrate_deg_per_30m = 3.0\n", "start_deg = 40.0\n", 60.0, 1200.0, 1.0),
    "kick": ("start_deg = 0.0\n[[well.inclination.term]]\nbegin_md_m = 200.0\nend_md_m = 600.0\n"
             "ramp_m = 50.0\nrate_deg_per_30m = 3.4\n", "start_deg = 40.0\n", 60.0, 1200.0, 2.0),
}
OF_ALL = "slant,s,horizontal"

HALF = "begin_s = {half:.0f}\n"
MINUTE = HALF + "end_s = {half_and_minute:.0f}\n"
STOP = "begin_s = {stop:.0f}\nend_s = {stop_end:.0f}\n"
# name: (cause and axis, size key and size at 1x or None, when). Sizes: those by which a tool is
# out of its class; what has no size is made as it is.
CAUSES = {
    "gyro_step_x": ('"gyro_step"\naxis = "x"', "size_deg_per_h", 0.5, HALF),
    "gyro_step_y": ('"gyro_step"\naxis = "y"', "size_deg_per_h", 0.5, HALF),
    "gyro_ramp": ('"gyro_ramp"\naxis = "x"', "size_deg_per_h2", 0.3, ""),
    "gyro_temperature": ('"gyro_temperature"\naxis = "y"', "size_deg_per_h", 0.5,
                         "end_s = {end:.0f}\n"),
    "mass_unbalance": ('"mass_unbalance"', "size_deg_per_h_per_g", 0.15, ""),
    "quadrature": ('"quadrature"', "size_deg_per_h_per_g", 0.15, ""),
    "gyro_scale": ('"gyro_scale"\naxis = "x"', "size", 1e-3, ""),
    "gyro_misalignment": ('"gyro_misalignment"\naxis = "y"', "size_rad", 1e-3, ""),
    "accel_bias_x": ('"accel_bias"\naxis = "x"', "size_mps2", 3e-3, ""),
    "accel_bias_z": ('"accel_bias"\naxis = "z"', "size_mps2", 3e-3, ""),
    "accel_scale": ('"accel_scale"\naxis = "z"', "size", 1e-3, ""),
    "toolface_offset": ('"toolface_slip"', "size_deg", 0.2, ""),
    "toolface_slip": ('"toolface_slip"', "size_deg", 0.2, HALF),
    "time_skew": ('"time_skew"', "size_s", 0.01, ""),
    "latitude": ('"latitude"', "size_deg", 0.4, ""),
    "samples_lost": ('"samples_lost"', "size_s", 0.05, HALF),
    "gyro_spike": ('"gyro_spike"\naxis = "x"', "size_deg_per_s", 1.0, "every_s = 60.0\n"),
    "accel_spike": ('"accel_spike"\naxis = "y"', "size_mps2", 0.05, HALF),
    "gyro_noise": ('"gyro_noise"', "size", 1.5, ""),
    "accel_noise": ('"accel_noise"', "size", 1.5, ""),
    "rest_creep": ('"rest_creep"', "size_deg_per_min", 0.05, STOP),
    "rest_turn": ('"rest_turn"', "size_deg", 360.0, "begin_s = {stop:.0f}\n"),
    "swing": ('"swing"', "size_deg", 0.1, STOP + "every_s = 4.0\n"),
    "depth_step": ('"depth_step"', "size_m", 1.5, HALF),
    "depth_scale": ('"depth_scale"', "size", 3e-3, ""),
    "depth_slip": ('"depth_slip"', "size_m", 2.0, "begin_s = {slip:.0f}\nend_s = {slip_end:.0f}\n"),
    "depth_lag": ('"depth_lag"', "size_s", 0.5, ""),
    "depth_frozen": ('"depth_frozen"', None, None, MINUTE),
    "gyro_stuck": ('"gyro_stuck"\naxis = "x"', None, None, MINUTE),
    "accel_stuck": ('"accel_stuck"\naxis = "y"', None, None, MINUTE),
    "gyro_dead": ('"gyro_dead"\naxis = "y"', None, None, ""),
    "accel_dead": ('"accel_dead"\naxis = "x"', None, None, ""),
    "gyro_inverted": ('"gyro_inverted"\naxis = "x"', None, None, ""),
    "accel_inverted": ('"accel_inverted"\naxis = "y"', None, None, ""),
    "gyros_swapped": ('"gyros_swapped"', None, None, ""),
    "accels_swapped": ('"accels_swapped"', None, None, ""),
    "gyro_unit": ('"gyro_unit"', "size", 57.3, ""),
    "vibration": ('"vibration"\naxis = "x"', "size_mps2", 0.196, "every_s = 0.37\n"),
    "whirl": ('"whirl"', "size_deg", 0.1, "every_s = 0.6\n"),
    "utc_step": ('"utc_step"', "size_s", 0.3, HALF),
}


# What else diagnosis.csv may call a fault; a part of the name is enough.
CALLED = {
    "gyro_step_x": ["gyro_step_x", "gyro_bias_x"], "gyro_step_y": ["gyro_step_y", "gyro_bias_y"],
    "gyro_ramp": ["gyro_ramp_x", "gyro_step_x", "gyro_bias_x"], "gyro_temperature": ["gyro_temperature_y"],
    "gyro_scale": ["gyro_scale_x"], "gyro_misalignment": ["gyro_misalignment_y"],
    "accel_scale": ["accel_scale_z"], "rest_creep": ["rest_motion"], "rest_turn": ["rest_motion"],
    "swing": ["rest_motion"], "depth_step": ["depth_jump"], "depth_frozen": ["depth_jump"],
    "gyro_inverted": ["axes"], "accel_inverted": ["axes"], "gyros_swapped": ["axes"],
    "accels_swapped": ["axes"], "gyro_dead": ["gyro_dead"], "accel_dead": ["accel_dead"],
}


def Named(fault, causes):
    """Whether the right cause is first, and whether it is in the set, of rows of diagnosis.csv."""
    names = CALLED.get(fault, [fault])
    rows = [row for row in causes if row["CODE"] != "none"]
    if not rows:
        return False, False
    right = [any(row["CODE"].startswith(name) for name in names) for row in rows]
    alike = any(code.startswith(name) for code in rows[0]["ALIKE"].split("+") for name in names)
    every, held = sum(float(row["POSTERIOR"]) for row in rows), 0.0
    inside = alike
    for row, here in zip(rows, right):
        if every > 0 and held >= 0.95 * every:
            break
        held += float(row["POSTERIOR"])
        inside = inside or here
    return right[0], inside


@functools.cache
def Parts(well):
    """Of a well's name: hole, rpm on the way in, speed [m/s], wave (amplitude [deg], period [m]) or
    None, resolution of depth and its noise [m], whether there is a third axis."""
    number = r"(\d+(?:\.\d+)?)"
    name = re.fullmatch(rf"([a-z]+)(?:@{number})?(?:!{number})?(?:~{number}_{number})?(?:%{number})?"
                        rf"(?:\^{number})?(\+z)?", well)
    if not name or name[1] not in WELLS:
        sys.exit(f"--wells: {well!r} is not HOLE[@RPM][!SPEED][~AMPLITUDE_PERIOD][%RESOLUTION]"
                 f"[^NOISE][+z] with HOLE of {', '.join(WELLS)}")
    hole, rpm, speed, amplitude, period, resolution, noise, third = name.groups()
    return (hole, float(rpm or WELLS[hole][-1]), float(speed or 1.0),
            (float(amplitude), float(period)) if amplitude else None, float(resolution or 0.01),
            float(noise or 0), third is not None)


def Steps(well):
    """In and out with stops of two minutes every 300 m on the way in; text, and its times."""
    hole, rpm, speed, *_ = Parts(well)
    *_, end_m, _ = WELLS[hole]
    time, stops = 0.0, []
    text = "start_md_m = 0.0\n"
    depth = 0.0
    for to in [*range(0, int(end_m) + 1, 300), *([int(end_m)] if end_m % 300 else [])]:
        if to > depth:
            text += (f"[[run.step]]\nto_md_m = {to:.1f}\nspeed_mps = {speed}\nroll_rpm = {rpm}\n")
            time += (to - depth) / speed + 10
            depth = to
        text += "[[run.step]]\nstop_s = 120.0\n"
        stops.append((time, time + 120))
        time += 120
    text += f"[[run.step]]\nto_md_m = 0.0\nspeed_mps = {speed}\nroll_rpm = {-rpm}\n"
    text += "[[run.step]]\nstop_s = 120.0\n"
    time += depth / speed + 10 + 120
    middle = stops[len(stops) // 2]
    return text, {"half": 0.45 * time, "half_and_minute": 0.45 * time + 60, "end": time,
                  "stop": middle[0] + 10, "stop_end": middle[1] - 10,
                  # On the way to the first stop within the bend, some 200 m of it.
                  "slip": stops[2][0] - 250 / speed, "slip_end": stops[2][0] - 50 / speed}


def Fault(well, fault, size):
    """The simulation's [[fault]] of a cause at `size` times its size."""
    cause, key, one, when = CAUSES[fault]
    text = f"[[fault]]\ncause = {cause}\n{when.format(**Steps(well)[1])}"
    # What is a factor grows from 1.
    value = 1 + (one - 1) * size if fault in ("gyro_noise", "accel_noise") else (one or 0) * size
    return text + (f"{key} = {float(value)!r}\n" if key else "")


DEMO = os.path.join(os.path.dirname(__file__), "..", "..", "data", "demo")


def Demonstration(seed, earth):
    """Its simulation with another seed and gravity, and its job."""
    with open(os.path.join(DEMO, "simulation.toml"), encoding="utf-8") as file:
        simulation = re.sub(r"(?m)^seed = .*$", f"seed = {seed}", file.read())
    with open(os.path.join(DEMO, "job.toml"), encoding="utf-8") as file:
        job = file.read().replace('"noise.toml"', json.dumps(os.path.abspath(DEMO) + "/noise.toml"))
    return simulation.replace("[earth]\n", "[earth]\n" + earth), job


def Files(well, seed, fault):
    """Simulation and job; `fault`: its text, empty of a clean run."""
    place = random.Random(seed)
    earth = (f"gravity_anomaly_mps2 = {place.gauss(0, GRAVITY_MPS2)!r}\n"
             f"gravity_gradient_anomaly_per_s2 = {place.gauss(0, GRAVITY_GRADIENT_PER_S2)!r}\n")
    if well == "demo":
        return Demonstration(seed, earth)
    hole, _, _, wave, resolution, noise, has_gz = Parts(well)
    inclination, azimuth, latitude, end, _ = WELLS[hole]
    if wave:
        term = "[[well.{}.term]]\namplitude_deg = {}\nperiod_m = {}\n"
        inclination += term.format("inclination", *wave)
        azimuth += term.format("azimuth", *wave)
    steps, _ = Steps(well)
    third = "has_gz = true\n" if has_gz else ""
    simulation = (f'format = "wellgyro.simulation/1"\nseed = {seed}\n[well]\nname = "laws"\n'
                  f"end_md_m = {end + 5}\n[well.inclination]\n{inclination}[well.azimuth]\n"
                  f"{azimuth}[earth]\nlatitude_deg = {latitude}\n{earth}"
                  f"[run]\n{steps}[tool]\n{third}{TOOL}"
                  f"depth_resolution_m = {resolution}\ndepth_noise_m = {noise}\n"
                  f"[streams]\nimu_hz = 10.0\ndepth_hz = 2.0\n{fault}")
    lines = TOOL.splitlines()
    job = (f'format = "wellgyro.job/1"\n[well]\nname = "{well}"\nlatitude_deg = {latitude}\n'
           "[noise]\n" + "\n".join(lines[:NOISE_KEYS]) + "\n[errors]\n"
           + "\n".join(lines[NOISE_KEYS:]) + "\n[stations]\nevery_m = 30\n")
    return simulation, job


def TruthAt(path, md):
    """Position where the truth passes `md` on its way in; where it never does, as reads a tool
    whose depth is too large, straight on from its deepest second of way."""
    before = legs = None
    with open(path, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            here = [float(row[key]) for key in ("MD[m]", "N[m]", "E[m]", "TVD[m]")]
            if before and here[0] > before[0] + 0.1 and (not legs or here[0] > legs[1][0]):
                legs = before, here
                if before[0] <= md <= here[0]:
                    break
            before = here
    before, here = legs
    part = (md - before[0]) / (here[0] - before[0])
    return [a + part * (b - a) for a, b in zip(before[1:], here[1:])]


def Square(error, cov):
    """Normalised, of north and east; None where the covariance is withheld."""
    if cov is None:
        return None
    (n, e, *_), (a, b, d) = error, cov
    return (d * n * n - 2 * b * n * e + a * e * e) / (a * d - b * b)


def Compare(folder, result):
    """The end against the hole at its depth, `error`, and against where the tool was there,
    `error_of_tool` [m]; its covariance in the horizontal plane."""
    last = Rows(os.path.join(folder, "out", "survey.csv"))[-1]
    path = os.path.join(folder, "run.lcm.truth.csv")
    here = [float(last[key]) for key in ("N[m]", "E[m]", "TVD[m]")]
    deepest = max(Rows(path), key=lambda row: float(row["MD[m]"]))
    tool = [float(deepest[key]) for key in ("N[m]", "E[m]", "TVD[m]")]
    truth = TruthAt(path, float(last["MD[m]"]))
    result["error"] = [a - b for a, b in zip(here, truth)]
    result["error_of_tool"] = [a - b for a, b in zip(here, tool)]
    if last["VAR_NN[m2]"]:
        result["cov"] = [float(last[k]) for k in ("VAR_NN[m2]", "COV_NE[m2]", "VAR_EE[m2]")]


def Unseen(ellipse):
    """North-east matrix H of the summary's bound e' H^-1 e <= 1; None where it has none."""
    if not ellipse or not ellipse["semi_minor_m"]:
        return None
    major, minor = ellipse["semi_major_m"] ** 2, ellipse["semi_minor_m"] ** 2
    azimuth = math.radians(ellipse["azimuth_major_deg"])
    n, e = math.cos(azimuth), math.sin(azimuth)
    return [major * n * n + minor * e * e, (major - minor) * n * e,
            major * e * e + minor * n * n]


def Rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def One(program, well, seed, fault, size, text=None):
    """One run; `text`: its fault, in place of that of its size."""
    if text is None:
        text = Fault(well, fault, size) if fault else ""
    with tempfile.TemporaryDirectory() as folder:
        simulation, job = Files(well, seed, text)
        for name, text in (("simulation.toml", simulation), ("job.toml", job)):
            with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
                file.write(text)
        log, out = os.path.join(folder, "run.lcm"), os.path.join(folder, "out")
        subprocess.run([program, "simulate", "--job", os.path.join(folder, "simulation.toml"),
                        "--out", log], check=True, capture_output=True)
        done = subprocess.run([program, "survey", "--job", os.path.join(folder, "job.toml"),
                               "--from", log, "--out", out, "--json"], capture_output=True, text=True,
                              check=False)
        result = {"well": well, "seed": seed, "fault": fault, "size": size,
                  "code": done.returncode, "error": None, "error_of_tool": None, "cov": None,
                  "unseen": None,
                  "causes": [], "found": done.returncode == 2, "named": (False, False),
                  "checks": [], "diagnosis": [], "reliability": []}
        if done.returncode in (0, 3, 4):
            Compare(folder, result)
            result["unseen"] = Unseen(json.loads(done.stdout)["tools"][0]["unseen_faults"])
            with open(os.path.join(out, "run.toml"), "rb") as file:
                verdict = tomllib.load(file)["verdict"]
            result["causes"], result["found"] = verdict["causes"], verdict["verdict"] != "pass"
            for name in ("checks", "diagnosis", "reliability"):
                result[name] = Rows(os.path.join(out, name + ".csv"))
            result["named"] = Named(fault or "", result["diagnosis"])
        return result


BEYOND = 5.991  # chi-square of two, 95 %


def Misleads(result):
    square = Square(result["error"], result["cov"])
    return result["code"] in (0, 3) and square is not None and square > BEYOND


def MisleadsBoth(result):
    unseen = Square(result["error"], result["unseen"])
    return Misleads(result) and not (unseen is not None and unseen <= 1)


def ChiSquareTail(x, freedom):
    """By Wilson and Hilferty's cube root."""
    spread = 2 / (9 * freedom)
    return NormalTail(((x / freedom) ** (1 / 3) - 1 + spread) / math.sqrt(spread))


def NormalTail(z):
    return 0.5 * math.erfc(z / math.sqrt(2))


def ChanceOf(check):
    """Share of chance beyond a check's value; None of one that is not by chance alone."""
    if check["VERDICT"] == "not_done" or not check["VALUE"] or not check["SIGMA"]:
        return None
    source = check["LIMIT_SOURCE"]
    by_chance = "of clean runs, shared" in source or "beyond all chance" in source
    if not by_chance or " here" in source:
        return None
    value, sigma = float(check["VALUE"]), float(check["SIGMA"])
    if not sigma > 0:
        return None
    if check["CODE"].startswith("fit"):
        freedom = 2 / sigma**2
        return ChiSquareTail(value * freedom, freedom)
    return 2 * NormalTail(abs(value / sigma))


def Chances(clean):
    """Each check's p of clean runs: how many, below .05 and .01, largest distance of their
    distribution from the uniform one times its root of the number (1.36 at 5 %); warnings, fails;
    of squares the mean of value, else of (value / sigma)^2."""
    checks = {}
    for check in itertools.chain.from_iterable(r["checks"] for r in clean):
        checks.setdefault(check["CODE"], []).append(check)
    print("\ncheck                 values   mean  <.05  <.01  Kolmogorov  warn  fail")
    for code, of in sorted(checks.items()):
        warn, fail = (sum(c["VERDICT"] == v for c in of) for v in ("warn", "fail"))
        ps = sorted(p for p in map(ChanceOf, of) if p is not None)
        if not ps:
            if warn or fail:
                print(f"{code:22s} {'':5s} {'':6s} {'':5s} {'':5s} {'':11s} {warn:5d} {fail:5d}")
            continue
        far = max(max((i + 1) / len(ps) - p, p - i / len(ps)) for i, p in enumerate(ps))
        sizes = [float(c["VALUE"]) if code.startswith("fit") else
                 (float(c["VALUE"]) / float(c["SIGMA"])) ** 2
                 for c in of if ChanceOf(c) is not None]
        below = [sum(p < share for p in ps) / len(ps) for share in (.05, .01)]
        print(f"{code:22s} {len(ps):5d} {sum(sizes) / len(ps):6.2f} {below[0]:5.3f} "
              f"{below[1]:5.3f} {far * math.sqrt(len(ps)):11.2f} {warn:5d} {fail:5d}")


def Rate(part, whole):
    return f"{part} of {whole} ({100 * part / max(whole, 1):.1f} %)"


def Print(results, said):
    clean = [r for r in results if not r["fault"]]
    for well in sorted({r["well"] for r in clean}):
        of = [r for r in clean if r["well"] == well]
        known = [Square(r["error"], r["cov"]) for r in of if r["cov"]]
        tool = [Square(r["error_of_tool"], r["cov"]) for r in of if r["cov"]]
        print(f"clean {well}: fail {Rate(sum(r['code'] == 4 for r in of), len(of))}, warn "
              f"{sum(r['found'] and r['code'] != 4 for r in of)}, other codes "
              f"{sum(r['code'] not in (0, 4) for r in of)}, beyond 95 % without exit 4 "
              f"{Rate(sum(map(Misleads, of)), len(of))}, beyond both "
              f"{sum(map(MisleadsBoth, of))}, normalised square "
              f"{sum(known) / max(2 * len(known), 1):.2f}, of where the tool was "
              f"{sum(tool) / max(2 * len(tool), 1):.2f}")
    Chances(clean)
    faulty = [r for r in results if r["fault"]]
    for size in sorted({r["size"] for r in faulty}):
        print(f"\nsize {size:g} x      found   fail  named in set  misleading  crashed  worst error m"
              "  first cause")
        for fault in CAUSES:
            of = [r for r in faulty if r["fault"] == fault and r["size"] == size]
            if not of:
                continue
            causes = [r["causes"][0].split(" (")[0] for r in of if r["code"] == 4]
            first = max(set(causes), key=causes.count) if causes else ""
            found = [r for r in of if r["found"]]
            print(f"{fault:18s} {len(found):3d}/{len(of):<3d} "
                  f"{sum(r['code'] in (2, 4) for r in of):6d} "
                  f"{sum(r['named'][0] for r in found):5d} {sum(r['named'][1] for r in found):6d}  "
                  f"{sum(map(Misleads, of)):8d} {sum(r['code'] < 0 for r in of):9d} "
                  f"{max(math.hypot(*(r['error'] or [0])) for r in of):12.1f}  {first}")
        of = [r for r in faulty if r["size"] == size]
        print(f"all: found {Rate(sum(r['found'] for r in of), len(of))}, fail "
              f"{sum(r['code'] in (2, 4) for r in of)}, hazardously misleading "
              f"{Rate(sum(map(Misleads, of)), len(of))}, beyond both "
              f"{sum(map(MisleadsBoth, of))}")
    if said:
        for r in results:
            if r["causes"] or Misleads(r):
                print(r["well"], r["seed"], r["fault"], r["size"], r["code"], r["causes"])


# Faults as reliability.csv calls them; of what acts all the while.
POWER = {"gyro_step_x": "gyro_bias_x", "mass_unbalance": "mass_unbalance",
         "quadrature": "quadrature", "gyro_scale": "gyro_scale_x",
         "gyro_misalignment": "gyro_misalignment_y", "accel_bias_x": "accel_bias_x",
         "accel_bias_z": "accel_bias_z", "accel_scale": "accel_scale_z",
         "toolface_offset": "toolface_offset", "time_skew": "time_skew", "latitude": "latitude",
         "depth_scale": "depth_scale"}


def Power(program, pool, wells, causes, count):
    """Runs with the smallest fault that is said to be noticed four times in five."""
    print("\nsmallest that is noticed four times in five: runs, of which by the diagnosis; by any "
          "check")
    every = []
    for well in wells:
        reliability = {row["CODE"]: row for row in One(program, well, 1, None, 0)["reliability"]}
        for fault in causes:
            row = reliability.get(POWER[fault])
            if not row or not row["SMALLEST"]:
                print(f"{well:11s} {fault:18s} none would be")
                continue
            cause, key, *_ = CAUSES[fault]
            text = f"[[fault]]\ncause = {cause}\n{key} = {float(row['SMALLEST'])!r}\n"
            seeds = [20_000 + seed for seed in range(count)]
            runs = list(pool.map(lambda seed: One(program, well, seed, fault, 1, text), seeds))
            noticed = [any(c["CODE"] == "diagnosis" and c["VERDICT"] in ("warn", "fail")
                           for c in r["checks"]) for r in runs]
            every += noticed
            print(f"{well:11s} {fault:18s} {float(row['SMALLEST']):9.3g} {row['UNIT']:8s} "
                  f"{Rate(sum(noticed), len(runs))}; {sum(r['found'] for r in runs)}", flush=True)
    print(f"all: {Rate(sum(every), len(every))}")


# Causes with a column of their own, and what diagnosis.csv calls them.
TAKEN_OUT = {**{fault: name for fault, name in POWER.items() if fault != "gyro_step_x"},
             "gyro_step_x": "gyro_step_x", "gyro_step_y": "gyro_step_y",
             "toolface_slip": "toolface_slip"}


def TakeOut(row, faulty, clean):
    """Error of the tool's place once the cause of this row is taken out, its normalised square by
    the covariance of the run without fault and that of the cause's size, and how much larger that
    makes the variances: no estimate of an unknown size is better (Cramer and Rao)."""
    shift = [float(row[key]) for key in ("DN[m]", "DE[m]", "DV[m]")]
    error = [a - b for a, b in zip(faulty["error_of_tool"], shift)]
    spread = (float(row["SIGMA"]) / float(row["SIZE"])) ** 2
    cov = [a + spread * shift[i] * shift[j]
           for a, (i, j) in zip(clean["cov"], ((0, 0), (0, 1), (1, 1)))]
    return error, Square(error, cov), cov[0] + cov[2], clean["cov"][0] + clean["cov"][2]


def Rms(errors):
    return math.sqrt(sum(e[0]**2 + e[1]**2 for e in errors) / max(len(errors), 1))


def Pairs(one, pool, wells, causes, count):
    print("\ncause taken out, rms of the end's horizontal error [m]: clean; with the fault; taken "
          "out; over clean, and at least by the sigma of the size; normalised square, clean, taken out")
    every, squares, cleans, before = [], [], [], []
    for fault in causes:
        errors, outs, ends, wrong, held, larger, as_clean = [], [], [], [], [], 0.0, 0.0
        runs = [(well, 30_000 + seed) for well in wells for seed in range(count)]
        clean = pool.map(lambda run: one(*run, None, 0.0), runs)
        faulty = pool.map(lambda run: one(*run, fault, 1.0), runs)
        for without, with_it in zip(clean, faulty):
            row = [r for r in with_it["diagnosis"] if r["CODE"] == TAKEN_OUT[fault]]
            if not without["cov"] or not row or not row[0]["DN[m]"]:
                continue
            error, square, variance, of_clean = TakeOut(row[0], with_it, without)
            larger += variance
            as_clean += of_clean
            outs.append(error)
            held.append(square)
            ends.append(without["error_of_tool"])
            wrong.append(with_it["error_of_tool"])
            errors.append(Square(without["error_of_tool"], without["cov"]))
        if not outs:
            continue
        print(f"{fault:18s} {len(outs):3d} {Rms(ends):7.2f} {Rms(wrong):7.2f} {Rms(outs):7.2f} "
              f"{Rms(outs) / Rms(ends):7.2f} {math.sqrt(larger / as_clean):7.2f} "
              f"{sum(errors) / 2 / len(errors):7.2f} "
              f"{sum(held) / 2 / len(held):7.2f}", flush=True)
        every, squares = every + outs, squares + held
        cleans, before = cleans + ends, before + wrong
    print(f"{'all':18s} {len(every):3d} {Rms(cleans):7.2f} {Rms(before):7.2f} {Rms(every):7.2f} "
          f"{Rms(every) / max(Rms(cleans), 1e-9):7.2f} {'':7s} {'':7s} "
          f"{sum(squares) / 2 / max(len(squares), 1):7.2f}")


class Kept:
    """Results of runs by what they are of, in a file of one JSON text a line; None: nowhere."""

    def __init__(self, path):
        self.path, self.lock, self.results = path, threading.Lock(), {}
        if path and os.path.exists(path):
            with open(path, encoding="utf-8") as file:
                for result in map(json.loads, file):
                    self.results[self.Key(result)] = result

    @staticmethod
    def Key(result):
        return result["well"], result["seed"], result["fault"], result["size"]

    def One(self, program, *run):
        if run in self.results:
            return self.results[run]
        result = One(program, *run)
        with self.lock:
            self.results[run] = result
            if self.path:
                with open(self.path, "a", encoding="utf-8") as file:
                    file.write(json.dumps(result) + "\n")
        return result


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--clean", type=int, default=100, help="clean runs a well")
    parser.add_argument("--faulty", type=int, default=5, help="runs a cause, size and well")
    parser.add_argument("--sizes", default="0.5,1,3")
    parser.add_argument("--wells", default=OF_ALL)
    parser.add_argument("--causes", default=",".join(CAUSES))
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--power", type=int, default=0, help="runs a cause and well at its smallest")
    parser.add_argument("--pairs", type=int, default=0, help="runs a cause and well, and clean")
    parser.add_argument("--first", type=int, default=1, help="seed of the first clean run")
    parser.add_argument("--keep", help="file of results, made where it is not")
    parser.add_argument("--say", action="store_true", help="the causes of every run")
    given = parser.parse_args()
    runs = [(well, seed, None, 0.0) for well in given.wells.split(",")
            for seed in range(given.first, given.first + given.clean)]
    for well, fault, size in itertools.product(given.wells.split(","), given.causes.split(","),
                                               map(float, given.sizes.split(","))):
        first_size = size == float(given.sizes.split(",")[0])
        if fault and (CAUSES[fault][1] or first_size):
            runs += [(well, 10_000 + seed, fault, size) for seed in range(given.faulty)]
    program, wells = os.path.abspath(given.program), given.wells.split(",")
    kept = Kept(given.keep)
    with concurrent.futures.ThreadPoolExecutor(given.jobs) as pool:
        results = list(pool.map(lambda run: kept.One(program, *run), runs))
        Print(results, given.say)
        causes = given.causes.split(",")
        if given.power:
            Power(program, pool, wells, [cause for cause in POWER if cause in causes], given.power)
        if given.pairs:
            Pairs(functools.partial(kept.One, program), pool, wells,
                  [cause for cause in TAKEN_OUT if cause in causes], given.pairs)
    return 0


if __name__ == "__main__":
    sys.exit(main())
