#!/usr/bin/env python3
"""The live page of a running survey: every station in it, its end, its death and its return said,
readers that cost the survey nothing, strangers kept out, orders signed.
page_test.py PROGRAM     in a network of its own where the machine allows it"""
import http.client
import json
import os
import re
import selectors
import shutil
import signal
import socket
import threading
import time
import unittest
import urllib.parse

import browser
import live_test
from harness import Limit, Move, Run, Simulation, Stop
from live_test import Ear, InOwnNetwork, Live

SIMULATION = Simulation(Stop(90) + Move(200) + Stop(90) + Move(20) + Stop(30),
                        "imu_hz = 100.0\ndepth_hz = 4.0\nbatch = 32\n", seed=5,
                        tool="accel_noise_mps2_per_sqrt_hz = 2e-4\n")
JOB = live_test.JOB.replace("accel_noise_mps2_per_sqrt_hz = 0",
                            "accel_noise_mps2_per_sqrt_hz = 2e-4")
LINK = "document.getElementById('link').textContent"
ROWS = """Array.from(document.querySelectorAll('#stations tr')).map(
    r => Array.from(r.cells).map(c => c.textContent))"""


def Seconds(pid):
    """Of a processor, that a process has used."""
    with open(f"/proc/{pid}/stat", encoding="utf-8") as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class Timed(list):
    """What an Ear heard, each with its time."""

    def append(self, heard):
        super().append((*heard, time.time()))


class Readers(threading.Thread):
    """Plain readers of /events; some `deaf`, which never read. What one of them heard, by time."""

    def __init__(self, port, count, deaf=0):
        super().__init__(daemon=True)
        self.port, self.heard, self.ended, self.selector = port, b"", 0, selectors.DefaultSelector()
        self.times, self.deaf, self.open = [], [self.Ask() for _ in range(deaf)], count
        for number in range(count):
            self.selector.register(self.Ask(), selectors.EVENT_READ, number)
        self.start()

    def Close(self):
        for one in self.deaf:
            one.close()
        for key in list(self.selector.get_map().values()):
            key.fileobj.close()

    def Ask(self):
        asked = socket.create_connection(("127.0.0.1", self.port))
        asked.sendall(b"GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n")
        return asked

    def run(self):
        while self.ended < self.open:
            for key, _ in self.selector.select():
                try:
                    part = key.fileobj.recv(1 << 16)
                except ConnectionError:
                    part = b""
                if key.data == 0:
                    self.heard += part
                    self.times.append((time.time(), len(self.heard)))
                if not part:
                    self.selector.unregister(key.fileobj)
                    key.fileobj.close()
                    self.ended += 1

    def Events(self, name):
        """(time, data) of each event of that name."""
        pattern = rb"event: " + name.encode() + rb"\ndata: (.*)\n"
        for found in re.finditer(pattern, self.heard):
            when = next(at for at, size in self.times if size >= found.end())
            yield when, json.loads(found.group(1))


