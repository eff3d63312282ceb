#!/usr/bin/env python3
"""From a bench to a survey by the program, and benches that cannot give a calibration: files, exit
codes, sentences. calibrate_test.py PROGRAM"""
import hashlib
import itertools
import math
import os
import random
import re
import shutil
import unittest

from harness import DEMO, TOP, FreshProgramTest, Job, Move, Run, Simulation, Stop

EARTH = 15.041067178669  # deg/h
G = 9.80665
LATITUDE = 61.0

SIMULATION = Simulation(Stop(120) + Move(300) + Stop(120),
                        "imu_hz = 20.0\ndepth_hz = 4.0\nbatch = 20\noverlap = 5\n", walk=0.002,
                        tool="has_gz = true\n")
JOB = Job(25.0, walk=0.002)

# The tool as it is. Axes of the bench: x is -y of the tool, y its x.
B = [1.35, -0.82, 0.57, -1.1]  # deg/h
U = [[1.0008, 0.003, -0.002], [-0.0025, 0.9995, 0.0015], [0.0012, -0.0031, 1.0011],
     [0.9991, -0.0017, 0.0022]]
FORCE = [[3.2, 0.45, 0], [-0.45, 3.2, 0], [0.31, 0, -2.6], [-2.6, 0, -0.31]]  # deg/h/g
VOLT = [0.0123, -0.0087, 0.021]
PER_G = [[3.02, 0.012, -0.018], [0.009, 2.97, 0.015], [-0.021, 0.007, 3.05]]


def Dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def Level(north, down, inc, az, tf):
    """North and down of a vector in the axes of the bench, toolface measured to y."""
    i, a, t = (math.radians(x) for x in (inc, az, tf))
    high = north * math.cos(i) * math.cos(a) - down * math.sin(i)
    right = -north * math.sin(a)
    along = north * math.sin(i) * math.cos(a) + down * math.cos(i)
    return [math.sin(t) * high - math.cos(t) * right, math.cos(t) * high + math.sin(t) * right,
            along]


def Table(columns, rows):
    return "\n".join([columns] + [",".join(str(x) for x in row) for row in rows]) + "\n"


def Gyros(w, f, noise):
    return [B[c] + Dot(U[c], w) + Dot(FORCE[c], f) + noise() for c in range(4)]


def AtRest(source):
    rows = []
    latitude = math.radians(LATITUDE)
    for inc in range(0, 181, 45):
        for az in range(0, 360, 90):
            for tf in range(0, 360, 60):
                w = Level(EARTH * math.cos(latitude), -EARTH * math.sin(latitude), inc, az, tf)
                f = [-x for x in Level(0, 1, inc, az, tf)]
                rows.append([inc, az, tf] + f + Gyros(w, f, lambda: source.gauss(0, 0.02)))
    return Table("inc,az,tf,fx,fy,fz,m_x1,m_y1,m_z2,m_x2", rows)


def OnTable(source):
    rows = []
    up = EARTH * math.sin(math.radians(LATITUDE))
    for axis in range(3):
        for rate in (-100, -50, -20, 20, 50, 100):
            f = [1 if k == axis else 0 for k in range(3)]
            w = [(3600 * rate + up) * x for x in f]
            rows.append(["xyz"[axis], rate] + Gyros(w, f, lambda: source.gauss(0, 0.5)))
    return Table("axis,rate_deg_s,m_x1,m_y1,m_z2,m_x2", rows)


def WholeTool(table, source, shift=0.0):
    """The table at rest with accelerometers as sensors have them, m/s2; the first gyro shifted."""
    lines = table.splitlines()
    rows = [lines[0]]
    for line in lines[1:]:
        cells = [float(x) for x in line.split(",")]
        for k in range(3):
            cells[3 + k] = 9.8195 * cells[3 + k] * (1 + 1e-3 * k) + 0.01 + source.gauss(0, 2e-4)
        cells[6] += shift
        rows.append(",".join(repr(x) for x in cells))
    return "\n".join(rows) + "\n"


