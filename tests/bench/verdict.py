#!/usr/bin/env python3
"""How often the program's verdict is right: clean runs that fail, faulty runs that are found, and
runs whose end lies beyond its 95 % region without exit code 4 (hazardously misleading).

  python3 tests/bench/verdict.py PROGRAM [--clean 100] [--faulty 5] [--sizes 0.5,1,3]
                                 [--wells slant,s,horizontal] [--causes gyro_step_x,...] [--jobs 2]

Simulates tools whose errors are drawn from the job's own priors, with and without one [[fault]],
surveys the log and compares the deepest station with the truth. `found`: no survey is made, or its
verdict is not "pass"; `fail`: of these, those with exit code 2 or 4. `named`: of those found, in how
many the right cause is the first of diagnosis.csv; `in set`: or among those that together have
95 %, or alike the first. Seeds are fixed: the same figures each time."""
import argparse
import concurrent.futures
import csv
import itertools
import math
import os
import subprocess
import sys
import tempfile
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
depth_sigma_m = 0.3
"""
NOISE_KEYS = 4  # of them, the first

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
}

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
    "gyro_ramp": ["gyro_step_x", "gyro_bias_x"], "gyro_temperature": ["gyro_step_y", "gyro_bias_y"],
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


def Steps(end_m, rpm):
    """In and out with stops of two minutes every 300 m on the way in; text, and its times."""
    speed, time, stops = 1.0, 0.0, []
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
                  "stop": middle[0] + 10, "stop_end": middle[1] - 10}


def Files(well, seed, fault, size):
    inclination, azimuth, latitude, end, rpm = WELLS[well]
    steps, times = Steps(end, rpm)
    simulation = (f'format = "wellgyro.simulation/1"\nseed = {seed}\n[well]\nname = "laws"\n'
                  f"end_md_m = {end + 5}\n[well.inclination]\n{inclination}[well.azimuth]\n"
                  f"{azimuth}[earth]\nlatitude_deg = {latitude}\n[run]\n{steps}[tool]\n{TOOL}"
                  "depth_resolution_m = 0.01\n[streams]\nimu_hz = 10.0\ndepth_hz = 2.0\n")
    if fault:
        cause, key, one, when = CAUSES[fault]
        simulation += f"[[fault]]\ncause = {cause}\n{when.format(**times)}"
        if key:
            # What is a factor grows from 1.
            value = 1 + (one - 1) * size if fault in ("gyro_noise", "accel_noise") else one * size
            simulation += f"{key} = {float(value)!r}\n"
    lines = TOOL.splitlines()
    job = (f'format = "wellgyro.job/1"\n[well]\nname = "{well}"\nlatitude_deg = {latitude}\n'
           "[noise]\n" + "\n".join(lines[:NOISE_KEYS]) + "\n[errors]\n"
           + "\n".join(lines[NOISE_KEYS:]) + "\naccel_scale_sigma = 0\n"
           "accel_misalignment_sigma_rad = 0\ndepth_scale_sigma = 0\n[stations]\nevery_m = 30\n")
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


def Compared(folder):
    """Normalised square of the end's horizontal error (None: withheld), and its size."""
    with open(os.path.join(folder, "out", "survey.csv"), newline="", encoding="utf-8") as file:
        last = list(csv.DictReader(file))[-1]
    truth = TruthAt(os.path.join(folder, "run.lcm.truth.csv"), float(last["MD[m]"]))
    n, e = float(last["N[m]"]) - truth[0], float(last["E[m]"]) - truth[1]
    size = math.hypot(n, e, float(last["TVD[m]"]) - truth[2])
    if not last["VAR_NN[m2]"]:
        return None, size
    a, b, d = (float(last[key]) for key in ("VAR_NN[m2]", "COV_NE[m2]", "VAR_EE[m2]"))
    return (d * n * n - 2 * b * n * e + a * e * e) / (a * d - b * b), size