class LivePage(Live):
    @classmethod
    def setUpClass(cls):
        cls.NewFolder()
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.simulation = cls.Write("simulation.toml", SIMULATION)
        cls.job = cls.Write("job.toml", JOB)
        cls.port = 20000 + os.getpid() % 20000
        cls.web = 8000 + os.getpid() % 10000
        log = cls.Path("straight.lcm")
        cls.Make("simulate", "--job", cls.simulation, "--out", log, "--finish")
        cls.Make("survey", "--job", cls.job, "--from", log, "--out", cls.Path("straight"))

    def Survey(self, out, *options, job=None, page=True):
        type(self).web += page
        self.url = self.Udpm()
        return self.Again(out, *options, job=job, page=page)

    def Again(self, out, *options, job=None, page=True):
        """On the bus and at the address of before."""
        served = ("--page", f"127.0.0.1:{self.web}") if page else ()
        return self.Listening("survey", "--job", job or self.job, "--from", self.url, "--out",
                              self.Path(out), *served, *options)

    def Simulate(self, speed, *options):
        return self.Start("simulate", "--job", self.simulation, "--out", self.url, "--speed",
                          str(speed), "--finish", *options)

    def Page(self, **options):
        shown = browser.Browser()
        self.addCleanup(shown.Close)
        page = browser.Page(shown, online=True, **options)
        page.Open(f"http://127.0.0.1:{self.web}/")
        return page

    def Ask(self, path="/", method="GET", body=None, **headers):
        asked = http.client.HTTPConnection("127.0.0.1", self.web, timeout=10)
        headers = {name.replace("_", "-"): value for name, value in headers.items()}
        asked.request(method, path, body=body, headers=headers)
        answer = asked.getresponse()
        text = answer.read().decode()
        asked.close()
        return answer, text

    def SameStations(self, rows, name):
        """The page's table against passes.csv."""
        columns = [("MD[m]", 2), ("INC[deg]", 3), ("AZI_TRUE[deg]", 3), ("SIG_INC[deg]", 3),
                   ("SIG_AZI[deg]", 3), ("TVD[m]", 2), ("N[m]", 2), ("E[m]", 2)]
        words = ("RUN", "PASS", "KIND", "STATUS", "REVISION", "QUALITY")
        key = lambda cells: (cells[9], cells[10], cells[0])
        wanted = [[f"{float(row[c]):.{d}f}" if row[c] else "\u2013" for c, d in columns]
                  + [row[word] for word in words] for row in self.Rows(name, "passes.csv")]
        self.assertGreater(len(wanted), 20)
        self.assertEqual(len(rows), len(wanted))
        for shown, row in zip(sorted(rows, key=key), sorted(wanted, key=key), strict=True):
            self.assertEqual(shown[8:], row[8:])
            for cell, text in zip(shown[:8], row[:8], strict=True):
                if text == "\u2013":
                    self.assertEqual(cell, text)
                else:  # both are rounded, perhaps not alike
                    self.assertAlmostEqual(float(cell), float(text), delta=0.0101)

    @unittest.skipUnless(browser.PROGRAM, "no Chromium on this machine")
    def test_every_station_is_in_the_page(self):
        survey = self.Survey("all")
        ear, readers = Ear(self.port), Readers(self.web, 1)
        ear.heard = Timed()
        page = self.Page()
        self.assertEqual(page.errors, [])
        self.Simulate(60)
        page.Until(f"{LINK}.startsWith('Running')")
        page.Until(f"{LINK}.startsWith('The survey has ended: finished and adjusted')", 40)
        self.EndsWell(survey)
        ear.ending = True
        self.SameStations(page.Ask(ROWS), "all")
        self.SameAs("straight", "all")
        self.assertEqual({urllib.parse.urlsplit(r).path for r in page.requests}, {"/events"})
        page.Until("document.querySelectorAll('figure.chart svg').length === 6")
        self.assertIn("finish of unsigned", page.Ask(
            "document.getElementById('notices').textContent"))
        checks = {row["CODE"] for row in self.Rows("all", "checks.csv")}
        shown = set(page.Ask("""Array.from(document.querySelectorAll('#checks tr, #undone tr')).map(
            r => r.cells[1].textContent)"""))
        self.assertEqual(shown, checks)
        # Each station, as it is first told, is with the readers soon after its message on the bus.
        readers.join(5)
        sent = [when for channel, _, when in ear.heard if channel == "WELLGYRO_STATION"]
        told = [when for when, data in readers.Events("station") if data["row"][3] == 0]
        self.assertGreater(len(told), 20)
        waited = max(page - bus for page, bus in zip(told, sent, strict=False))
        print(f"{len(told)} stations, in the page {waited:.2f} s after their messages at most")
        self.assertLessEqual(waited, Limit(1, 5))

    @unittest.skipUnless(browser.PROGRAM, "no Chromium on this machine")
    def test_killed_it_says_so_and_resumed_it_goes_on(self):
        record = ("--record", self.Path("killed.lcm"))
        survey = self.Survey("killed", *record)
        page = self.Page()
        simulation = self.Simulate(30)
        page.Until("document.querySelectorAll('#stations tr').length > 5", 30)
        survey.kill()
        waited = page.Until(f"{LINK}.startsWith('No link')", 20)
        print(f"killed: said after {waited:.1f} s")
        self.assertLessEqual(waited, Limit(5, 15))
        self.assertIn("verdict fail", page.Ask("document.getElementById('link').className"))
        survey.wait()
        survey = self.Again("killed", *record, "--resume")
        waited = page.Until(f"{LINK}.startsWith('Running')", 10)
        print(f"resumed: running after {waited:.1f} s")
        survey.send_signal(signal.SIGSTOP)
        waited = page.Until(f"{LINK}.startsWith('No link')", 20)
        print(f"stands still: said after {waited:.1f} s")
        self.assertLessEqual(waited, Limit(5, 15))
        survey.send_signal(signal.SIGCONT)
        page.Until(f"{LINK}.startsWith('Running')", 10)
        simulation.wait()
        page.Until(f"{LINK}.startsWith('The survey has ended')", 30)
        survey.communicate(timeout=30)
        self.SameStations(page.Ask(ROWS), "killed")

    @unittest.skipUnless(browser.PROGRAM, "no Chromium on this machine")
    def test_a_tool_that_falls_silent_is_said(self):
        self.Survey("silent")
        page = self.Page()
        page.Until(f"{LINK}.startsWith('The survey listens')", 10)
        simulation = self.Simulate(60)
        page.Until(f"{LINK} === 'Running.'", 10)
        simulation.kill()
        waited = page.Until(f"{LINK}.startsWith('No samples')", 20)
        print(f"tool silent: said after {waited:.1f} s")
        self.assertLessEqual(waited, Limit(5, 15))

    def test_a_hundred_pages_change_no_byte_and_cost_next_to_nothing(self):
        used = {}
        for name, pages in (("alone", 0), ("crowd", 100)):
            survey = self.Survey(name, page=pages > 0)
            readers = Readers(self.web, pages, deaf=pages // 10) if pages else None
            begin, before = time.monotonic(), Seconds(survey.pid)
            simulation = self.Simulate(60)
            simulation.wait()
            used[name] = (Seconds(survey.pid) - before) / (time.monotonic() - begin)
            self.EndsWell(survey)
            if readers:
                readers.join(10)
                self.assertFalse(readers.is_alive(), "a reader was not let go at the end")
                readers.Close()
        self.SameAs("alone", "crowd")
        self.SameAs("straight", "crowd")
        print(f"load alone {100 * used['alone']:.2f} %, with 100 pages {100 * used['crowd']:.2f} %")
        # At speed 1: tests/bench/live_page.py.
        self.assertLess(used["crowd"] - used["alone"], Limit(0.05, 0.5))

    def test_more_readers_than_there_is_room_for(self):
        survey = self.Survey("full")
        readers = Readers(self.web, 200)
        time.sleep(3)
        files = len(os.listdir(f"/proc/{survey.pid}/fd"))
        self.assertLess(files, 200)
        self.assertEqual(sum(1 for _ in readers.Events("hello")), 1)
        self.Simulate(0)
        self.EndsWell(survey)
        readers.join(10)
        readers.Close()
        self.SameAs("straight", "full")

    def test_strangers_are_kept_out(self):
        self.Survey("open")
        self.assertEqual(self.Ask()[0].status, 200)
        for host in ("evil.example", "evil.example:80", "127.0.0.1.evil.example", "192.0.2.7", ""):
            self.assertEqual(self.Ask("/", Host=host)[0].status, 421, host)
        for host in ("localhost", f"127.0.0.1:{self.web}", "[::1]:1", "LOCALHOST"):
            self.assertEqual(self.Ask("/", Host=host)[0].status, 200, host)
        self.assertEqual(self.Ask("/order", "POST", "what=adjust")[0].status, 404)
        self.assertEqual(self.Ask("/../job.toml")[0].status, 404)
        taken = Run("survey", "--job", self.job, "--from", self.Udpm(), "--out",
                    self.Path("other"), "--page", f"127.0.0.1:{self.web}")
        self.assertEqual(taken.returncode, 2)
        self.assertIn("cannot be had", taken.stderr)
        self.assertFalse(os.path.exists(self.Path("other")))

    def test_a_token_is_wanted_where_others_can_reach_it(self):
        type(self).web += 1
        self.url, kept = self.Udpm(), self.Path("token")
        survey = self.Listening("survey", "--job", self.job, "--from", self.url, "--out",
                                self.Path("token-out"), "--page", f"0.0.0.0:{self.web}",
                                "--page-token", kept)
        token = self.Read("token").strip()
        self.assertEqual(os.stat(kept).st_mode & 0o777, 0o600)
        self.assertRegex(token, "^[0-9a-f]{32}$")
        said = survey.stderr.readline() + survey.stderr.readline()
        self.assertIn(f"/?token={token}", said)
        for path in ("/", "/events", "/?token=", f"/?token={token[:-1]}x", f"/events?token={token}"):
            self.assertEqual(self.Ask(path)[0].status, 403, path)
        answer, _ = self.Ask(f"/?token={token}")
        self.assertEqual((answer.status, answer.headers["Location"]), (303, "/"))
        cookie = answer.headers["Set-Cookie"]
        self.assertIn("HttpOnly; SameSite=Strict", cookie)
        self.assertEqual(self.Ask(Cookie=cookie.split(";")[0])[0].status, 200)
        self.assertEqual(self.Ask(Cookie=cookie.split(";")[0], Host="evil.example")[0].status, 421)
        self.assertEqual(self.Ask(Cookie=cookie.split(";")[0], Host="192.0.2.7")[0].status, 200)

    def Keys(self):
        for name in ("ada.pem", "other.pem"):
            if not os.path.exists(self.Path(name)):
                made = Run("send", "--new-key", self.Path(name))
                self.assertEqual(made.returncode, 0, made.stderr)
                if name == "ada.pem":
                    public = re.search(r'public_key = "(\w+)"', made.stdout).group(1)
                    self.Write("keys.toml", JOB + '[operations]\nunsigned_tool = true\n'
                               f'[[operator]]\nname = "Ada"\npublic_key = "{public}"\n')
        return self.Path("keys.toml"), self.Path("ada.pem")

    def test_orders_are_signed_and_only_the_page_gives_them(self):
        job, key = self.Keys()
        refused = Run("survey", "--job", job, "--from", self.Udpm(), "--out", self.Path("no"),
                      "--page", "127.0.0.1:0", "--page-key", self.Path("other.pem"))
        self.assertEqual(refused.returncode, 2)
        self.assertIn("no [[operator]] with this key", refused.stderr)
        survey = self.Survey("orders", "--page-key", key, "--page-token", self.Path("orders.token"),
                             job=job)
        self.Simulate(20)
        self.assertEqual(self.Ask()[0].status, 403)
        cookie = {"Cookie": f"wellgyro-{self.web}={self.Read('orders.token').strip()}"}
        own = {"Origin": f"http://127.0.0.1:{self.web}", "X_Wellgyro": "order",
               "Content_Type": "application/x-www-form-urlencoded"}
        remark = urllib.parse.urlencode({"what": "remark", "who": "Ada <b>", "text": "tight spot"})
        for missing in ({"X_Wellgyro": "order"}, {"Origin": own["Origin"]}):
            asked = {**own, **cookie}
            asked = {name: value for name, value in asked.items() if name not in own or
                     name in missing or name == "Content_Type"}
            self.assertEqual(self.Ask("/order", "POST", remark, **asked)[0].status, 403)
        foreign = {**own, **cookie, "Origin": "http://evil.example"}
        self.assertEqual(self.Ask("/order", "POST", remark, **foreign)[0].status, 403)
        self.assertEqual(self.Ask("/order", "POST", remark, **own)[0].status, 403)
        time.sleep(7)  # beyond the first stop, so that there is a survey
        answer, text = self.Ask("/order", "POST", remark, **own, **cookie)
        self.assertEqual(answer.status, 200)
        self.assertIn("The survey has obeyed: remark", text)
        for what, more in (("adjust", ""), ("accept", "&md_m=10"), ("reject", "&md_m=20&run=1")):
            _, text = self.Ask("/order", "POST", f"what={what}&who=Ada{more}", **own, **cookie)
            self.assertIn(f"The survey has obeyed: {what}", text)
        for body in ("what=finish", "what=remark", "what=accept&md_m=deep", "what=accept&run=-1"):
            self.assertIn("Not sent", self.Ask("/order", "POST", body, **own, **cookie)[1])
        # An order holds as from the samples of its time on, and is in the files soon after.
        end = time.monotonic() + 10
        while ",rejected," not in self.Read("orders", "passes.csv") and time.monotonic() < end:
            time.sleep(0.1)
        survey.send_signal(signal.SIGINT)
        survey.communicate(timeout=20)
        orders = self.Toml("orders", "run.toml")["operation"]
        self.assertEqual([(o["kind"], o["key"], o["obeyed"], o.get("who")) for o in orders],
                         [("remark", "Ada", True, "Ada <b>"), ("adjust", "Ada", True, None),
                          ("accept", "Ada", True, "Ada"), ("reject", "Ada", True, "Ada")])
        status = {row["MD[m]"]: row["STATUS"] for row in self.Rows("orders", "passes.csv")}
        self.assertEqual((status["10.0000"], status["20.0000"]), ("definitive", "rejected"))

    @unittest.skipUnless(browser.PROGRAM, "no Chromium on this machine")
    def test_names_are_text_and_the_page_can_be_read(self):
        names = browser.HOSTILE
        quoted = [json.dumps(name) for name in names]
        job = self.Write("hostile.toml", JOB.replace('name = "Slant"', "name = " + quoted[0])
                         + f"[identity]\noperator = {quoted[1]}\nfield = {quoted[2]}\n"
                         f"rig = {quoted[3]}\nslot = {quoted[5]}\n")
        plan = self.Write("plan.csv", "MD[m],INC[deg],AZI[deg]\n0,25,300\n300,25,300\n")
        self.Survey("hostile", "--page-plan", plan, "--page-sigma-deg", "0.05", job=job)
        page = self.Page()
        self.Simulate(60)
        page.Until("document.getElementById('now-more').textContent.includes("
                   "' s more at least for \u00b1 0.05\u00b0')")
        page.Until("document.querySelectorAll('#stations tr').length > 25", 30)
        page.Until("document.querySelectorAll('figure.chart svg').length === 6", 30)
        self.assertEqual(page.errors, [])
        shown = page.Ask("document.querySelector('.running').textContent")
        for name in names[:4]:
            self.assertIn(name[:50], shown)
        self.assertIn("plan", page.Ask("document.getElementById('plan').textContent"))
        self.assertEqual(page.Ask(browser.FAINT), [])
        for width in (1280, 390):
            page.Do("Emulation.setDeviceMetricsOverride", width=width, height=900,
                    deviceScaleFactor=1, mobile=False)
            self.assertLessEqual(page.Ask("document.documentElement.scrollWidth"), width)

    def test_a_log_has_no_page(self):
        done = Run("survey", "--job", self.job, "--from", self.Path("straight.lcm"), "--out",
                   self.Path("x"), "--page", "8080")
        self.assertEqual(done.returncode, 1)
        self.assertIn("--page are for a live stream", done.stderr)
        for address in ("here", "127.0.0.1:", "127.0.0.1:99999", ":-1", ""):
            done = Run("survey", "--job", self.job, "--from", self.Udpm(), "--out",
                       self.Path("x"), "--page=" + address)
            self.assertIn(done.returncode, (1, 2), address)
            self.assertFalse(os.path.exists(self.Path("x")))


# The tests of live surveys themselves stand in live_test.py.
for name in [n for n in dir(Live) if n.startswith("test_")]:
    setattr(LivePage, name, None)


if __name__ == "__main__":
    InOwnNetwork(__file__)
    del Live
    unittest.main()