def Volts(source, sigma=1e-5, tilt=0.2):
    rows = []
    for axis in range(3):
        for sign in (1, -1):
            for q in range(4):
                lean = math.tan(math.radians(tilt))
                u = [0.0, 0.0, 0.0]
                u[axis] = sign
                u[(axis + 1) % 3] = lean * (1, 0, -1, 0)[q]
                u[(axis + 2) % 3] = -sign * lean * (0, 1, 0, -1)[q]
                length = math.sqrt(Dot(u, u))
                u = [x / length for x in u]
                for c in range(3):
                    for sample in range(3):
                        volt = VOLT[c] + Dot(PER_G[c], u) + source.gauss(0, sigma)
                        rows.append(["xyz"[axis], "up" if sign > 0 else "down", 90 * q, "xyz"[c],
                                     sample, volt])
    return Table("axis,dir,rot_deg,channel,sample,volt", rows)


def Toml(rows):
    return "[" + ", ".join("[" + ", ".join(repr(float(x)) for x in row) + "]" for row in rows) + "]"


def TrueTool():
    axes = 'axes = ["+y", "-x", "+z"]\n'
    return ('format = "wellgyro.tool/1"\n[gyro]\nchannels = [3, 4, 5, 6]\nunit = "deg/h"\n'
            'unit_per_count = [1e-4, 1e-4, 1e-4, 1e-4]\n' + axes
            + "bias = " + repr(B) + "\nsensitivity_per_deg_per_h = " + Toml(U)
            + "\ng_dependence_per_g = " + Toml(FORCE)
            + '\n[accel]\nchannels = [0, 1, 2]\nunit = "V"\nunit_per_count = [1e-7, 1e-7, 1e-7]\n'
            + axes + "bias = " + repr(VOLT)
            + "\nsensitivity_per_mps2 = " + Toml([[x / G for x in row] for row in PER_G]) + "\n")


