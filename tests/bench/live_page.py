#!/usr/bin/env python3
"""The live page over a long run: what readers cost a survey, how soon a browser shows a station, what
memory both take.  live_page.py PROGRAM [--minutes 20] [--speed 1] [--pages 100] [--every-m 10]
Two surveys hear one simulation, one of them with a page that a browser shows and others read: the
difference is the page's. The goal: the same bytes, less than 3 % of a core, a station within a
second, memory that grows with the stations alone. What fails is a byte or a station."""
import argparse
import os
import struct
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "..", "apps"))
import browser
from harness import PROGRAM, RESULT, Job, Listening, Move, Simulation, Start, Stop
from live_load import Resident, Seconds
from live_test import Ear, InOwnNetwork
from page_test import LINK, Readers, Timed

SEEN = """window.seen = new Map();
new MutationObserver(list => list.forEach(m => m.addedNodes.forEach(
    r => seen.set(r.dataset.key, Date.now()))))
  .observe(document.getElementById('stations'), {childList: true});"""


def Run(seconds):
    """Steps of a run of about so long: down and up again by turns, with stops at the ends."""
    steps, to = Stop(90), 200
    for _ in range(max(2, round((seconds - 90) / 260))):
        steps += Move(to) + Stop(60)
        to = 0 if to else 200
    return steps


class Bench:
    def __init__(self, options, folder):
        self.options, self.folder = options, folder
        self.port, self.web = 20000 + os.getpid() % 20000, 8000 + os.getpid() % 10000
        self.url = f"udpm://239.255.76.67:{self.port}"

    def Path(self, name):
        return os.path.join(self.folder, name)

    def Survey(self, name, *more):
        survey = Start("survey", "--job", self.Path("job.toml"), "--from", self.url, "--out",
                       self.Path(name), "--quiet", *more)
        threading.Thread(target=survey.stderr.read, daemon=True).start()
        return survey

    def Memory(self, page, shown, alone):
        page.Do("HeapProfiler.collectGarbage")
        heap = page.Do("Runtime.getHeapUsage")["usedSize"] / 1e6
        nodes = page.Do("Memory.getDOMCounters")["nodes"]
        rows = page.Ask("document.querySelectorAll('#stations tr').length")
        print(f"{rows} stations: page {heap:.2f} MB of heap, {nodes} nodes; survey "
              f"{Resident(shown.pid):.1f} MB resident, {Resident(alone.pid):.1f} without a page",
              flush=True)

    def Go(self):
        o = self.options
        length = 60 * o.minutes * o.speed
        with open(self.Path("simulation.toml"), "w", encoding="utf-8") as file:
            file.write(Simulation(Run(length), "imu_hz = 100.0\ndepth_hz = 4.0\nbatch = 32\n",
                                  seed=5, tool="accel_noise_mps2_per_sqrt_hz = 2e-4\n"))
        with open(self.Path("job.toml"), "w", encoding="utf-8") as file:
            file.write(Job(o.every_m).replace("accel_noise_mps2_per_sqrt_hz = 0",
                                              "accel_noise_mps2_per_sqrt_hz = 2e-4")
                       + "[depth]\nlatency_s = 2.0\n")
        ear = Ear(self.port)
        ear.heard = Timed()
        shown = self.Survey("shown", "--page", f"127.0.0.1:{self.web}")
        time.sleep(2)  # so that their sessions are told apart
        alone = self.Survey("alone")
        time.sleep(2)
        ear.heard.clear()
        readers = Readers(self.web, o.pages)
        self.chromium = browser.Browser()
        page = browser.Page(self.chromium, online=True)
        page.Open(f"http://127.0.0.1:{self.web}/")
        page.Ask(SEEN)
        begin, used = time.monotonic(), (Seconds(shown.pid), Seconds(alone.pid))
        simulation = subprocess.Popen([PROGRAM, "simulate", "--job", self.Path("simulation.toml"),
                                       "--out", self.url, "--speed", str(o.speed), "--finish"],
                                      stdout=subprocess.DEVNULL)
        while simulation.poll() is None and time.monotonic() - begin < 60 * o.minutes:
            self.Memory(page, shown, alone)
            try:
                simulation.wait(60 * o.minutes / 8)
            except subprocess.TimeoutExpired:
                pass
        took = time.monotonic() - begin
        load = [(Seconds(p.pid) - u) / took for p, u in zip((shown, alone), used, strict=True)]
        self.Memory(page, shown, alone)
        simulation.wait()
        page.Until(f"{LINK}.startsWith('The survey has ended')", 300)
        return self.Tell(page, ear, readers, (shown, alone), load)

    @staticmethod
    def Waits(page, ear):
        """From a station's first message, of the survey that began first, to its row [s]."""
        sent = [(*struct.unpack_from(">qqi", payload, 8), when)
                for channel, payload, when in list(ear.heard) if channel == "WELLGYRO_STATION"]
        session = min(message[2] for message in sent)
        first = {}
        for utime_us, _, of, when in sent:
            if of == session:
                first.setdefault(utime_us, when)
        for key, at in page.Ask("Array.from(seen)"):
            yield at / 1000 - first[int(key.split("/")[-1]) // 1000]

    def Tell(self, page, ear, readers, surveys, load):
        codes = [survey.wait() for survey in surveys]
        readers.join(10)
        rows = page.Ask("document.querySelectorAll('#stations tr').length")
        waits = sorted(self.Waits(page, ear))
        same = all(open(self.Path(f"shown/{name}"), "rb").read() ==
                   open(self.Path(f"alone/{name}"), "rb").read() for name in RESULT)
        with open(self.Path("shown/passes.csv"), encoding="utf-8") as file:
            wanted = len(file.readlines()) - 1
        print(f"{len(readers.times)} readings of one of {self.options.pages} readers")
        print(f"stations in the page {rows} of {wanted}; after their message "
              f"{waits[len(waits) // 2]:.2f} s, at most {waits[-1]:.2f} s")
        print(f"load with page {100 * load[0]:.2f} %, without {100 * load[1]:.2f} % of a core; "
              f"machine's load average {os.getloadavg()[0]:.1f}")
        print("result files the same" if same else "RESULT FILES DIFFER", codes)
        return 0 if same and rows == wanted else 1


def Main():
    parser = argparse.ArgumentParser()
    for name, default in (("minutes", 20), ("speed", 1), ("pages", 100), ("every-m", 10)):
        parser.add_argument("--" + name, type=float if name != "pages" else int, default=default)
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(parser.parse_args(), folder)
        try:
            return bench.Go()
        finally:
            bench.chromium.Close()


if __name__ == "__main__":
    InOwnNetwork(__file__)
    sys.exit(Main())
