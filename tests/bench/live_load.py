#!/usr/bin/env python3
"""A live survey at 10 kHz in batches of 32, in real time, stopped for a second on the way: losses,
latency of its stations, load.  live_load.py PROGRAM [--seconds 600] [--every 0.2] [--hz 10000]
[--speed 1]     stations [m], samples a second, simulated seconds a second
The goal: nothing lost, median 2 ms, p99 20 ms, 5 % of one core. What fails is a loss alone: how
fast it is depends on who else uses the machine."""
import argparse
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "..", "apps"))
from harness import PROGRAM, Job, Listening, Move, Simulation, Start

JOB = """[alignment]
method = "external"
azimuth_true_deg = 300.0
sigma_azimuth_deg = 0.1
of = "axis"
[depth]
latency_s = 1.0
"""


def Seconds(pid):
    with open(f"/proc/{pid}/stat") as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def Resident(pid):
    """Memory [MB]."""
    with open(f"/proc/{pid}/statm", encoding="utf-8") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGESIZE") / 1e6


def Main():
    options = argparse.ArgumentParser()
    options.add_argument("--seconds", type=float, default=600)
    options.add_argument("--every", type=float, default=0.2)
    options.add_argument("--hz", type=float, default=10000.0)
    options.add_argument("--speed", type=float, default=1.0)
    given = options.parse_args()
    length, real = given.seconds, given.seconds / given.speed
    folder = tempfile.mkdtemp()

    def path(name):
        return os.path.join(folder, name)

    with open(path("simulation.toml"), "w") as file:
        file.write(Simulation(Move(length), f"imu_hz = {given.hz}\ndepth_hz = 10.0\nbatch = 32\n",
                              seed=5, end_md_m=length + 10))
    with open(path("job.toml"), "w") as file:
        file.write(Job(given.every) + JOB)
    url = f"udpm://239.255.76.67:{20000 + os.getpid() % 20000}"
    survey = Start("survey", "--job", path("job.toml"), "--from", url, "--out", path("out"))
    listening, heard = Listening(survey)
    assert listening, "".join(heard)
    buffer = survey.stderr.readline().strip()
    said = []
    reader = threading.Thread(target=lambda: said.extend(survey.stderr))
    reader.start()
    time.sleep(0.2)
    sender = subprocess.Popen([PROGRAM, "simulate", "--job", path("simulation.toml"),
                               "--out", url, "--speed", str(given.speed), "--finish"],
                              stdout=subprocess.DEVNULL)
    time.sleep(real * 0.5)
    survey.send_signal(signal.SIGSTOP)
    time.sleep(1)
    survey.send_signal(signal.SIGCONT)
    time.sleep(real * 0.05)
    begin, busy, memory = time.monotonic(), Seconds(survey.pid), Resident(survey.pid)
    time.sleep(real * 0.3)
    grown = Resident(survey.pid) - memory
    load = (Seconds(survey.pid) - busy) / (time.monotonic() - begin)
    sender.wait()
    survey.wait()
    reader.join()
    with open(path("out/source.toml")) as file:
        source = file.read()
    with open(path("out/run.toml")) as file:
        run = file.read()
    lost = sum(map(int, re.findall(r"^samples_lost = (\d+)", run, re.M)))
    samples = sum(map(int, re.findall(r"^samples = (\d+)", run, re.M)))
    stations = re.search(r"^stations = (\d+)", run, re.M).group(1)

    def count(name):
        return int(re.search(rf"^{name} = (\d+)", source, re.M).group(1))

    median, p99 = count("station_latency_median_us"), count("station_latency_p99_us")
    print(f"{length:g} s at {given.hz:g} Hz, batches of 32, the process stopped for 1 s; {buffer}")
    print(f"resident memory {memory:.1f} MB, {grown:+.2f} MB in the {length * 0.3:.0f} s after that")
    print(f"samples {samples}, lost {lost}; kernel drops {count('kernel_drops')}")
    print(f"{stations} stations; latency median {median / 1000:.2f} ms, p99 {p99 / 1000:.2f} ms")
    print(f"load {100 * load:.1f} % of one core; machine's load average {os.getloadavg()[0]:.1f}")
    print("".join(said[-20:]), end="")
    shutil.rmtree(folder)
    granted = count("receive_buffer_bytes") >= 4 << 20
    good = survey.returncode == 0 and (lost == 0 or not granted)
    if median > 2000 or p99 > 20000 or load > 0.05:
        print("slower than the goal: median 2 ms, p99 20 ms, load 5 %")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(Main())