def One(program, well, seed, fault, size):
    with tempfile.TemporaryDirectory() as folder:
        simulation, job = Files(well, seed, fault, size)
        for name, text in (("simulation.toml", simulation), ("job.toml", job)):
            with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
                file.write(text)
        log, out = os.path.join(folder, "run.lcm"), os.path.join(folder, "out")
        subprocess.run([program, "simulate", "--job", os.path.join(folder, "simulation.toml"),
                        "--out", log], check=True, capture_output=True)
        done = subprocess.run([program, "survey", "--job", os.path.join(folder, "job.toml"),
                               "--from", log, "--out", out], capture_output=True, text=True,
                              check=False)
        result = {"well": well, "fault": fault, "size": size, "code": done.returncode,
                  "square": None, "error": None, "causes": [], "found": done.returncode == 2, "named": (False, False)}
        if done.returncode in (0, 3, 4):
            result["square"], result["error"] = Compared(folder)
            with open(os.path.join(out, "run.toml"), "rb") as file:
                verdict = tomllib.load(file)["verdict"]
            result["causes"], result["found"] = verdict["causes"], verdict["verdict"] != "pass"
            with open(os.path.join(out, "diagnosis.csv"), newline="", encoding="utf-8") as file:
                result["named"] = Named(fault or "", list(csv.DictReader(file)))
        return result


BEYOND = 5.991  # chi-square of two, 95 %


def Misleads(result):
    return result["code"] in (0, 3) and result["square"] is not None and result["square"] > BEYOND


def Rate(part, whole):
    return f"{part} of {whole} ({100 * part / max(whole, 1):.1f} %)"


def Print(results, said):
    clean = [r for r in results if not r["fault"]]
    for well in sorted({r["well"] for r in clean}):
        of = [r for r in clean if r["well"] == well]
        known = [r["square"] for r in of if r["square"] is not None]
        print(f"clean {well}: fail {Rate(sum(r['code'] == 4 for r in of), len(of))}, warn "
              f"{sum(r['found'] and r['code'] != 4 for r in of)}, other codes "
              f"{sum(r['code'] not in (0, 4) for r in of)}, beyond 95 % without exit 4 "
              f"{Rate(sum(map(Misleads, of)), len(of))}, normalised square "
              f"{sum(known) / max(2 * len(known), 1):.2f}")
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
                  f"{max((r['error'] or 0) for r in of):12.1f}  {first}")
        of = [r for r in faulty if r["size"] == size]
        print(f"all: found {Rate(sum(r['found'] for r in of), len(of))}, fail "
              f"{sum(r['code'] in (2, 4) for r in of)}, hazardously misleading "
              f"{Rate(sum(map(Misleads, of)), len(of))}")
    if said:
        for r in results:
            if r["causes"]:
                print(r["well"], r["fault"], r["size"], r["code"], r["causes"])


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--clean", type=int, default=100, help="clean runs a well")
    parser.add_argument("--faulty", type=int, default=5, help="runs a cause, size and well")
    parser.add_argument("--sizes", default="0.5,1,3")
    parser.add_argument("--wells", default=",".join(WELLS))
    parser.add_argument("--causes", default=",".join(CAUSES))
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--say", action="store_true", help="the causes of every run")
    given = parser.parse_args()
    runs = [(well, seed, None, 0.0) for well in given.wells.split(",")
            for seed in range(1, given.clean + 1)]
    for well, fault, size in itertools.product(given.wells.split(","), given.causes.split(","),
                                               map(float, given.sizes.split(","))):
        first_size = size == float(given.sizes.split(",")[0])
        if fault and (CAUSES[fault][1] or first_size):
            runs += [(well, 10_000 + seed, fault, size) for seed in range(given.faulty)]
    with concurrent.futures.ThreadPoolExecutor(given.jobs) as pool:
        program = os.path.abspath(given.program)
        results = list(pool.map(lambda run: One(program, *run), runs))
    Print(results, given.say)
    return 0


if __name__ == "__main__":
    sys.exit(main())
