#!/usr/bin/env python3
"""What a plan says of the well's end against runs that follow it: simulated, surveyed, compared.

  python3 tests/bench/plan.py PROGRAM [--runs 4] [--long] [--wells slant,s,...] [--tools fine,...]
                              [--jobs 2] [--toolfaces] [--cost]

For each well and tool the stops are planned for the ellipse that three minutes every 300 m come to.
`--long`: 200 runs each. Their tools' errors are drawn from the job's own priors. `stated`: root of
the mean horizontal variance that the surveys state of the end, over that of the plan; `true`: rms of
their horizontal errors over it, with its own sigma. A survey that fails states nothing; it counts
under `failed`, and its first cause is told. `--cost`: instead, processor seconds of plans of a well
of 5 km. Seeds are fixed: the same figures each time."""
import argparse
import concurrent.futures
import csv
import itertools
import math
import os
import resource
import subprocess
import tempfile
import tomllib

# MD [m], inclination and azimuth [deg]; latitude [deg]; turns a minute.
WELLS = {
    "slant": ([(300, 5, 38), (600, 20, 40), (900, 40, 41), (1200, 58, 40), (1500, 60, 40),
               (2000, 60.5, 41), (2500, 59.5, 39.5), (3000, 60, 40)], 60.0, 1.0),
    "s": ([(300, 5, 110), (600, 18, 112), (900, 33, 113), (1100, 36, 113), (1700, 36, 112),
           (2000, 28, 111), (2300, 15, 109), (2550, 6, 107), (2900, 5.5, 106)], 60.0, 0.0),
    "horizontal": ([(300, 5, 20), (600, 15, 25), (900, 35, 36), (1200, 58, 50), (1500, 80, 62),
                    (1700, 89, 66), (2200, 90, 66), (2700, 89.5, 65.5), (3000, 90, 66)], 60.0, 0.5),
    "build": ([(200, 3, 300), (800, 12, 305), (1400, 30, 310), (2000, 45, 312), (2600, 46, 312)],
              28.0, 0.7),
    "turn": ([(300, 4, 80), (700, 20, 95), (1100, 35, 120), (1600, 38, 160), (2200, 40, 200),
              (2800, 42, 235)], -35.0, 1.2),
}

# A tool of fibre-optic grade as in the tests; one four times better, one four times worse.
NOISE = {"angle_random_walk_deg_per_sqrt_h": 0.005, "rate_random_walk_deg_per_h_sqrt_h": 0.03}
ERRORS = {"gyro_bias_sigma_deg_per_h": 0.1, "mass_unbalance_sigma_deg_per_h_per_g": 0.02,
          "quadrature_sigma_deg_per_h_per_g": 0.02, "gyro_scale_sigma": 1e-4,
          "gyro_misalignment_sigma_rad": 1e-4, "accel_bias_sigma_mps2": 5e-4,
          "accel_noise_mps2_per_sqrt_hz": 2e-4, "roll_offset_sigma_deg": 0.02,
          "time_skew_sigma_s": 1e-3}
SCALED = ("deg_per_sqrt_h", "sqrt_h", "deg_per_h", "per_g", "gyro_scale_sigma",
          "gyro_misalignment_sigma_rad")
NONE = {"depth_sigma_m": 0, "depth_scale_sigma": 0, "latitude_sigma_deg": 0, "accel_scale_sigma": 0,
        "accel_misalignment_sigma_rad": 0}
TOOLS = {"fine": 0.25, "fibre": 1.0, "coarse": 4.0}


def Scaled(values, factor):
    return {key: value * factor if key.endswith(SCALED) else value for key, value in values.items()}


def Lines(values):
    return "".join(f"{key} = {float(value)!r}\n" for key, value in values.items())


def Write(folder, name, text):
    path = os.path.join(folder, name)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    return path


def Prepare(program, folder, well, tool, more):
    """Writes well, job and plan; what the plan says of the end."""
    _, _, rpm = WELLS[well]
    path, job = WriteCase(folder, well, *WELLS[well][:2], tool)

    def Plan(ellipse, *more):
        subprocess.run([program, "plan", "--well", path, "--tool", job, "--ellipse-m",
                        f"{ellipse:.3f}", "--roll-rpm", str(rpm), "--out",
                        os.path.join(folder, "plan"), *more], check=True, capture_output=True)
        with open(os.path.join(folder, "plan", "plan.toml"), "rb") as file:
            return tomllib.load(file)

    practice = Plan(1e4, "--practice", "every_m=300,stop_s=180")["practice"]
    return Plan(practice["ellipse_major_m"], *more)


def WriteCase(folder, well, stations, latitude, tool):
    """Files of the well, the job and the tool; the first two."""
    noise, errors = Scaled(NOISE, TOOLS[tool]), Scaled(ERRORS, TOOLS[tool])
    path = Write(folder, "well.csv", "MD[m],INC[deg],AZI_TRUE[deg]\n" +
                 "".join(f"{md},{inc},{azi}\n" for md, inc, azi in stations))
    first = stations[0][0]
    job = Write(folder, "job.toml",
                f'format = "wellgyro.job/1"\n[well]\nname = "{well}"\nlatitude_deg = {latitude}\n'
                f"[tie_in]\nmd_m = {first}.0\ntvd_m = {first}.0\n"
                f"[noise]\n{Lines(noise)}[errors]\n{Lines(errors | NONE)}[stations]\nevery_m = 30\n")
    Write(folder, "tool.toml", Lines(noise | errors))
    return path, job


