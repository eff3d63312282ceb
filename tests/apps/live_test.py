#!/usr/bin/env python3
"""Runs the program on live buses: the same bytes as from the log, signals, kill -9, damage.
live_test.py PROGRAM [--kills N]     in a network of its own where the machine allows it"""
import concurrent.futures
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
import threading
import time
import unittest

import harness
from harness import PROGRAM, Job, Limit, Move, ProgramTest, Run, Simulation, Stop

KILLS = 10
if "--kills" in sys.argv:
    at = sys.argv.index("--kills")
    KILLS = int(sys.argv[at + 1])
    del sys.argv[at:at + 2]

SIMULATION = Simulation(Stop(90) + Move(200) + Stop(90),
                        "imu_hz = 100.0\ndepth_hz = 4.0\nbatch = 32\n", seed=5,
                        tool="utc_jitter_s = 0.001\n")
JOB = Job(10.0) + "[depth]\nlatency_s = 2.0\n"
BEGIN_US = 1_767_225_600_000_000  # of the simulation's time
FINGERPRINTS = {"request_t": 0x5c9579a393f3035d, "advice_t": 0xa1e2e346d3bab0a3}


class Broker(threading.Thread):
    """Gives every tcpq client that subscribes what any client publishes."""

    PUBLISH, SUBSCRIBE = 1, 2

    def __init__(self):
        super().__init__(daemon=True)
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.url = f"tcpq://127.0.0.1:{self.listener.getsockname()[1]}"
        self.subscribers, self.lock = set(), threading.Lock()

    def run(self):
        while True:
            client, _ = self.listener.accept()
            client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            client.sendall(struct.pack(">II", 0x287617fa, 0x0100))
            threading.Thread(target=self.Serve, args=(client,), daemon=True).start()

    def Serve(self, client):
        file = client.makefile("rb")

        def Exactly(size):
            data = file.read(size)
            if len(data) < size:
                raise EOFError
            return data

        try:
            Exactly(8)
            while True:
                head = Exactly(8)
                kind, size = struct.unpack(">II", head)
                message = head + Exactly(size)
                if kind == self.SUBSCRIBE:
                    with self.lock:
                        self.subscribers.add(client)
                if kind != self.PUBLISH:
                    continue
                length = Exactly(4)
                message += length + Exactly(struct.unpack(">I", length)[0])
                with self.lock:
                    for other in list(self.subscribers):
                        try:
                            other.sendall(message)
                        except OSError:
                            self.subscribers.discard(other)
        except (OSError, EOFError):
            pass
        with self.lock:
            self.subscribers.discard(client)
        file.close()
        client.close()


def Join(port):
    """A socket that hears the group on `port`."""
    joined = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    joined.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    joined.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)
    joined.bind(("239.255.76.67", port))
    member = struct.pack("4s4s", socket.inet_aton("239.255.76.67"), socket.inet_aton("0.0.0.0"))
    joined.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, member)
    return joined


def Speaker():
    speaker = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    speaker.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
    return speaker


def Datagram(channel, payload):
    """LCM's own framing of a small message."""
    return struct.pack(">II", 0x4c433032, 0) + channel.encode() + b"\0" + payload


class Ear(threading.Thread):
    """What is said on each channel, as long as it listens."""

    def __init__(self, port):
        super().__init__(daemon=True)
        self.socket, self.heard, self.ending = Join(port), [], False
        self.socket.settimeout(0.1)
        self.start()

    def run(self):
        while not self.ending:
            try:
                data = self.socket.recv(65536)
            except TimeoutError:
                continue
            if data[:4] == b"LC02":
                channel, payload = data[8:].split(b"\0", 1)
                self.heard.append((channel.decode(), payload))
        self.socket.close()

    def On(self, channel):
        return [payload for name, payload in list(self.heard) if name == channel]

    def Statuses(self):
        """(state, last command, samples) of each status_t."""
        return [struct.unpack_from(">iiq", payload, 28) for payload in self.On("WELLGYRO_STATUS")]


