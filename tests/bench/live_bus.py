#!/usr/bin/env python3
"""What a live survey says on the bus beside what it writes.  live_bus.py PROGRAM [--age SECONDS]
Of the demonstration and three more wells, every number of a station's last revision against its row
in passes.csv; with --age, in real time, how old a station is when its message comes, with a latency_s
of 1 and of 5, beside what that and a second and a half allow. Ends with 3 when anything differs or
is too old.
"""
import argparse
import csv
import math
import os
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "..", "apps"))
import harness
import live_test
from harness import DEMO, TOP, Job, Move, Run, Simulation, Start, Stop

STATION = struct.Struct(">Qqqiiiiiiii4d6d3d6d")
PASSES = ("stationary", "in", "out", "repeat")
KINDS = ("tie_in", "gyrocompass", "continuous", "still")
DEGREES = 180 / math.pi
ALLOWED_S = 1.5

WELL = """format = "wellgyro.simulation/1"
seed = 11
[well]
stations = "{file}"
[earth]
latitude_deg = 61.0
[run]
[[run.step]]
stop_s = 90.0
[[run.step]]
to_md_m = 600.0
speed_mps = 1.0
roll_rpm = 1.0
[[run.step]]
stop_s = 90.0
[[run.step]]
to_md_m = 300.0
speed_mps = 1.0
roll_rpm = 1.0
[tool]
angle_random_walk_deg_per_sqrt_h = 0.005
[streams]
imu_hz = 20.0
depth_hz = 4.0
batch = 20
"""


def Wells(folder):
    """Name, simulation and job of each."""
    yield "demonstration", os.path.join(DEMO, "simulation.toml"), os.path.join(DEMO, "job.toml")
    job = os.path.join(folder, "job.toml")
    with open(job, "w", encoding="utf-8") as file:
        file.write(Job(10.0) + "[depth]\nlatency_s = 2.0\n")
    for name in ("near-vertical", "s-shape", "horizontal-turn"):
        simulation, stations = (os.path.join(folder, name + end) for end in (".toml", ".csv"))
        with open(os.path.join(TOP, "data", "wells", name + ".csv"), encoding="utf-8") as file:
            rows = [row.split(",")[:3] for row in file.read().splitlines()
                    if row and row[0] in "0123456789"]
        with open(stations, "w", encoding="utf-8") as file:
            file.write("MD[m],INC[deg],AZI_TRUE[deg]\n" + "".join(",".join(r) + "\n" for r in rows))
        with open(simulation, "w", encoding="utf-8") as file:
            file.write(WELL.format(file=stations))
        yield name, simulation, job


def Told(payload):
    """The columns of passes.csv that a message has, as numbers."""
    (_, utime, _, _, run, run_pass, _, revision, _, kind, _, md, inc, azi, gtf, *rest) = \
        STATION.unpack_from(payload)
    angles, position, ned = rest[:6], rest[6:9], rest[9:15]
    return (run, utime, kind), {
        "RUN": run, "PASS": PASSES[run_pass], "REVISION": revision, "KIND": KINDS[kind], "MD[m]": md,
        "INC[deg]": inc * DEGREES, "AZI_TRUE[deg]": azi * DEGREES % 360,
        "GTF[deg]": gtf * DEGREES % 360, "N[m]": position[0], "E[m]": position[1],
        "TVD[m]": position[2], "VAR_NN[m2]": ned[0], "COV_NE[m2]": ned[1], "COV_NV[m2]": ned[2],
        "VAR_EE[m2]": ned[3], "COV_EV[m2]": ned[4], "VAR_VV[m2]": ned[5],
        "SIG_AZI[deg]": math.sqrt(max(angles[5], 0)) * DEGREES}


def Same(text, value):
    """Whether a column's text is the number, to half of its last digit."""
    if text == "":
        return True  # a survey that fails writes none
    digits = text.lower().split("e")
    places = len(digits[0].split(".")[1]) if "." in digits[0] else 0
    half = 0.5 * 10.0 ** (int(digits[1] if len(digits) > 1 else 0) - places)
    return abs(float(text) - value) <= half * (1 + 1e-6) + 1e-15


def Live(job, simulation, out, port, speed):
    url = f"udpm://239.255.76.67:{port}"
    survey = Start("survey", "--job", job, "--from", url, "--out", out)
    listening, heard = harness.Listening(survey)
    assert listening, "".join(heard)
    ear = live_test.Ear(port)
    sent = Run("simulate", "--job", simulation, "--out", url, "--speed", speed, "--finish",
               timeout=3000)
    assert sent.returncode == 0, sent.stderr
    text, errors = survey.communicate(timeout=600)
    time.sleep(0.5)
    ear.ending = True
    assert survey.returncode in (0, 4), f"exit {survey.returncode}\n{text}{errors}"
    return ear


