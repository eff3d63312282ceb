#!/usr/bin/env python3
"""Runs the program on live buses: the same bytes as from the log, signals, kill -9, damage.
live_test.py PROGRAM [--kills N]     in a network of its own where the machine allows it"""
import filecmp
import heapq
import os
import random
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest

PROGRAM = os.path.abspath(sys.argv.pop(1))
KILLS = 2
if "--kills" in sys.argv:
    at = sys.argv.index("--kills")
    KILLS = int(sys.argv[at + 1])
    del sys.argv[at:at + 2]

SIMULATION = """format = "wellgyro.simulation/1"
seed = 5
[well]
name = "slant"
inclination_deg = 25.0
azimuth_true_deg = 300.0
end_md_m = 300.0
[earth]
latitude_deg = 61.0
[run]
[[run.step]]
stop_s = 90.0
[[run.step]]
to_md_m = 200.0
speed_mps = 1.0
roll_rpm = 1.0
[[run.step]]
stop_s = 90.0
[tool]
angle_random_walk_deg_per_sqrt_h = 0.005
utc_jitter_s = 0.001
[streams]
imu_hz = 100.0
depth_hz = 4.0
batch = 32
"""
JOB = """format = "wellgyro.job/1"
[well]
name = "Slant"
latitude_deg = 61.0
longitude_deg = 3.0
[noise]
angle_random_walk_deg_per_sqrt_h = 0.005
[stations]
every_m = 10.0
[depth]
latency_s = 2.0
"""
RESULT = ("survey.csv", "passes.csv", "checks.csv", "run.toml")


class Broker(threading.Thread):
    """Gives every tcpq client what any client publishes."""

    def __init__(self):
        super().__init__(daemon=True)
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.url = f"tcpq://127.0.0.1:{self.listener.getsockname()[1]}"
        self.clients, self.lock = [], threading.Lock()

    def run(self):
        while True:
            client, _ = self.listener.accept()
            client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            client.sendall(struct.pack(">II", 0x287617fa, 0x0100))
            with self.lock:
                self.clients.append(client)
            threading.Thread(target=self.Serve, args=(client,), daemon=True).start()

    def Serve(self, client):
        file = client.makefile("rb")
        try:
            file.read(8)
            while head := file.read(8):
                kind, size = struct.unpack(">II", head)
                message = head + file.read(size)
                if kind != 1:
                    continue
                length = file.read(4)
                message += length + file.read(struct.unpack(">I", length)[0])
                with self.lock:
                    for other in list(self.clients):
                        try:
                            other.sendall(message)
                        except OSError:
                            self.clients.remove(other)
        except (OSError, struct.error):
            pass
        with self.lock:
            if client in self.clients:
                self.clients.remove(client)


class Relay(threading.Thread):
    """Carries multicast from one port to another as a bad network does: some is lost, all is
    delayed, and some therefore overtaken."""

    def __init__(self, port_from, port_to, loss, jitter):
        super().__init__(daemon=True)
        self.to, self.loss, self.jitter = ("239.255.76.67", port_to), loss, jitter
        self.chance, self.lost = random.Random(4), 0
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)
        self.socket.bind(("239.255.76.67", port_from))
        member = struct.pack("4s4s", socket.inet_aton("239.255.76.67"), socket.inet_aton("0.0.0.0"))
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, member)
        self.out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.out.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)

    def run(self):
        held = []
        while True:
            now = time.monotonic()
            while held and held[0][0] <= now:
                self.out.sendto(heapq.heappop(held)[2], self.to)
            self.socket.settimeout(max(held[0][0] - now, 1e-4) if held else None)
            try:
                data = self.socket.recv(65536)
            except TimeoutError:
                continue
            if self.chance.random() < self.loss:
                self.lost += 1
                continue
            due = time.monotonic() + self.chance.uniform(0, self.jitter)
            heapq.heappush(held, (due, self.chance.random(), data))


def HasMulticast():
    try:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.connect(("239.255.76.67", 7667))
        return True
    except OSError:
        return False