class Calibrate(FreshProgramTest):
    def Done(self, *arguments):
        result = Run(*arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result

    def Survey(self, job, log, out, code=0):
        done = Run("survey", "--job", job, "--from", log, "--out", self.Path(out))
        self.assertEqual(done.returncode, code, done.stderr)
        return self.Rows(out, "survey.csv")

    def test_from_the_bench_to_the_survey(self):
        source = random.Random(5)
        tool = self.Path("tool.toml")
        self.Done("calibrate", "24-position", "--data", self.Write("volts.csv", Volts(source)),
                  "--settle-v", "1e-3", "--out", self.Path("accel.toml"), "--tool", tool,
                  "--channels", "0,1,2", "--unit-per-count", "1e-7", "--date", "2025-12-01",
                  "--expires", "2026-12-01", "--asset-serial", "A-7")
        self.Done("calibrate", "gyro-multi-position", "--data",
                  self.Write("rest.csv", AtRest(source)), "--rate-table",
                  self.Write("table.csv", OnTable(source)), "--latitude-deg", str(LATITUDE),
                  "--out", self.Path("gyro.toml"), "--tool", tool, "--channels", "3,4,5,6",
                  "--unit-per-count", "1e-4")
        for name in ("accel.toml", "gyro.toml", "tool.toml"):
            self.Done("check", self.Path(name))
        simulation = self.Write("simulation.toml", SIMULATION)
        true_tool = self.Write("true.toml", TrueTool())
        self.Done("simulate", "--job", simulation, "--out", self.Path("perfect.lcm"))
        self.Done("simulate", "--job", simulation, "--out", self.Path("raw.lcm"), "--tool",
                  true_tool)
        perfect = self.Survey(self.Write("perfect.toml", JOB), self.Path("perfect.lcm"), "perfect")
        job = self.Write("job.toml", JOB + '[tool]\nfile = "tool.toml"\n')
        rows = self.Survey(job, self.Path("raw.lcm"), "calibrated")
        self.assertEqual(len(rows), len(perfect))
        worst = 0
        for a, b in zip(rows[1:], perfect[1:]):
            turned = (float(a["AZI_TRUE[deg]"]) - float(b["AZI_TRUE[deg]"]) + 180) % 360 - 180
            worst = max(worst, abs(turned))
            self.assertLess(abs(turned), 3.5 * float(a["SIG_AZI[deg]"]))
            self.assertLess(float(a["SIG_AZI[deg]"]), 0.3)
            self.assertLess(float(a["SIG_INC[deg]"]), 0.02)
            self.assertLess(abs(float(a["INC[deg]"]) - float(b["INC[deg]"])),
                            3.5 * float(a["SIG_INC[deg]"]) + 1e-6)
            for axis, variance in (("N[m]", "VAR_NN[m2]"), ("E[m]", "VAR_EE[m2]")):
                self.assertLess(float(a[variance]), 0.5 ** 2)
                self.assertLess(abs(float(a[axis]) - float(b[axis])),
                                3.5 * math.sqrt(float(a[variance])) + 2e-4)
        checks = {row["CODE"]: row for row in self.Rows("calibrated", "checks.csv")}
        self.assertEqual(checks["calibration_date"]["VERDICT"], "pass")
        self.assertIn(checks["earth_rate_vertical"]["VERDICT"], ("pass", "warn"))
        self.assertGreater(worst, 0)
        self.assertLess(worst, 0.2)
        # Without what the bench found, the same counts are far away, and it is said.
        blank = self.Write("blank.toml", TrueTool().replace(repr(B), "[0.0, 0.0, 0.0, 0.0]"))
        far = self.Survey(self.Write("far.toml", JOB + f'[tool]\nfile = "{blank}"\n'),
                          self.Path("raw.lcm"), "far", code=4)
        turned = float(far[-1]["AZI_TRUE[deg]"]) - float(perfect[-1]["AZI_TRUE[deg]"])
        self.assertGreater(abs((turned + 180) % 360 - 180), 10 * worst)

    def test_what_a_run_taught_is_the_next_prior(self):
        source = random.Random(12)
        rest = self.Write("rest.csv", WholeTool(AtRest(source), source))
        table = self.Write("table.csv", OnTable(source))
        bench = ["calibrate", "tool", "--data", rest, "--data", table, "--latitude-deg",
                 str(LATITUDE), "--out", self.Path("c.toml")]
        tool = self.Path("tool.toml")
        counts = ["--channels", "0,1,2,3,4,5,6", "--unit-per-count", "1e-7,1e-7,1e-7" + 4 * ",1e-4"]
        self.Done(*bench, "--tool", tool, *counts)
        simulation = self.Write("simulation.toml", SIMULATION)
        # The tool as the bench has it, but for a bias of two of its sigmas.
        text = self.Read(tool)
        line = re.search(r"\[gyro\].*?\nbias = \[(.*?)\]", text, re.S)
        biases = [float(x) for x in line.group(1).split(",")]
        biases[0] += 0.02
        true = text[:line.start(1)] + ", ".join(map(repr, biases)) + text[line.end(1):]
        self.Done("simulate", "--job", simulation, "--out", self.Path("raw.lcm"), "--tool",
                  self.Write("true.toml", true))
        job = self.Write("job.toml", JOB + '[tool]\nfile = "tool.toml"\n')
        self.Survey(job, self.Path("raw.lcm"), "first")
        self.assertIn("[run.fit.lesson]", self.Read(self.Path("first/run.toml")))
        taught = self.Path("taught.toml")
        ran = self.Done("calibrate", "learn", "--run", self.Path("first"), "--out", taught)
        self.assertIn("runs that taught: 1", ran.stdout)
        self.Done("check", taught)
        self.assertIn("what runs found (1)", self.Read(taught))
        self.Survey(self.Write("second.toml", JOB + '[tool]\nfile = "taught.toml"\n'),
                    self.Path("raw.lcm"), "second")
        self.RunsTeachOnce(tool)
        # Of other tool files, of none, of what is no result.
        ran = Run("calibrate", "learn", "--run", self.Path("first"), "--run",
                  self.Path("second/run.toml"), "--out", self.Path("no.toml"))
        self.assertEqual(ran.returncode, 2)
        self.assertIn("another than the first run's", ran.stderr)
        self.assertEqual(Run("calibrate", "learn", "--run", tool, "--out",
                             self.Path("no.toml")).returncode, 2)
        # The next bench, with other noise, is joined with it; one of a tool that changed is not.
        again = self.Write("again.csv", WholeTool(AtRest(source), source))
        rates = self.Write("rates.csv", OnTable(source))
        later = ["calibrate", "tool", "--data", again, "--data", rates, "--latitude-deg",
                 str(LATITUDE), "--out", self.Path("c2.toml"), "--tool", self.Path("next.toml"),
                 *counts]
        self.CountedTwice(later, rest, table, taught)
        joined = self.Done(*later, "--prior", taught, "--certificate", self.Path("next.html"))
        self.assertIn("prior: chi-square", joined.stdout)
        of_samples = self.Read(self.Path("next.html")).split('<table class="b">')[1]
        self.assertIn("<th>prior (B)</th>", of_samples)
        self.assertEqual([data["role"] for data in self.Toml("c2.toml")["data"]],
                         ["data", "data", "prior"])
        self.assertIn("of the bench's readings alone", self.Read("c2.toml"))
        rests_on = self.Toml("next.toml")["rests_on"]
        self.assertEqual(len(rests_on), len(set(rests_on)))
        self.assertEqual(len(rests_on), 5)  # two benches of two tables, a run
        later[3] = self.Write("moved.csv", WholeTool(AtRest(source), source, 0.5))
        ran = Run(*later, "--prior", taught)
        self.assertEqual(ran.returncode, 2, ran.stdout)
        self.assertIn("the tool has changed", ran.stderr)

    def RunsTeachOnce(self, tool):
        """A run named twice, or copied, or solved with the tool file that it taught counts twice;
        nor does what was learnt take the place of what it was learnt from."""
        shutil.copytree(self.Path("first"), self.Path("copy"))
        out = ["--out", self.Path("no.toml")]
        for runs in (["first", "first"], ["first", "first/run.toml"], ["first", "copy"]):
            named = [word for run in runs for word in ("--run", self.Path(run))]
            ran = Run("calibrate", "learn", *named, *out)
            self.assertEqual(ran.returncode, 2, runs)
            self.assertIn("another run named: each counts once", ran.stderr)
        ran = Run("calibrate", "learn", "--run", self.Path("second"), *out)
        self.assertEqual(ran.returncode, 2, ran.stdout)
        self.assertIn("has learnt from the same samples before", ran.stderr)
        self.assertFalse(os.path.exists(self.Path("no.toml")))
        for path in (self.Path("first/run.toml"), self.Path("first/survey.csv"), tool):
            before = self.Bytes(path)
            ran = Run("calibrate", "learn", "--run", self.Path("first"), "--out", path)
            self.assertEqual(ran.returncode, 1, path)
            self.assertIn("choose another", ran.stderr)
            self.assertEqual(self.Bytes(path), before)

    def CountedTwice(self, later, rest, table, taught):
        """A bench joined with what rests on it: by its bytes, and by numbers that agree too well
        where somebody wrote them anew."""
        same = [*later, "--prior", taught]
        same[3] = rest
        ran = Run(*same)
        self.assertEqual(ran.returncode, 2, ran.stdout)
        self.assertIn(f"rests on the readings of {rest} too", ran.stderr)
        same[3] = self.Write("rest_anew.csv", "# anew\n" + self.Read(rest))
        same[5] = self.Write("table_anew.csv", "# anew\n" + self.Read(table))
        ran = Run(*same)
        self.assertEqual(ran.returncode, 2, ran.stdout)
        self.assertIn("it agrees with the bench better than other readings can", ran.stderr)

    def test_the_file_says_which_readings_were_joined(self):
        source = random.Random(10)
        rest, table = self.Write("rest.csv", AtRest(source)), self.Write("t.csv", OnTable(source))
        out = self.Path("gyro.toml")
        for method, data, option, joined in (
                ("gyro-multi-position", rest, "--rate-table", table),
                ("gyro-rate-table", table, "--multi-position", rest)):
            self.Done("calibrate", method, "--data", data, option, joined, "--latitude-deg",
                      str(LATITUDE), "--out", out)
            with open(out) as file:
                self.assertIn(f'role = "{option[2:].replace("-", "_")}"\nfile = "{joined}"',
                              file.read())

    def BudgetAddsUp(self, html):
        """u^2 is the sum of the sources' squares, to the digits that the page has."""
        self.assertNotIn("A, B", html)
        self.assertNotIn("level-deg (B)", html)
        tables = re.findall(r'<table class="b">(.*?)</table>', html, re.S)
        self.assertEqual(len(tables), 3)
        for table in tables:
            head, *rows = re.findall(r"<tr>(.*?)</tr>", table, re.S)
            names = re.findall(r"<th>(.*?)</th>", head)
            self.assertEqual(names[2], "readings (A)")
            for name in ("level (B)", "north (B)", "seat (B)", "latitude (B)"):
                self.assertIn(name, names)
            for row in rows:
                cells = re.findall(r"<td>(.*?)</td>", row)
                self.assertEqual(len(cells), len(names), row)
                parts = [float(x) for x in cells[2:-4]]
                self.assertAlmostEqual(sum(x * x for x in parts) ** 0.5 / float(cells[-4]), 1,
                                       delta=0.06, msg=row)
                self.assertAlmostEqual(float(cells[-2]), 2, delta=0.3, msg=row)
        self.assertIn("gyro_bias_x", tables[0])
        self.assertIn("gyro_M[0]", tables[1])
        self.assertIn("level_1[0]", tables[2])

    def test_a_whole_tool_is_adjusted_certified_and_verified(self):
        source = random.Random(11)
        rest = self.Write("rest.csv", WholeTool(AtRest(source), source))
        found = self.Write("found.csv", WholeTool(AtRest(source), source))
        table = self.Write("table.csv", OnTable(source))
        tool, page = self.Path("tool.toml"), self.Path("tool.html")
        ran = self.Done("calibrate", "tool", "--data", rest, "--data", table, "--latitude-deg",
                        str(LATITUDE), "--gravity-mps2", "9.8195", "--out", self.Path("c.toml"),
                        "--tool", tool, "--certificate", page, "--traceability",
                        "rate table <RT-5>", "--certificate-number", "C-17", "--laboratory",
                        "Bench 2", "--asset-serial", "A&7", "--date", "2026-01-31")
        adjusted = ran.stdout
        self.assertIn("gyro_M[0]", adjusted + self.Read(self.Path("c.toml")))
        for name in (tool, self.Path("c.toml")):
            self.Done("check", name)
        html = self.Read(page)
        for word in ("A&amp;7", "rate table &lt;RT-5&gt;", "gyro_bias_x", "mass_unbalance", "<svg",
                     "level_1[0]", "k = 2", "C-17", "Bench 2", "deg/h/g</td>"):
            self.assertIn(word, html)
        # What was known of the bench before, stated or not, on paper and in the file.
        for word in ("gravity-mps2 9.8195 (stated)", "level-deg 0.5 (1 sigma, default)",
                     "seat-arcsec 60 (1 sigma, default)",
                     "rate-scale-ppm 290 (1 sigma, default)", "sigma-accel found from the readings",
                     "max-degree 3 (default)"):
            self.assertIn(f"<li>{word}</li>", html)
            self.assertIn(word, self.Toml("c.toml")["references"])
        self.assertIn("<td>reading per m/s2</td><td>budget</td>", html)
        self.BudgetAddsUp(html)
        self.assertNotRegex(html, r"<td>[0-9.]+e\+[0-9]+</td>")
        self.NothingHalfWritten(rest, table)
        # What it certifies, to the byte; each term left out once.
        for name in (tool, self.Path("c.toml")):
            with open(name, "rb") as file:
                self.assertIn(hashlib.sha256(file.read()).hexdigest(), html)
        self.assertEqual(html.count("accel_K2_cross"), 1)
        self.assertLess(html.index("<h2>Bench</h2>"), html.index("gyro_drift_1"))
        verify = ["calibrate", "verify", "--tool", tool, "--latitude-deg", str(LATITUDE),
                  "--gravity-mps2", "9.8195", "--sigma-accel", "2e-4", "--sigma-deg-per-h", "0.02"]
        self.assertIn("pass", self.Done(*verify, "--data", found).stdout)
        ran = Run(*verify, "--data", table)
        self.assertEqual(ran.returncode, 2, ran.stdout)
        self.assertIn("it is a rate table: verify takes positions", ran.stderr)
        # Time goes as the number of rows: a long table takes a second.
        rows = "".join(WholeTool(AtRest(source), source).split("\n", 1)[1] for _ in range(20))
        many = self.Write("many.csv", self.Read(found).splitlines()[0] + "\n" + rows)
        self.assertIn("pass", Run(*verify, "--data", many, timeout=20).stdout)
        moved = self.Write("moved.csv", WholeTool(AtRest(source), source, 0.3))
        ran = Run(*verify, "--data", moved)
        self.assertEqual(ran.returncode, 4, ran.stdout)
        self.assertIn("gyro_b[0]", ran.stdout)
        self.assertIn("shifted", ran.stdout)
        # A prior of another tool; one calibration, which knows of no change.
        ran = Run("calibrate", "tool", "--data", moved, "--data", table, "--latitude-deg",
                  str(LATITUDE), "--out", self.Path("other.toml"), "--tool",
                  self.Path("other_tool.toml"), "--asset-serial", "B", "--prior", tool)
        self.assertEqual(ran.returncode, 2, ran.stdout)
        self.assertIn("it is of tool A&7, and this bench of B", ran.stderr)
        row = next(x for x in self.Done("calibrate", "history", "--tool", tool).stdout.splitlines()
                   if "gyro_bias_y" in x).split(",")
        self.assertEqual(row[3:], ["1", "", "", "", "", "one calibration: no change is known"])
        self.assertIn("sigma_gyro_deg_per_h", html)
        self.assertIn("sigma_gyro_deg_per_h = 0.0", adjusted)
        later = self.Path("later.toml")
        self.Done("calibrate", "tool", "--data", moved, "--data", table, "--latitude-deg",
                  str(LATITUDE), "--gravity-mps2", "9.8195", "--out", self.Path("c2.toml"),
                  "--tool", later, "--asset-serial", "A&7", "--date", "2026-07-31")
        ran = self.Done("calibrate", "history", "--tool", tool, "--tool", later)
        self.assertIn("shifted", "".join(x for x in ran.stdout.splitlines() if "gyro_bias_y" in x))
        self.assertIn("1 tool with two calibrations", ran.stderr)
        self.assertIn("last_change[unit]", ran.stdout)
        row = next(x for x in ran.stdout.splitlines() if "gyro_bias_y" in x).split(",")
        self.assertEqual(row[2], "deg/h")
        self.assertAlmostEqual(abs(float(row[4])), 0.15, delta=0.05)  # of one of two gyros
        # A file that is unusable is not the command line's fault; no heading before the complaint.
        undated = self.Write("undated.toml", re.sub(r'calibrated = ".*"\n', "", self.Read(tool)))
        for files in ([undated], [self.Write("blank.toml", TrueTool())], [tool, tool]):
            ran = Run("calibrate", "history", "--tool", *files)
            self.assertEqual((ran.returncode, ran.stdout), (2, ""), ran.stderr)
        self.Done("calibrate", "plan", "--bench-latitude-deg", "52", "--latitude-deg", "60",
                  "--azimuth-sigma-deg", "0.05", "--out", self.Path("plan.csv"))
        self.assertTrue(self.Read(self.Path("plan.csv")).startswith("inc,az,tf,tau\n"))
        # Clockwise through north, and a sigma that no plan reaches.
        plan = ["calibrate", "plan", "--bench-latitude-deg", "52", "--latitude-deg", "60",
                "--inclination-deg", "20", "60", "--out", self.Path("plan.csv")]
        north = self.Done(*plan, "--azimuth-deg", "350", "10").stdout
        self.assertEqual(north, self.Done(*plan, "--azimuth-deg", "-10", "10").stdout)
        ran = Run(*plan, "--azimuth-sigma-deg", "1e-5")
        self.assertEqual(ran.returncode, 4, ran.stderr)
        self.assertIn("do not reach", ran.stderr)
        # For a well as good as the plain bench by half its settings, and near the bound.
        planned = self.Write("planned.csv", "MD[m],INC[deg],AZI_TRUE[deg]\n" + "".join(
            f"{30 * i},{min(3 * i, 60)},70\n" for i in range(40)))
        ran = self.Done("calibrate", "plan", "--bench-latitude-deg", "52", "--latitude-deg", "60",
                        "--well", planned, "--out", self.Path("plan.csv"))
        settings = len(self.Read(self.Path("plan.csv")).splitlines()) - 1
        self.assertLessEqual(settings, 67)
        bound = float(ran.stdout.split("in less than ")[1].split()[0])
        self.assertTrue(0.85 * settings < bound <= settings, ran.stdout)
        for arguments in (["tool", "--data", rest, "--out", rest],
                          ["verify", "--data", rest, "--tool", tool]):
            self.assertEqual(Run("calibrate", *arguments).returncode, 1, arguments)

    def NothingHalfWritten(self, rest, table):
        """Where one output cannot be made none is, whichever it is."""
        blocked = self.Path(self.Write("file", ""), "t.toml")
        names = [self.Path(name) for name in ("half.toml", "half-tool.toml", "half.html")]
        for place in range(3):
            files = [blocked if k == place else name for k, name in enumerate(names)]
            ran = Run("calibrate", "tool", "--data", rest, "--data", table, "--latitude-deg",
                      str(LATITUDE), "--gravity-mps2", "9.8195", "--out", files[0], "--tool",
                      files[1], "--certificate", files[2])
            self.assertEqual(ran.returncode, 2, ran.stdout)
            self.assertFalse([name for name in names if os.path.exists(name)], ran.stderr)
        ran = Run("calibrate", "tool", "--data", rest, "--out", names[0], "--traceability", "RT-5")
        self.assertEqual(ran.returncode, 1)
        self.assertIn("--traceability requires --certificate", ran.stderr)

    def test_readme_shows_what_the_demonstration_gives(self):
        out = self.Path("accel.toml")
        result = self.Done("calibrate", "six-position", "--data",
                           os.path.join(DEMO, "bench.csv"), "--gravity-mps2",
                           "9.81234", "--out", out)
        self.assertIn(result.stdout.replace(out, "accel.toml"), self.Read(TOP, "README.md"))

    def Refused(self, method, text, words, *options, code=2):
        data = self.Write("data.csv", text)
        out = self.Path("out.toml")
        result = Run("calibrate", method, "--data", data, "--out", out, *options)
        self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        for word in [words] if isinstance(words, str) else words:
            self.assertIn(word, result.stderr)
        self.assertFalse(os.path.exists(out))
        return result

    def test_files_that_are_no_bench(self):
        source = random.Random(6)
        volts = Volts(source)
        for text, word in (("", "header"), ("\n\n# nothing\n", "header"),
                           ("axis,dir,rot_deg,channel,volt\n", "no readings"),
                           (b"\x00\xff\xfe\x01" * 50, ""), ("a" * 100000, ""),
                           (volts.replace("volt", "mV"), "no column volt"),
                           (volts.replace(",up,", ",sideways,", 1), ":2:3: \"sideways\""),
                           (volts.replace("\n", ",7\n", 3).replace(",7\n", "\n", 1), ":2:1: 7 cells"),
                           ("axis,axis,dir,rot_deg,channel,volt\nx,x,up,0,x,3\n", "twice")):
            with self.subTest(word=word, begin=text[:30]):
                self.Refused("24-position", text, word)
        self.Refused("24-position", volts.rsplit("\n", 2)[0] + "\nz,down,270", ":217:1: 3 cells")

    def test_numbers_that_are_none(self):
        head = "t_m,ref1\n"
        rows = "".join(f"{t},{t + 0.5}\n" for t in range(20, 160, 10))
        for cell in ("nan", "inf", "-inf", "1e999", "0x10", "1,5", "--3", "", "1e", "twelve"):
            with self.subTest(cell=cell):
                self.Refused("thermometer", head + rows + f"170,{cell}\n", ":16:")
        # Two hundred digits are a number; so are other ends of lines, blanks and a mark at the front.
        long = "170." + "0" * 200
        for text in (head + rows + f"{long},170.5\n", (head + rows).replace("\n", "\r\n"),
                     head.replace(",", " , ") + rows, "\ufeff" + head + rows,
                     head.replace(",", ";") + rows.replace(",", ";")):
            self.Done("calibrate", "thermometer", "--data", self.Write("d.csv", text), "--out",
                      self.Path("c.toml"))
        self.Refused("thermometer", head + rows + "1e300,1e300\n", "")

    def test_command_lines_that_are_wrong(self):
        volts = Volts(random.Random(7))
        tool = self.Path("t.toml")
        for options, word in (
                ("--gravity-g 0", "0 is no number from 0.97"),
                ("--gravity-g -1", "-1 is no number from 0.97"),
                ("--gravity-g nan", "nan is no number from 0.97"),
                ("--gravity-g 1 --gravity-mps2 9.81", "excludes"),
                ("--gravity-mps2 98", "98 is no number from 9.5"), ("--sigma-v 0", "--sigma-v: 0"),
                ("--sigma-v -1", "--sigma-v: -1"), ("--settle-v -1", "--settle-v: -1"),
                ("--max-degree 9", "--max-degree: Value 9"),
                ("--max-degree -1", "--max-degree: Value -1"), ("--bench-axes left", "left"),
                (f"--tool {tool} --channels 1,1,2", "channel 1 is named twice"),
                (f"--tool {tool} --channels 1,2", "--channels names 2"),
                (f"--tool {tool} --channels 1,2,99", "channel 99 is outside"),
                (f"--tool {tool} --axes +x,+x,+z", "--axes takes three axes"),
                (f"--tool {tool} --unit-per-count 0", "unit_per_count of channel 0 is 0"),
                (f"--tool {tool} --date 2026-13-01", "--date: \"2026-13-01\" is no date"),
                (f"--tool {tool} --date 2026-06-01 --expires 2026-01-01", "--expires must come"),
                (f"--tool {tool} --thermometer -1", "--thermometer: Value -1"),
                ("--channels 1,2,3", "--channels requires --tool"), ("--volume 11", "--volume")):
            with self.subTest(options=options):
                settle = [] if "--settle-v" in options else ["--settle-v", "1e-3"]
                self.Refused("24-position", volts, word, *settle, *options.split(), code=1)
                self.assertFalse(os.path.exists(tool))
        self.assertEqual(Run("calibrate").returncode, 1)
        self.assertEqual(Run("calibrate", "guess").returncode, 1)
        with open(os.path.join(DEMO, "bench.csv"), encoding="utf-8") as bench:
            self.Refused("six-position", bench.read(), "the tilt's sigma needs that of the pulses",
                         "--gravity-mps2", "9.81234", "--tilt-arcsec", "20", code=1)
        rest = AtRest(random.Random(8))
        for latitude in ("95", "-91", "nan"):
            self.Refused("gyro-multi-position", rest, "latitude", "--latitude-deg", latitude, code=1)
        self.Refused("gyro-multi-position", rest, "latitude", code=1)
        missing = Run("calibrate", "scalar", "--data", self.Path("none.csv"), "--out",
                      self.Path("c.toml"))
        self.assertEqual(missing.returncode, 2)
        self.assertIn("none.csv", missing.stderr)

    def test_a_place_that_cannot_be_written_is_told_before_the_fit(self):
        # Readings that no fit can use: what is said of them would come first.
        rest = self.Write("rest.csv", "inc,az,tf,fx,fy,fz\n0,0,0,0,0,1\n")
        out, page = self.Path("c.toml"), self.Path("c.html")
        below = os.path.join(self.Write("file", ""), "x")
        for places in (("--out", below), ("--out", out, "--tool", below),
                       ("--out", out, "--certificate", below),
                       ("--out", out, "--certificate", page, "--pdf", below)):
            with self.subTest(places=places):
                done = Run("calibrate", "tool", "--data", rest, *places)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn(os.path.dirname(below), done.stderr)
                self.assertNotIn("rest.csv", done.stderr)
                self.assertFalse(os.path.exists(out) or os.path.exists(page))
        done = Run("calibrate", "tool", "--data", rest, "--out", out, "--certificate", page, "--pdf",
                   self.Path("c.pdf"), env={"PATH": ""})
        self.assertEqual(done.returncode, 2)
        self.assertIn("no Chromium in PATH", done.stderr)

    def test_affine_says_what_the_readings_and_options_do_not_tell(self):
        draw, rows = random.Random(11), []
        for inc, az, tf in itertools.product((0, 45, 90, 135, 180), (0, 120), (0, 70, 150, 240)):
            gravity = [g + draw.gauss(0, 1e-5) for g in Level(0, 1, inc, az, tf)]
            rows.append([inc, az, tf, *gravity, *(draw.gauss(0, 1) for _ in range(3))])
        table = self.Write("a.csv", Table("inc,az,tf,Gx,Gy,Gz,Mx,My,Mz", rows))
        data = ["calibrate", "affine", "--data", table, "--out", self.Path("affine.toml")]
        done = Run(*data, "--gravity-mps2", "9.81")
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        self.assertIn("they are in g; give --gravity-g", done.stderr)
        done = Run(*data, "--gravity-g", "1")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("--field-nt, --dip-deg", done.stdout + done.stderr)

    def test_nothing_is_written_over_what_it_came_from(self):
        data = self.Write("d.csv", Volts(random.Random(9)))
        for options in (["--out", data], ["--out", self.Path("c.toml"), "--tool", data],
                        ["--out", self.Path("c.toml"), "--tool", self.Path("c.toml")]):
            result = Run("calibrate", "24-position", "--data", data, "--settle-v", "1e-3", *options)
            self.assertEqual(result.returncode, 1, options)
            self.assertIn("must be different files", result.stderr)
        self.assertTrue(self.Read(data).startswith("axis,"))
        well = self.Write("well.csv", "MD[m],INC[deg],AZI_TRUE[deg]\n0,0,0\n100,30,40\n")
        result = Run("calibrate", "plan", "--bench-latitude-deg", "52", "--latitude-deg", "60",
                     "--well", well, "--out", well)
        self.assertEqual(result.returncode, 1, result.stderr)


if __name__ == "__main__":
    unittest.main()