def Compare(name, ear, out):
    told = {}
    for payload in ear.On("WELLGYRO_STATION"):
        key, columns = Told(payload)
        told[key] = columns
    by_place = {(c["RUN"], c["PASS"], c["KIND"], f"{c['MD[m]']:.4f}"): c for c in told.values()}
    rows = numbers = differ = missing = 0
    with open(os.path.join(out, "passes.csv"), newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if row["KIND"] == "tie_in":
                continue
            rows += 1
            place = int(row["RUN"]), row["PASS"], row["KIND"], f"{float(row['MD[m]']):.4f}"
            station = by_place.get(place)
            if station is None:
                missing += 1
                continue
            for column, value in station.items():
                if column in ("KIND", "PASS"):
                    continue
                numbers += 1
                if not Same(row[column], value):
                    differ += 1
                    if differ < 5:
                        print(f"  {name} MD {row['MD[m]']} {column}: {row[column]}, told {value}")
    print(f"{name}: {len(told)} stations told, {rows} in passes.csv, {missing} of them not told; "
          f"{numbers} numbers, {differ} differ", flush=True)
    return differ + missing + (rows == 0)


def Age(seconds, latency, folder, port):
    """Of stations on the way in, from the time that they are of to their message."""
    simulation, job = os.path.join(folder, "age.toml"), os.path.join(folder, "age.job.toml")
    with open(simulation, "w", encoding="utf-8") as file:
        file.write(Simulation(Stop(70) + Move(seconds), "imu_hz = 100.0\ndepth_hz = 4.0\n"
                              "batch = 10\n", end_md_m=seconds + 10))
    with open(job, "w", encoding="utf-8") as file:
        file.write(Job(5.0) + f"[depth]\nlatency_s = {latency}\n")
    url = f"udpm://239.255.76.67:{port}"
    out = os.path.join(folder, f"age-{latency:g}")
    survey = Start("survey", "--job", job, "--from", url, "--out", out)
    assert harness.Listening(survey)[0]
    heard = live_test.Join(port)
    sender = Start("simulate", "--job", simulation, "--out", url, "--speed", "1")
    begin, newest, ages = None, 0, []
    end = time.monotonic() + seconds + 72
    heard.settimeout(0.2)
    while time.monotonic() < end:
        try:
            data = heard.recv(65536)
        except TimeoutError:
            continue
        now = time.monotonic()
        channel, payload = data[8:].split(b"\0", 1)
        if channel == b"WELLGYRO_IMU":
            first, period, count = struct.unpack_from(">q28xi8xi", payload, 8)
            newest = first + (count * period) // 1000
            # The clock of the samples, by their messages: the least delay is none.
            begin = min(begin, now - newest * 1e-6) if begin is not None else now - newest * 1e-6
        elif channel == b"WELLGYRO_STATION":
            (_, utime, kind), columns = Told(payload)
            if columns["REVISION"] == 0 and kind == 2:
                ages.append(now - begin - utime * 1e-6)
    survey.send_signal(signal.SIGINT)
    survey.communicate()
    sender.kill()
    sender.communicate()
    ages.sort()
    most = ages[-1] if ages else math.inf
    print(f"{len(ages)} stations in real time, latency_s = {latency}: their age at their message "
          f"is {ages[len(ages) // 2]:.2f} s by the median, {most:.2f} s at most; "
          f"{latency + ALLOWED_S} s are allowed")
    return most > latency + ALLOWED_S


def Main():
    live_test.InOwnNetwork(os.path.abspath(__file__))
    options = argparse.ArgumentParser()
    options.add_argument("--age", type=float, default=0)
    options.add_argument("--speed", default="200")
    options = options.parse_args()
    folder = tempfile.mkdtemp()
    port, failed = 20000 + os.getpid() % 20000, 0
    try:
        if options.age > 0:
            for latency in (1.0, 5.0):
                port += 1
                failed += Age(options.age, latency, folder, port)
        else:
            for name, simulation, job in Wells(folder):
                port += 1
                out = os.path.join(folder, name)
                failed += Compare(name, Live(job, simulation, out, port, options.speed), out)
    finally:
        shutil.rmtree(folder)
    return 3 if failed else 0


if __name__ == "__main__":
    sys.exit(Main())