class Live(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        cls.simulation = cls.Write("simulation.toml", SIMULATION)
        cls.job = cls.Write("job.toml", JOB)
        cls.port = 20000 + os.getpid() % 20000
        cls.broker = Broker()
        cls.broker.start()
        log = cls.Path("straight.lcm")
        made = cls.Run("simulate", "--job", cls.simulation, "--out", log, "--finish")
        assert made.returncode == 0, made.stderr
        done = cls.Run("survey", "--job", cls.job, "--from", log, "--out", cls.Path("straight"))
        assert done.returncode == 0, done.stderr

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    @classmethod
    def Path(cls, name):
        return os.path.join(cls.folder, name)

    @classmethod
    def Write(cls, name, content):
        with open(cls.Path(name), "w") as file:
            file.write(content)
        return cls.Path(name)

    @staticmethod
    def Run(*arguments, **options):
        return subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, check=False,
                              timeout=120, **options)

    def Start(self, *arguments):
        process = subprocess.Popen([PROGRAM, *arguments], stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        self.addCleanup(self.Reap, process)
        return process

    @staticmethod
    def Reap(process):
        if process.poll() is None:
            process.kill()
        process.communicate()

    def Listening(self, *arguments):
        """A program that has said that it listens."""
        process = self.Start(*arguments)
        process.heard = []
        while line := process.stderr.readline():
            process.heard.append(line)
            if line.startswith("listening"):
                time.sleep(0.1)
                return process
        self.fail("".join(process.heard))
        return None

    def Udpm(self):
        if not HasMulticast():
            self.skipTest("no multicast route here")
        type(self).port += 1
        return f"udpm://239.255.76.67:{self.port}"

    def SameAs(self, straight, out):
        for name in RESULT:
            self.assertTrue(filecmp.cmp(os.path.join(self.Path(straight), name),
                                        os.path.join(self.Path(out), name), shallow=False), name)

    def LiveOver(self, url, out):
        record = self.Path(out + ".lcm")
        recorder = self.Listening("record", "--from", url, "--out", record)
        survey = self.Listening("survey", "--job", self.job, "--from", url, "--out", self.Path(out),
                                "--record", self.Path(out + ".heard.lcm"))
        sent = self.Run("simulate", "--job", self.simulation, "--out", url, "--speed", "0",
                        "--finish")
        self.assertEqual(sent.returncode, 0, sent.stderr)
        text, errors = survey.communicate(timeout=60)
        self.assertEqual(survey.returncode, 0, text + errors)
        recorder.send_signal(signal.SIGTERM)
        text, errors = recorder.communicate(timeout=20)
        self.assertEqual(recorder.returncode, 0, text + errors)
        self.SameAs("straight", out)
        for log in (record, self.Path(out + ".heard.lcm")):
            again = self.Run("survey", "--job", self.job, "--from", log, "--out",
                             self.Path(out + ".again"))
            self.assertEqual(again.returncode, 0, again.stderr)
            self.SameAs("straight", out + ".again")

    def test_udpm_gives_the_bytes_of_the_log(self):
        self.LiveOver(self.Udpm(), "udpm")

    def test_tcpq_gives_the_bytes_of_the_log(self):
        self.LiveOver(self.broker.url, "tcpq")

    def Interrupted(self, number):
        url = self.Udpm()
        out = self.Path(f"signal{number}")
        survey = self.Listening("survey", "--job", self.job, "--from", url, "--out", out)
        sender = self.Start("simulate", "--job", self.simulation, "--out", url, "--speed", "60")
        self.WaitFor(os.path.join(out, "run.toml"))
        begin = time.monotonic()
        survey.send_signal(number)
        survey.wait(timeout=10)
        seconds = time.monotonic() - begin
        sender.kill()
        text = survey.stderr.read()
        self.assertEqual(survey.returncode, 0, text)
        self.assertIn("not adjusted", text)
        self.assertEqual(self.Run("check", os.path.join(out, "survey.csv")).returncode, 0)
        with open(os.path.join(out, "source.toml")) as file:
            self.assertIn("interrupted", file.read())
        with open(os.path.join(out, "passes.csv")) as file:
            self.assertIn("provisional", file.read())
        print(f"signal {number}: {1000 * seconds:.0f} ms to the end")
        # 100 ms on a machine of its own; this one may be shared.
        self.assertLess(seconds, 1.0)

    def test_sigint_leaves_whole_files(self):
        self.Interrupted(signal.SIGINT)

    def test_sigterm_leaves_whole_files(self):
        self.Interrupted(signal.SIGTERM)

    def WaitFor(self, path, seconds=30):
        end = time.monotonic() + seconds
        while not os.path.exists(path):
            self.assertLess(time.monotonic(), end, path)
            time.sleep(0.02)

    def test_killed_at_any_instant_it_ends_with_the_same_bytes(self):
        chance = random.Random(7)
        for kill in range(KILLS):
            with self.subTest(kill=kill):
                self.KilledOnce(f"kill{kill}", chance.uniform(0, 4.0))

    def KilledOnce(self, out, delay):
        url = self.Udpm()
        full, heard = self.Path(out + ".lcm"), self.Path(out + ".heard.lcm")
        recorder = self.Listening("record", "--from", url, "--out", full)
        command = ["survey", "--job", self.job, "--from", url, "--out", self.Path(out), "--record",
                   heard]
        survey = self.Listening(*command)
        sender = self.Start("simulate", "--job", self.simulation, "--out", url, "--speed", "100",
                            "--finish")
        time.sleep(delay)
        survey.kill()
        survey.communicate()
        if survey.returncode == -signal.SIGKILL:
            survey = self.Start(*command, "--resume", "--fill", full)
            sender.communicate(timeout=60)
            text, errors = survey.communicate(timeout=60)
            self.assertEqual(survey.returncode, 0, text + errors)
        recorder.kill()
        self.SameAs("straight", out)
        shutil.rmtree(self.Path(out))
        os.remove(full)
        os.remove(heard)

    def test_resume_refuses_another_job(self):
        url = self.Udpm()
        out = self.Path("refused")
        heard = self.Path("refused.lcm")
        survey = self.Listening("survey", "--job", self.job, "--from", url, "--out", out,
                                "--record", heard)
        survey.kill()
        survey.communicate()
        other = self.Write("other.toml", JOB.replace("61.0", "60.0"))
        done = self.Run("survey", "--job", other, "--from", url, "--out", out, "--record", heard,
                        "--resume")
        self.assertEqual(done.returncode, 2)
        self.assertIn("another job", done.stderr)

    def test_what_is_missing_is_said(self):
        done = self.Run("survey", "--job", self.job, "--from", "tcpq://127.0.0.1:9", "--out",
                        self.Path("none"))
        self.assertEqual(done.returncode, 2)
        self.assertIn("no broker answers", done.stderr)
        done = self.Run("survey", "--job", self.job, "--from", self.Path("straight.lcm"), "--out",
                        self.Path("none"), "--resume")
        self.assertEqual(done.returncode, 1)

    def test_two_senders_are_named(self):
        url = self.Udpm()
        survey = self.Listening("survey", "--job", self.job, "--from", url, "--out",
                                self.Path("two"))
        first = self.Start("simulate", "--job", self.simulation, "--out", url, "--speed", "30")
        other = self.Write("second.toml", SIMULATION + "session = 77\n")
        second = self.Start("simulate", "--job", other, "--out", url, "--speed", "30")
        time.sleep(2)
        for process in (first, second):
            process.terminate()
        survey.send_signal(signal.SIGINT)
        self.assertIn("two senders", survey.communicate(timeout=20)[1])

    def test_a_folder_that_goes_away_is_waited_for(self):
        url = self.Udpm()
        parent = self.Path("mount")
        out = os.path.join(parent, "out")
        survey = self.Listening("survey", "--job", self.job, "--from", url, "--out", out)
        sender = self.Start("simulate", "--job", self.simulation, "--out", url, "--speed", "40",
                            "--finish")
        self.WaitFor(os.path.join(out, "run.toml"))
        shutil.rmtree(parent)
        with open(parent, "w") as file:
            file.write("in the way")
        time.sleep(1.5)
        os.remove(parent)
        text, errors = survey.communicate(timeout=60)
        sender.communicate(timeout=60)
        self.assertEqual(survey.returncode, 0, text + errors)
        self.assertIn("cannot", errors)
        self.assertIn("up to date again", errors)
        for name in RESULT:
            self.assertTrue(filecmp.cmp(os.path.join(self.Path("straight"), name),
                                        os.path.join(out, name), shallow=False), name)

    def test_a_bad_network_is_borne_and_a_recorder_beside_the_sender_has_it_all(self):
        near, far = self.Udpm(), self.Udpm()
        relay = Relay(self.port - 1, self.port, loss=0.02, jitter=0.03)
        relay.start()
        full = self.Path("near.lcm")
        recorder = self.Listening("record", "--from", near, "--out", full)
        survey = self.Listening("survey", "--job", self.job, "--from", far, "--out",
                                self.Path("far"))
        sent = self.Run("simulate", "--job", self.simulation, "--out", near, "--speed", "40",
                        "--finish")
        self.assertEqual(sent.returncode, 0, sent.stderr)
        text, errors = survey.communicate(timeout=60)
        self.assertGreater(relay.lost, 0)
        self.assertEqual(survey.returncode, 3, text + errors)
        self.assertIn("did not come", errors)
        with open(self.Path("far/run.toml")) as file:
            lost = int(re.search(r"samples_lost = (\d+)", file.read()).group(1))
        self.assertGreater(lost, 0)
        self.assertLessEqual(lost, 32 * relay.lost)
        with open(self.Path("far/passes.csv")) as file:
            self.assertIn("gap", file.read())
        recorder.send_signal(signal.SIGINT)
        recorder.communicate(timeout=20)
        again = self.Run("survey", "--job", self.job, "--from", full, "--out", self.Path("near"))
        self.assertEqual(again.returncode, 0, again.stderr)
        self.SameAs("straight", "near")

    def test_overlapping_batches_bear_every_single_loss(self):
        near, far = self.Udpm(), self.Udpm()
        relay = Relay(self.port - 1, self.port, loss=0.005, jitter=0.005)
        relay.start()
        overlapping = self.Write("overlap.toml", SIMULATION + "overlap = 32\n")
        survey = self.Listening("survey", "--job", self.job, "--from", far, "--out",
                                self.Path("overlap"))
        sent = self.Run("simulate", "--job", overlapping, "--out", near, "--speed", "30",
                        "--finish")
        self.assertEqual(sent.returncode, 0, sent.stderr)
        text, errors = survey.communicate(timeout=60)
        self.assertGreater(relay.lost, 0)
        with open(self.Path("overlap/run.toml")) as file:
            self.assertIn("samples_lost = 0", file.read(), text + errors)

    def test_netem(self):
        if not os.environ.get("WELLGYRO_OWN_NETWORK"):
            self.skipTest("no network namespaces here")
        made = subprocess.run("tc qdisc add dev lo root netem loss 2% delay 10ms 8ms", shell=True,
                              check=False, capture_output=True, text=True)
        if made.returncode != 0:
            self.skipTest("the kernel has no netem: " + made.stderr.strip())
        self.addCleanup(subprocess.run, "tc qdisc del dev lo root", shell=True, check=False)
        url = self.Udpm()
        survey = self.Listening("survey", "--job", self.job, "--from", url, "--out",
                                self.Path("netem"))
        sent = self.Run("simulate", "--job", self.simulation, "--out", url, "--speed", "40",
                        "--finish")
        self.assertEqual(sent.returncode, 0, sent.stderr)
        text, errors = survey.communicate(timeout=60)
        self.assertIn(survey.returncode, (0, 3), text + errors)

    def test_a_recorder_rotates_and_says_what_did_not_come(self):
        url = self.Udpm()
        lossy = self.Write("lossy.toml", SIMULATION + "loss_probability = 0.05\n")
        recorder = self.Listening("record", "--from", url, "--out", self.Path("rot.lcm"),
                                  "--rotate-mb", "0.5")
        sent = self.Run("simulate", "--job", lossy, "--out", url, "--speed", "0")
        self.assertEqual(sent.returncode, 0, sent.stderr)
        time.sleep(0.3)
        recorder.send_signal(signal.SIGINT)
        text, errors = recorder.communicate(timeout=20)
        self.assertEqual(recorder.returncode, 3, text + errors)
        self.assertIn("did not come", errors)
        self.assertIn("rot.001.lcm", text)
        for name in ("rot.lcm", "rot.001.lcm"):
            self.assertEqual(self.Run("check", self.Path(name)).returncode, 0)


def InOwnNetwork():
    """Starts over in a network namespace, so that tests disturb nobody; as we are where not."""
    if os.environ.get("WELLGYRO_OWN_NETWORK"):
        return
    script = ("ip link set lo up && ip route add 224.0.0.0/4 dev lo && "
              "sysctl -qw net.core.rmem_max=4194304 2>/dev/null; exec \"$@\"")
    try:
        probe = subprocess.run(["unshare", "-rn", "sh", "-c", script, "sh", "true"], check=False,
                               capture_output=True)
    except FileNotFoundError:
        return
    if probe.returncode != 0:
        print("no network namespaces here: the tests use this machine's network")
        return
    os.environ["WELLGYRO_OWN_NETWORK"] = "1"
    os.execvp("unshare", ["unshare", "-rn", "sh", "-c", script, "sh", sys.executable, __file__,
                          PROGRAM, "--kills", str(KILLS), *sys.argv[1:]])


if __name__ == "__main__":
    InOwnNetwork()
    unittest.main()
