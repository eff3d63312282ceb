#!/usr/bin/env python3
"""wellgyro-archive on many runs, with the package of PYTHONPATH and the program given:

    tests/bench/archive.py PROGRAM kills      500 runs, 5 logs damaged, 5 latitudes wrong, workers
                                              killed at 50 random instants; then a second call
    tests/bench/archive.py PROGRAM speed      one and two processes
    tests/bench/archive.py PROGRAM overhead   runs that end at once: time and memory of the scheduler

Prints what was measured and ends with 1 where something is not as it should be."""
import argparse
import contextlib
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import threading
import time

from distributed import Client

from wellgyro import archive

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "..", "python"))
from small_runs import JOB, SIMULATION, Cluster, Files  # noqa: E402

LOGS = 20


def Write(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def Fleet(program, folder, count, bad, hz=50.0):
    """Runs of LOGS logs in turn; the first `bad` odd ones damaged, the first even ones wrong."""
    Write(f"{folder}/job.toml", JOB.format(latitude=61.0))
    Write(f"{folder}/wrong.toml", JOB.format(latitude=1.0))
    Write(f"{folder}/s.toml", "")
    for i in range(LOGS):
        Write(f"{folder}/s.toml", SIMULATION.format(seed=i, inclination=5 + 3 * i, azimuth=17 * i,
                                                   hz=hz))
        subprocess.run([program, "simulate", "--job", f"{folder}/s.toml", "--out",
                        f"{folder}/{i}.lcm"], check=True, capture_output=True)
    damaged = {f"run-{2 * i * 37 % count:05d}" for i in range(1, bad + 1)}
    wrong = {f"run-{(2 * i * 37 + 1) % count:05d}" for i in range(1, bad + 1)}
    # Events without their sync words.
    with open(f"{folder}/0.lcm", "rb") as file:
        head = file.read(40)
    with open(f"{folder}/bad.lcm", "wb") as file:
        file.write(head[4:] * 200)
    rows = ["name,job,data"]
    for i in range(count):
        name = f"run-{i:05d}"
        rows.append(f"{name},{'wrong' if name in wrong else 'job'}.toml,"
                    f"{'bad' if name in damaged else i % LOGS}.lcm")
    Write(f"{folder}/jobs.csv", "\n".join(rows) + "\n")
    return archive.read_jobs(f"{folder}/jobs.csv"), damaged, wrong


def Serial(runs, out):
    """One run after the other in this process: what every other way must give."""
    program = archive._program()
    archive._gather(out, [archive.survey_run(run, out, program) for run in runs])


class Killer:
    """Kills a worker at random instants, `kills` times or until it is stopped."""

    def __init__(self, client, kills, longest, seed=22):
        self.client, self.kills, self.longest = client, kills, longest
        self.random, self.over, self.killed = random.Random(seed), threading.Event(), 0
        self.thread = threading.Thread(target=self.Run)

    def Run(self):
        while self.killed < self.kills and not self.over.wait(self.random.uniform(0, self.longest)):
            with contextlib.suppress(Exception):  # the cluster may be closing, the worker gone
                workers = list(self.client.scheduler_info(n_workers=-1)["workers"])
                worker = self.random.choice(workers)
                os.kill(self.client.run(os.getpid, workers=[worker])[worker], signal.SIGKILL)
                self.killed += 1

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.over.set()
        self.thread.join()


def Kills(program, options):
    with tempfile.TemporaryDirectory() as folder:
        runs, damaged, wrong = Fleet(program, folder, options.runs, 5, hz=100.0)
        begin = time.monotonic()
        Serial(runs, f"{folder}/serial")
        print(f"{len(runs)} runs in series: {time.monotonic() - begin:.0f} s", flush=True)
        begin = time.monotonic()
        with Cluster(2) as cluster, Client(cluster) as client:
            with Killer(client, options.kills, options.longest) as killer:
                rows = archive.process(runs, f"{folder}/killed", client)
        print(f"with {killer.killed} workers killed: {time.monotonic() - begin:.0f} s")
        files, serial = Files(f"{folder}/killed"), Files(f"{folder}/serial")
        different = sorted(n for n in files.keys() | serial.keys() if files.get(n) != serial.get(n))
        errors = {r["name"] for r in rows if r["verdict"] == "error"}
        fails = {r["name"] for r in rows if r["verdict"] == "fail"}
        print(f"{len(rows)} rows, {len(serial)} files, different or left over: {len(different)} "
              f"{different[:5]}; errors {len(errors)}, fails {len(fails)}, "
              f"as planted {errors == damaged and fails == wrong}")
        before = {n: os.stat(f"{folder}/killed/{n}").st_mtime_ns for n in files if "/" in n}
        with Cluster(2) as cluster, Client(cluster) as client:
            again = sum(r["done_again"] for r in
                        archive.process(runs, f"{folder}/killed", client))
        after = {n: os.stat(f"{folder}/killed/{n}").st_mtime_ns for n in files if "/" in n}
        same = before == after and Files(f"{folder}/killed") == files
        print(f"second call: {again} done again, nothing touched {same}")
    return (killer.killed == options.kills and len(rows) == options.runs and not different
            and errors == damaged and fails == wrong and again == 0 and same)


def Speed(program, options):
    with tempfile.TemporaryDirectory() as folder:
        runs, _, _ = Fleet(program, folder, options.runs, 0)
        wall, most = {}, {}
        for workers in (1, 2):
            with Cluster(workers) as cluster, Client(cluster) as client:
                client.run(lambda: __import__("wellgyro.archive"))
                before = client.run(time.process_time)
                begin = time.monotonic()
                archive.process(runs, f"{folder}/{workers}", client)
                wall[workers] = time.monotonic() - begin
                spent = client.run(time.process_time)
                most[workers] = max(spent[w] - before[w] for w in spent)
                print(f"{workers}: {wall[workers]:.1f} s by the clock; seconds of a processor of "
                      f"each {[round(spent[w] - before[w], 1) for w in spent]}; load "
                      f"{os.getloadavg()[0]:.1f}", flush=True)
        print(f"{len(runs)} runs: {wall[1] / wall[2]:.2f} times by the clock, "
              f"{most[1] / most[2]:.2f} by the busiest worker's seconds of a processor")
    return most[1] / most[2] >= 1.8


def Memory():
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * resource.getpagesize() / 1e6


def Overhead(program, options):
    with tempfile.TemporaryDirectory() as folder:
        Write(f"{folder}/job.toml", JOB.format(latitude=61.0))
        Write(f"{folder}/bad.lcm", "no log at all")
        runs = [archive.Run(f"run-{i:07d}", f"{folder}/job.toml", (f"{folder}/bad.lcm",))
                for i in range(options.runs)]
        begin = time.monotonic(), time.process_time()
        few = runs[:: max(1, len(runs) // 300)]
        digest = archive._program()
        for run in few:
            archive.survey_run(run, f"{folder}/alone", digest)
        alone = [(b - a) / len(few) for a, b in zip(begin, (time.monotonic(), time.process_time()))]
        memory = []

        def Progress(done, total):
            if 10 * done >= total * (len(memory) + 1):
                memory.append(round(Memory()))

        with Cluster(1) as cluster, Client(cluster) as client:
            client.run(lambda: __import__("wellgyro.archive"))
            begin = time.monotonic(), time.process_time()
            archive.process(runs, f"{folder}/out", client, progress=Progress)
            wall, cpu = (b - a for a, b in zip(begin, (time.monotonic(), time.process_time())))
    each = 1e3 / len(runs)
    print(f"{len(runs)} runs: {wall * each:.2f} ms each by the clock, of that the run itself "
          f"{alone[0] * 1e3:.2f}; scheduler and client {cpu * each:.2f} ms of a processor each; "
          f"memory by tenths {memory} MB; load {os.getloadavg()[0]:.1f}")
    return wall * each - alone[0] * 1e3 <= 10


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("what", choices=("kills", "speed", "overhead"))
    parser.add_argument("--runs", type=int)
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--longest", type=float, default=3.0, help="between two kills [s]")
    options = parser.parse_args()
    options.runs = options.runs or {"kills": 500, "speed": 100, "overhead": 10000}[options.what]
    program = os.path.abspath(options.program)
    good = {"kills": Kills, "speed": Speed, "overhead": Overhead}[options.what](program, options)
    print("as it should be" if good else "NOT as it should be")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