def Cost(program):
    """Of plans of a well that builds to 60 deg in 5 km, the practice beside them; five times each."""
    stations = [(md, min(60, 5 + 0.025 * (md - 100)), 40 + 0.002 * (md - 100))
                for md in range(100, 5101, 100)]
    for more in ([], ["--hidden-m", "16"], ["--toolfaces"], ["--hidden-m", "12"],
                 ["--hidden-m", "10"]):
        with tempfile.TemporaryDirectory() as folder:
            path, job = WriteCase(folder, "long", stations, 60.0, "fibre")
            command = [program, "plan", "--well", path, "--tool", job, "--ellipse-m", "8.56",
                       "--roll-rpm", "1", "--practice", "every_m=300,stop_s=180", "--out",
                       os.path.join(folder, "plan"), *more]
            seconds = sorted(Seconds(command) for _ in range(5))
            done = subprocess.run(command, check=True, capture_output=True, text=True)
        told = next(line for line in done.stdout.splitlines() if line.startswith("plan:"))
        print(f"{seconds[2]:.2f} s of a processor ({seconds[0]:.2f} to {seconds[-1]:.2f}) "
              f"{' '.join(more)}: {told}", flush=True)


def Seconds(command):
    """Of a processor."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def Follow(program, folder, well, seed):
    """One run as planned: horizontal variance stated, error, normalised square; or why none."""
    stations, latitude, _ = WELLS[well]
    rows = ", ".join(f"[{md:.1f}, {inc:.2f}, {azi:.2f}]" for md, inc, azi in stations)
    with open(os.path.join(folder, "tool.toml"), encoding="utf-8") as file:
        tool = file.read()
    simulation = Write(folder, f"simulation-{seed}.toml",
                       f'format = "wellgyro.simulation/1"\nseed = {seed}\n[well]\ntable = [{rows}]\n'
                       f"begin_tvd_m = {stations[0][0]}.0\n[earth]\nlatitude_deg = {latitude}\n"
                       f"[tool]\n{tool}[streams]\nimu_hz = 4.0\ndepth_hz = 2.0\n")
    log, out = os.path.join(folder, f"{seed}.lcm"), os.path.join(folder, f"out-{seed}")
    subprocess.run([program, "simulate", "--job", simulation, "--plan",
                    os.path.join(folder, "plan", "plan.toml"), "--out", log], check=True,
                   capture_output=True)
    done = subprocess.run([program, "survey", "--job", os.path.join(folder, "job.toml"), "--from",
                           log, "--out", out, "--quiet"], capture_output=True, check=False)
    with open(os.path.join(out, "survey.csv"), newline="", encoding="utf-8") as file:
        last = list(csv.DictReader(file))[-1]
    with open(log + ".truth.csv", newline="", encoding="utf-8") as file:
        truth = max(csv.DictReader(file), key=lambda row: float(row["MD[m]"]))
    os.remove(log)
    if done.returncode == 4 or not last["VAR_NN[m2]"]:
        with open(os.path.join(out, "run.toml"), "rb") as file:
            causes = tomllib.load(file)["verdict"]["causes"]
        return f"seed {seed}: {(causes or ['no position'])[0]}"
    n, e = (float(last[key]) - float(truth[key]) for key in ("N[m]", "E[m]"))
    a, b, d = (float(last[key]) for key in ("VAR_NN[m2]", "COV_NE[m2]", "VAR_EE[m2]"))
    return a + d, n * n + e * e, (d * n * n - 2 * b * n * e + a * e * e) / (a * d - b * b)


def Show(well, tool, plan, runs):
    expected, factor = plan["expected"], 2 * math.log(20)
    planned = (expected["ellipse_major_m"]**2 + expected["ellipse_minor_m"]**2) / factor
    told = [run for run in runs if not isinstance(run, str)]
    stated = math.sqrt(sum(run[0] for run in told) / len(told) / planned)
    true = math.sqrt(sum(run[1] for run in told) / len(told) / planned)
    # A sum of squares along the ellipse's two axes, of which the larger has most.
    share = expected["ellipse_major_m"]**2 / factor / planned
    spread = math.sqrt((share**2 + (1 - share)**2) / (2 * len(told)))
    square = sum(run[2] for run in told) / len(told)
    print(f"| {well}, {tool} | {expected['ellipse_major_m']:.2f} m, {len(plan['stop'])} stops, "
          f"{plan['time']['at_rest_s']:.0f} s | {len(told)} | {len(runs) - len(told)} | "
          f"{stated:.3f} | {true:.3f} +- {spread:.3f} | {square:.2f} |", flush=True)
    for run in runs:
        if isinstance(run, str):
            print(f"  {run}", flush=True)
    return stated


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--runs", type=int, default=4)
    parser.add_argument("--long", action="store_true")
    parser.add_argument("--wells", default=",".join(WELLS))
    parser.add_argument("--tools", default=",".join(TOOLS))
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--toolfaces", action="store_true", help="plans choose toolfaces too")
    parser.add_argument("--cost", action="store_true", help="processor seconds of long plans")
    options = parser.parse_args()
    program = os.path.abspath(options.program)
    if options.cost:
        return Cost(program)
    seeds = range(1, (200 if options.long else options.runs) + 1)
    print("| well, tool | planned | runs | failed | stated | true | normalised square of 2 |\n"
          "|---|---|---|---|---|---|---|", flush=True)
    ratios = []
    for well, tool in itertools.product(options.wells.split(","), options.tools.split(",")):
        with tempfile.TemporaryDirectory() as folder, \
                concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            plan = Prepare(program, folder, well, tool,
                           ["--toolfaces"] if options.toolfaces else [])
            runs = list(pool.map(lambda seed: Follow(program, folder, well, seed), seeds))
            if not all(isinstance(run, str) for run in runs):
                ratios.append(Show(well, tool, plan, runs))
    print(f"stated over planned: {min(ratios):.3f} to {max(ratios):.3f}")


if __name__ == "__main__":
    main()
