#!/usr/bin/env python3
"""live_run.py PROGRAM LIVE: an installed consumer's live program, killed and begun again, makes the
bytes that the program makes of its log."""
import filecmp
import os
import signal
import subprocess
import sys
import tempfile
import time

PROGRAM, LIVE = (os.path.abspath(name) for name in sys.argv[1:3])
NETWORK = "ip link set lo up && ip route add 224.0.0.0/4 dev lo; exec \"$@\""
SIMULATION = """format = "wellgyro.simulation/1"
seed = 5
[well]
name = "slant"
inclination_deg = 25.0
azimuth_true_deg = 300.0
end_md_m = 200.0
[earth]
latitude_deg = 61.0
[run]
[[run.step]]
stop_s = 90.0
[[run.step]]
to_md_m = 100.0
speed_mps = 1.0
[[run.step]]
stop_s = 90.0
[tool]
angle_random_walk_deg_per_sqrt_h = 0.005
[streams]
imu_hz = 50.0
depth_hz = 4.0
batch = 32
"""
JOB = """format = "wellgyro.job/1"
[well]
name = "Slant"
latitude_deg = 61.0
[noise]
angle_random_walk_deg_per_sqrt_h = 0.005
[stations]
every_m = 10.0
"""


def Main(folder):
    def Path(name):
        return os.path.join(folder, name)

    for name, text in (("simulation.toml", SIMULATION), ("job.toml", JOB)):
        with open(Path(name), "w", encoding="utf-8") as file:
            file.write(text)
    url = f"udpm://239.255.76.67:{20000 + os.getpid() % 20000}"
    live = [LIVE, Path("job.toml"), url, Path("out"), Path("heard.lcm")]
    first = subprocess.Popen(live)
    time.sleep(1)
    sender = subprocess.Popen([PROGRAM, "simulate", "--job", Path("simulation.toml"), "--out", url,
                               "--speed", "60", "--finish"], stdout=subprocess.DEVNULL)
    time.sleep(2.5)
    first.send_signal(signal.SIGKILL)
    first.wait()
    second = subprocess.run(live, timeout=60, check=False)
    sender.wait(timeout=60)
    assert second.returncode == 0, second.returncode
    subprocess.run([PROGRAM, "survey", "--job", Path("job.toml"), "--from", Path("heard.lcm"),
                    "--out", Path("again")], check=False, stdout=subprocess.DEVNULL,
                   stderr=subprocess.DEVNULL)
    for name in ("survey.csv", "passes.csv", "checks.csv"):
        assert filecmp.cmp(Path("out/" + name), Path("again/" + name), shallow=False), name
    print("a vendor's live program, killed and resumed: the bytes of its log")


if os.environ.get("WELLGYRO_OWN_NETWORK") or subprocess.run(
        ["unshare", "-rn", "sh", "-c", NETWORK, "sh", "true"], check=False,
        capture_output=True).returncode != 0:
    with tempfile.TemporaryDirectory() as scratch:
        Main(scratch)
else:
    os.environ["WELLGYRO_OWN_NETWORK"] = "1"
    os.execvp("unshare", ["unshare", "-rn", "sh", "-c", NETWORK, "sh", sys.executable, __file__,
                          PROGRAM, LIVE])