class Relay(threading.Thread):
    """Carries multicast from one port to another as a bad network does: some is lost, all is
    delayed, and some therefore overtaken."""

    def __init__(self, port_from, port_to, loss, jitter):
        super().__init__(daemon=True)
        self.to, self.loss, self.jitter = ("239.255.76.67", port_to), loss, jitter
        self.chance, self.lost = random.Random(4), 0
        self.socket, self.out = Join(port_from), Speaker()

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


class Live(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.simulation = cls.Write("simulation.toml", SIMULATION)
        cls.job = cls.Write("job.toml", JOB)
        cls.port = 20000 + os.getpid() % 20000
        cls.broker = Broker()
        cls.broker.start()
        log = cls.Path("straight.lcm")
        cls.Make("simulate", "--job", cls.simulation, "--out", log, "--finish")
        cls.Make("survey", "--job", cls.job, "--from", log, "--out", cls.Path("straight"))

    def Start(self, *arguments):
        process = harness.Start(*arguments)
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
        listening, process.heard = harness.Listening(process)
        if not listening:
            self.fail("".join(process.heard))
        time.sleep(0.1)
        return process

    def EndsWell(self, process, seconds=60):
        try:
            text, errors = process.communicate(timeout=seconds)
        except subprocess.TimeoutExpired:
            process.kill()
            text, errors = process.communicate()
            self.fail(f"has not ended after {seconds} s; it said:\n{text}{errors}")
        self.assertEqual(process.returncode, 0, f"{text}{errors}")

    def Udpm(self):
        if not HasMulticast():
            self.assertNotIn("WELLGYRO_OWN_NETWORK", os.environ, "a network of our own has it")
            self.skipTest("no multicast route here")
        type(self).port += 1
        return f"udpm://239.255.76.67:{self.port}"

    def LiveOver(self, url, out):
        record = self.Path(out + ".lcm")
        recorder = self.Listening("record", "--from", url, "--out", record)
        survey = self.Listening("survey", "--job", self.job, "--from", url, "--out", self.Path(out),
                                "--record", self.Path(out + ".heard.lcm"))
        sent = Run("simulate", "--job", self.simulation, "--out", url, "--speed", "0", "--finish")
        self.assertEqual(sent.returncode, 0, sent.stderr)
        self.EndsWell(survey)
        recorder.send_signal(signal.SIGTERM)
        self.EndsWell(recorder)
        self.SameAs("straight", out)
        for log in (record, self.Path(out + ".heard.lcm")):
            again = Run("survey", "--job", self.job, "--from", log, "--out",
                        self.Path(out + ".again"))
            self.assertEqual(again.returncode, 0, again.stderr)
            self.SameAs("straight", out + ".again")

    def test_udpm_gives_the_bytes_of_the_log(self):
        self.LiveOver(self.Udpm(), "udpm")

    def test_tcpq_gives_the_bytes_of_the_log(self):
        self.LiveOver(self.broker.url, "tcpq")

    def test_advice_is_told_and_changes_nothing(self):
        url = self.Udpm()
        job = self.Write("advised.toml", JOB.replace("gyro_bias_sigma_deg_per_h = 0\n",
                                                     "gyro_bias_sigma_deg_per_h = 0.1\n"))
        well = self.Write("advised.csv", "MD[m],INC[deg],AZI_TRUE[deg]\n0,25,300\n400,25,300\n")
        plan = self.Path("plan", "plan.toml")
        self.Make("plan", "--well", well, "--tool", job, "--ellipse-m", "4", "--end-md-m", "200",
                  "--speed-mps", "1", "--out", self.Path("plan"))
        self.Make("survey", "--job", job, "--from", self.Path("straight.lcm"), "--out",
                  self.Path("unadvised"))
        ear = Ear(self.port)
        watch = self.Start("watch", url)
        survey = self.Listening("survey", "--job", job, "--from", url, "--out",
                                self.Path("advised"), "--advise", plan)
        self.Make("simulate", "--job", self.simulation, "--out", url, "--speed", "40", "--finish")
        self.EndsWell(survey)
        watch.send_signal(signal.SIGTERM)
        _, seen = watch.communicate(timeout=10)
        ear.ending = True
        self.SameAs("unadvised", "advised")
        told = ear.On("WELLGYRO_STATUS_ADVICE")
        self.assertTrue(told)
        for payload in told:
            self.assertEqual(payload[:8], struct.pack(">Q", FINGERPRINTS["advice_t"]))
        self.assertTrue(any(b" of 4.00 m" in payload for payload in told), told)
        self.assertIn(" of 4.00 m | MD ", seen)
        for name, says in ((self.job, "gyro_bias_sigma"), (job, "none.toml")):
            refused = Run("survey", "--job", name, "--from", url, "--out", self.Path("refused"),
                          "--advise", plan if name == self.job else "none.toml")
            self.assertEqual(refused.returncode, 2)
            self.assertIn(says, refused.stderr)
        self.assertEqual(Run("survey", "--job", job, "--from", self.Path("straight.lcm"), "--out",
                             self.Path("refused"), "--advise", plan).returncode, 1)

    def Interrupted(self, number):
        url = self.Udpm()
        out = self.Path(f"signal{number}")
        survey = self.Listening("survey", "--job", self.job, "--from", url, "--out", out)
        sender = self.Start("simulate", "--job", self.simulation, "--out", url, "--speed", "60")
        self.WaitFor(self.Path(out, "run.toml"))
        begin = time.monotonic()
        survey.send_signal(number)
        survey.wait(timeout=10)
        seconds = time.monotonic() - begin
        sender.kill()
        text = survey.stderr.read()
        self.assertEqual(survey.returncode, 0, text)
        self.assertIn("not adjusted", text)
        self.assertEqual(Run("check", self.Path(out, "survey.csv")).returncode, 0)
        self.assertIn("interrupted", self.Read(out, "source.toml"))
        self.assertIn("provisional", self.Read(out, "passes.csv"))
        # The station before the first north has the azimuth that this north gave it.
        self.assertRegex(self.Read(out, "checks.csv"), "stations_without_azimuth,.*,pass")
        print(f"signal {number}: {1000 * seconds:.0f} ms to the end")
        self.assertLess(seconds, Limit(0.2, 8))

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
        with concurrent.futures.ThreadPoolExecutor(5) as pool:
            kills = [pool.submit(self.KilledOnce, f"kill{kill}", self.Udpm(), chance.uniform(0, 6))
                     for kill in range(KILLS)]
            struck = 0
            for number, kill in enumerate(kills):
                with self.subTest(kill=number):
                    struck += kill.result()
        self.assertGreaterEqual(struck, KILLS // 3, "most surveys had ended before")

    def KilledOnce(self, out, url, delay):
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
        killed = survey.returncode == -signal.SIGKILL
        if killed:
            survey = self.Start(*command, "--resume", "--fill", full)
            sender.communicate(timeout=60)
            text, errors = survey.communicate(timeout=60)
            self.assertEqual(survey.returncode, 0, text + errors)
        recorder.kill()
        self.SameAs("straight", out)
        shutil.rmtree(self.Path(out))
        os.remove(full)
        os.remove(heard)
        return killed

    def test_resume_refuses_another_job(self):
        url = self.Udpm()
        out = self.Path("refused")
        heard = self.Path("refused.lcm")
        survey = self.Listening("survey", "--job", self.job, "--from", url, "--out", out,
                                "--record", heard)
        survey.kill()
        survey.communicate()
        other = self.Write("other.toml", JOB.replace("61.0", "60.0"))
        done = Run("survey", "--job", other, "--from", url, "--out", out, "--record", heard,
                   "--resume")
        self.assertEqual(done.returncode, 2)
        self.assertIn("another job", done.stderr)

    def test_what_is_missing_is_said(self):
        done = Run("survey", "--job", self.job, "--from", "tcpq://127.0.0.1:9", "--out",
                   self.Path("none"))
        self.assertEqual(done.returncode, 2)
        self.assertIn("no broker answers", done.stderr)
        done = Run("survey", "--job", self.job, "--from", self.Path("straight.lcm"), "--out",
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

    def Unread(self, name, reading, writing):
        """A survey that ends as well as any although nobody reads its standard error: all it could
        say is in the way from the moment it listens."""
        url, out = self.Udpm(), self.Path(name)
        survey = subprocess.Popen([PROGRAM, "survey", "--job", self.job, "--from", url, "--out",
                                   out], stdout=subprocess.PIPE, stderr=writing, text=True)
        self.addCleanup(self.Reap, survey)
        said = b""
        while b"granted" not in said:
            said += os.read(reading, 1 << 16)
        time.sleep(0.1)
        # By a description of our own: what is not to block here is to block there.
        filler = os.open(f"/proc/self/fd/{writing}", os.O_WRONLY | os.O_NONBLOCK | os.O_NOCTTY)
        filled = 0
        for size in (64, 1):
            try:
                while filled < 1 << 22:
                    filled += os.write(filler, b"." * size)
            except BlockingIOError:
                pass
        os.close(filler)
        self.assertLess(filled, 1 << 22, "it takes everything")
        self.Make("simulate", "--job", self.simulation, "--out", url, "--speed", "40", "--finish")
        self.EndsWell(survey, 20)
        self.SameAs("straight", name)

    def test_nobody_reads_what_it_says_to_a_pipe(self):
        reading, writing = os.pipe()
        self.addCleanup(os.close, reading)
        self.addCleanup(os.close, writing)
        self.Unread("pipe", reading, writing)

    def test_nobody_reads_what_it_says_to_a_terminal(self):
        reading, writing = os.openpty()
        self.addCleanup(os.close, reading)
        self.addCleanup(os.close, writing)
        self.Unread("terminal", reading, writing)

    def test_a_folder_that_goes_away_is_waited_for(self):
        url = self.Udpm()
        parent = self.Path("mount")
        out = os.path.join(parent, "out")
        survey = self.Listening("survey", "--job", self.job, "--from", url, "--out", out)
        sender = self.Start("simulate", "--job", self.simulation, "--out", url, "--speed", "40",
                            "--finish")
        self.WaitFor(self.Path(out, "run.toml"))
        ear = Ear(self.port)
        shutil.rmtree(parent)
        self.Write(parent, "in the way")
        # On a busy machine the files are written seldom: until they cannot be.
        end = time.monotonic() + 30
        while not any(state == 2 for state, *_ in ear.Statuses()):
            self.assertLess(time.monotonic(), end, "nobody says that the folder is gone")
            time.sleep(0.1)
        os.remove(parent)
        text, errors = survey.communicate(timeout=60)
        sender.communicate(timeout=60)
        self.assertEqual(survey.returncode, 0, text + errors)
        self.assertIn("cannot", errors)
        self.assertIn("up to date again", errors)
        self.SameAs("straight", out)

    def Command(self, number, kind, utime_us):
        """The bytes of a survey_cmd_t, by the one that simulate sends."""
        log = self.Bytes("straight.lcm")
        name = b"WELLGYRO_CMD"
        at = log.index(name) + len(name)
        return log[at:at + 8] + struct.pack(">qqiiiidid", utime_us, 1, 1, number, kind, 0, 0.0, 0,
                                            0.0)

    def test_commands_are_obeyed_once_and_acknowledged(self):
        url, out = self.Udpm(), self.Path("commands")
        ear = Ear(self.port)
        self.addCleanup(setattr, ear, "ending", True)
        survey = self.Listening("survey", "--job", self.job, "--from", url, "--out", out)
        sender = self.Start("simulate", "--job", self.simulation, "--out", url, "--speed", "40")
        adjust = Datagram("WELLGYRO_CMD", self.Command(7, 5, BEGIN_US + 200_000_000))
        speaker = Speaker()
        self.addCleanup(speaker.close)
        begin = time.monotonic()
        for _ in range(3):
            speaker.sendto(adjust, ("239.255.76.67", self.port))
        while not any(command == 7 for _, command, _ in ear.Statuses()):
            self.assertLess(time.monotonic() - begin, 30)
            time.sleep(0.05)
        before = len(ear.On("WELLGYRO_STATION"))
        sender.communicate(timeout=60)
        time.sleep(0.7)
        seconds = time.monotonic() - begin
        survey.send_signal(signal.SIGTERM)
        text, errors = survey.communicate(timeout=20)
        self.assertEqual(survey.returncode, 0, text + errors)
        # By the second, one more for the acknowledgement.
        self.assertLess(abs(len(ear.Statuses()) - seconds), 4)
        self.assertEqual(ear.Statuses()[-1][2], 39000)
        self.assertGreater(before, 10)
        rows = self.Rows(out, "passes.csv")
        field = [row for row in rows if row["STATUS"] == "field"]
        self.assertGreater(len(field), 5, "ADJUST makes field stations")
        self.assertEqual({row["REVISION"] for row in field}, {"1"}, "ADJUST was obeyed once")
        self.assertGreater(len([row for row in rows if row["STATUS"] == "provisional"]), 5)

    def test_a_bad_network_is_borne_and_a_recorder_beside_the_sender_has_it_all(self):
        near, far = self.Udpm(), self.Udpm()
        relay = Relay(self.port - 1, self.port, loss=0.02, jitter=0.03)
        relay.start()
        full = self.Path("near.lcm")
        recorder = self.Listening("record", "--from", near, "--out", full)
        survey = self.Listening("survey", "--job", self.job, "--from", far, "--out",
                                self.Path("far"))
        sent = Run("simulate", "--job", self.simulation, "--out", near, "--speed", "40", "--finish")
        self.assertEqual(sent.returncode, 0, sent.stderr)
        text, errors = survey.communicate(timeout=60)
        self.assertGreater(relay.lost, 0)
        self.assertEqual(survey.returncode, 3, text + errors)
        self.assertIn("did not come", errors)
        lost = int(re.search(r"samples_lost = (\d+)", self.Read("far", "run.toml")).group(1))
        self.assertGreater(lost, 0)
        self.assertLessEqual(lost, 32 * relay.lost)
        self.assertIn("gap", self.Read("far", "passes.csv"))
        recorder.send_signal(signal.SIGINT)
        recorder.communicate(timeout=20)
        again = Run("survey", "--job", self.job, "--from", full, "--out", self.Path("near"))
        self.assertEqual(again.returncode, 0, again.stderr)
        self.SameAs("straight", "near")

    def test_overlapping_batches_bear_every_single_loss(self):
        near, far = self.Udpm(), self.Udpm()
        relay = Relay(self.port - 1, self.port, loss=0.005, jitter=0.005)
        relay.start()
        overlapping = self.Write("overlap.toml", SIMULATION + "overlap = 32\n")
        survey = self.Listening("survey", "--job", self.job, "--from", far, "--out",
                                self.Path("overlap"))
        sent = Run("simulate", "--job", overlapping, "--out", near, "--speed", "30", "--finish")
        self.assertEqual(sent.returncode, 0, sent.stderr)
        text, errors = survey.communicate(timeout=60)
        self.assertGreater(relay.lost, 0)
        self.assertIn("samples_lost = 0", self.Read("overlap", "run.toml"), text + errors)

    def test_two_namespaces_with_a_bad_cable_between(self):
        if not os.environ.get("WELLGYRO_OWN_NETWORK"):
            self.skipTest("no network namespaces here")
        far = subprocess.Popen(["unshare", "-n", "sleep", "600"])
        self.addCleanup(lambda: (far.kill(), far.wait()))
        time.sleep(0.3)
        there = f"nsenter -t {far.pid} -n "
        self.addCleanup(subprocess.run, "ip link del near", shell=True, check=False)
        made = subprocess.run(
            f"ip link add near type veth peer name far netns {far.pid} && "
            "ip addr add 10.77.0.1/24 dev near && ip link set near up && "
            f"{there}ip addr add 10.77.0.2/24 dev far && {there}ip link set far up && "
            f"{there}ip link set lo up && {there}ip route add 224.0.0.0/4 dev far && "
            "ip route replace 239.255.76.68 dev near", shell=True, check=False,
            capture_output=True, text=True)
        if made.returncode != 0:
            self.skipTest("no cable between namespaces here: " + made.stderr.strip())
        netem = subprocess.run(
            f"{there}tc qdisc add dev far root netem loss 1% delay 10ms 8ms reorder 5%",
            shell=True, check=False, capture_output=True, text=True)
        if netem.returncode != 0:
            print("the kernel has no netem: the cable is a good one")
        type(self).port += 1
        url = f"udpm://239.255.76.68:{self.port}?ttl=1"
        # Its orders, FINISH among them, are obeyed because the URL names the machine.
        survey = self.Listening("survey", "--job", self.job, "--from", url + "&from=10.77.0.2",
                                "--out", self.Path("cable"))
        sent = subprocess.run([*there.split(), PROGRAM, "simulate", "--job", self.simulation,
                               "--out", url, "--speed", "40", "--finish"], capture_output=True,
                              text=True, check=False, timeout=60)
        self.assertEqual(sent.returncode, 0, sent.stderr)
        text, errors = survey.communicate(timeout=60)
        if netem.returncode == 0:
            self.assertIn(survey.returncode, (0, 3), text + errors)
            self.assertGreater(len(self.Rows("cable", "survey.csv")), 15)
        else:
            self.assertEqual(survey.returncode, 0, text + errors)
            self.SameAs("straight", "cable")

    def test_two_tools_in_one_string(self):
        url, out = self.Udpm(), self.Path("string")
        # Both senders give the same depths, the one a little before the other: at 40 times the speed,
        # a process that starts half a second later is 20 s behind.
        patient = self.Write("patient.toml", JOB.replace("latency_s = 2.0", "latency_s = 20.0"))
        jobs = []
        for tool in (1, 2):
            job = self.Write(f"tool{tool}.toml", SIMULATION.replace("seed = 5", f"seed = {tool}") +
                             f"tool = {tool}\nsession = {tool}\n")
            log = self.Path(f"tool{tool}.lcm")
            self.Make("simulate", "--job", job, "--out", log)
            self.Make("survey", "--job", patient, "--from", log, "--out",
                      self.Path(f"alone{tool}"))
            jobs.append(job)
        survey = self.Listening("survey", "--job", patient, "--from", url, "--out", out)
        senders = [self.Start("simulate", "--job", job, "--out", url, "--speed", "40")
                   for job in jobs]
        for sender in senders:
            sender.communicate(timeout=60)
        time.sleep(1)
        survey.send_signal(signal.SIGTERM)
        text, errors = survey.communicate(timeout=20)
        self.assertEqual(survey.returncode, 0, text + errors)
        self.assertNotIn("two senders", errors)
        self.assertFalse(os.path.exists(self.Path(out, "survey.csv")))
        for tool in (1, 2):
            self.assertIn("samples_lost = 0", self.Read(out, f"tool-{tool}", "run.toml"))
            rows = self.Rows(out, f"tool-{tool}", "survey.csv")[:20]
            alone = self.Rows(f"alone{tool}", "survey.csv")[:20]
            self.assertEqual([float(row["MD[m]"]) for row in rows], [10.0 * i for i in range(20)])
            # Live it was not adjusted: the same but for what the last stop adds.
            for row, other in zip(rows, alone, strict=True):
                self.assertAlmostEqual(float(row["INC[deg]"]), float(other["INC[deg]"]), delta=1e-3)
                off = (float(row["AZI_TRUE[deg]"]) - float(other["AZI_TRUE[deg]"]) + 180) % 360 - 180
                self.assertLess(float(row["SIG_AZI[deg]"]), 1)
                self.assertLess(abs(off), 3 * float(row["SIG_AZI[deg]"]))
        self.assertNotEqual(*(self.Read(out, f"tool-{tool}", "survey.csv") for tool in (1, 2)))

    def test_a_full_disk_is_borne(self):
        disk = self.Path("disk")
        os.mkdir(disk)
        made = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=2400k", "tmpfs", disk],
                              check=False, capture_output=True)
        if made.returncode != 0:
            self.skipTest("no small disk can be made here")
        self.addCleanup(subprocess.run, ["umount", disk], check=False)
        url, out, heard = self.Udpm(), self.Path(disk, "out"), self.Path(disk, "heard.lcm")
        survey = self.Listening("survey", "--job", self.job, "--from", url, "--out", out,
                                "--record", heard)
        recorder = self.Listening("record", "--from", url, "--out", self.Path(disk, "all.lcm"))
        sender = self.Start("simulate", "--job", self.simulation, "--out", url, "--speed", "40",
                            "--finish")
        text, errors = recorder.communicate(timeout=60)
        self.assertEqual(recorder.returncode, 2, "a recorder ends where its disk is full")
        self.assertIn("No space left", errors)
        time.sleep(1)
        for log in (heard, self.Path(disk, "all.lcm")):
            self.assertEqual(Run("check", log).returncode, 0, "whole events only")
            os.remove(log)
        sender.communicate(timeout=60)
        text, errors = survey.communicate(timeout=60)
        self.assertIn(survey.returncode, (0, 3), text + errors)
        self.assertIn("its recording is tried again", errors)
        self.SameAs("straight", out)

    def test_what_the_system_holds_at_a_signal_is_recorded(self):
        url, log = self.Udpm(), self.Path("held.lcm")
        recorder = self.Listening("record", "--from", url, "--out", log)
        recorder.send_signal(signal.SIGSTOP)
        short = self.Write("short.toml", Simulation(Stop(6), "imu_hz = 100.0\nbatch = 2\n"))
        sent = Run("simulate", "--job", short, "--out", url, "--speed", "60")
        self.assertEqual(sent.returncode, 0, sent.stderr)
        recorder.send_signal(signal.SIGTERM)
        recorder.send_signal(signal.SIGCONT)
        text, errors = recorder.communicate(timeout=20)
        self.assertEqual(recorder.returncode, 0, text + errors)
        self.assertEqual(self.Bytes("held.lcm").count(b"WELLGYRO_IMU"), 300)

    def test_a_log_that_is_rotated_away(self):
        url, log = self.Udpm(), self.Path("away.lcm")
        recorder = self.Listening("record", "--from", url, "--out", log)
        sender = self.Start("simulate", "--job", self.simulation, "--out", url, "--speed", "60")
        time.sleep(2)
        os.rename(log, self.Path("away.1.lcm"))
        sender.communicate(timeout=60)
        recorder.send_signal(signal.SIGTERM)
        text, errors = recorder.communicate(timeout=20)
        self.assertEqual(recorder.returncode, 0, text + errors)
        self.assertIn("was moved or removed", errors)
        both = self.Bytes("away.1.lcm") + self.Bytes("away.lcm")
        self.assertEqual(both.count(b"WELLGYRO_IMU"), 1219)

    def test_resume_refuses_a_journal_that_is_damaged(self):
        url, out, heard = self.Udpm(), self.Path("journal"), self.Path("journal.lcm")
        survey = self.Listening("survey", "--job", self.job, "--from", url, "--out", out,
                                "--record", heard)
        survey.kill()
        survey.communicate()
        again = ["survey", "--job", self.job, "--from", url, "--out", out, "--record", heard]
        self.assertEqual(Run(*again).returncode, 2, "the log is there already")
        journal = self.Path(out, "journal.toml")
        whole = self.Bytes(journal)
        for size in (0, 10, len(whole) // 2, len(whole) - 5, len(whole) - 1):
            self.Write(journal, whole[:size])
            done = Run(*again, "--resume")
            self.assertEqual(done.returncode, 2, size)
            self.assertIn("damaged", done.stderr)
        missing = Run(*again, "--resume", "--fill", self.Path("no.lcm"))
        self.assertEqual(missing.returncode, 2)
        self.assertIn("no.lcm", missing.stderr)

    def test_what_cannot_be_is_refused_at_once(self):
        url = self.Udpm()
        survey = ["survey", "--job", self.job, "--out", self.Path("never")]
        blocked = self.Write("blocked", "no folder")
        for arguments, code, words in (
                ([*survey, "--from", "udp://239.255.76.67:7667"], 2, "udp"),
                ([*survey, "--from", "udpm://10.0.0.1:7667"], 2, "10.0.0.1"),
                ([*survey, "--from", "udpm://239.255.76.67:99999"], 2, "99999"),
                ([*survey, "--from", url + "?ttl=x"], 2, "ttl"),
                ([*survey, "--from", "tcpq://no.such.host.invalid:1"], 2, "broker"),
                ([*survey, "--from", url, "--resume"], 1, "--record"),
                ([*survey, "--from", url, "--record", "/no/such/folder/x.lcm"], 2, "/no/such"),
                (["survey", "--job", self.job, "--from", url, "--out", blocked, "--record",
                  self.Path("x.lcm")], 2, "blocked"),
                (["record", "--from", "a.lcm", "--out", self.Path("x.lcm")], 1, "a.lcm"),
                (["record", "--from", url, "--out", "/no/such/folder/x.lcm"], 2, "/no/such"),
                (["record", "--from", url, "--out", blocked], 2, "exists"),
                (["simulate", "--job", self.simulation, "--out", url, "--speed", "-1"], 1,
                 "speed")):
            done = Run(*arguments)
            self.assertEqual(done.returncode, code, (arguments, done.stderr))
            self.assertIn(words, done.stderr, arguments)

    def test_a_signal_at_the_very_start(self):
        url = self.Udpm()
        for delay in (0.0, 0.005, 0.01, 0.02, 0.04, 0.08):
            out = self.Path(f"early{delay}")
            survey = self.Start("survey", "--job", self.job, "--from", url, "--out", out)
            time.sleep(delay)
            survey.send_signal(signal.SIGINT)
            self.assertIn(survey.wait(timeout=10), (2, -signal.SIGINT))
            if os.path.isdir(out):
                self.assertEqual(os.listdir(out), [])

    def test_a_recorder_rotates_and_says_what_did_not_come(self):
        url = self.Udpm()
        lossy = self.Write("lossy.toml", SIMULATION + "loss_probability = 0.05\n")
        recorder = self.Listening("record", "--from", url, "--out", self.Path("rot.lcm"),
                                  "--rotate-mb", "0.5")
        sent = Run("simulate", "--job", lossy, "--out", url, "--speed", "0")
        self.assertEqual(sent.returncode, 0, sent.stderr)
        time.sleep(0.3)
        recorder.send_signal(signal.SIGINT)
        text, errors = recorder.communicate(timeout=20)
        self.assertEqual(recorder.returncode, 3, text + errors)
        self.assertIn("did not come", errors)
        self.assertIn("rot.001.lcm", text)
        for name in ("rot.lcm", "rot.001.lcm"):
            self.assertEqual(Run("check", self.Path(name)).returncode, 0)


def InOwnNetwork(script_file=__file__):
    """Starts over in a network namespace, so that tests disturb nobody; as we are where not."""
    if os.environ.get("WELLGYRO_OWN_NETWORK"):
        return
    script = ("ip link set lo up && ip route add 224.0.0.0/4 dev lo && "
              "sysctl -qw net.core.rmem_max=4194304 2>/dev/null; exec \"$@\"")
    try:
        probe = subprocess.run(["unshare", "-rnm", "sh", "-c", script, "sh", "true"], check=False,
                               capture_output=True)
    except FileNotFoundError:
        return
    if probe.returncode != 0:
        print("no network namespaces here: the tests use this machine's network")
        return
    os.environ["WELLGYRO_OWN_NETWORK"] = "1"
    os.execvp("unshare", ["unshare", "-rnm", "sh", "-c", script, "sh", sys.executable, script_file,
                          PROGRAM, "--kills", str(KILLS), *sys.argv[1:]])


if __name__ == "__main__":
    InOwnNetwork()
    unittest.main()
