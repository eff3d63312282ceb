"""The report of a survey, in a browser and on paper: it asks nothing of a network, says what the
files say, shows any name as text, and can be read.
report_test.py PROGRAM [--redraw] [--demo FOLDER]
--redraw keeps the picture of the plan as the one to compare with; --demo: the demonstration's survey
with its report, made where it is not given"""
import gzip
import hashlib
import json
import math
import os
import re
import shutil
import subprocess
import sys
import unittest

import browser
from harness import DEMO, Job, Limit, Move, ProgramTest, Run, Simulation, Stop

REDRAW = "--redraw" in sys.argv
if REDRAW:
    sys.argv.remove("--redraw")
MADE = sys.argv[sys.argv.index("--demo") + 1] if "--demo" in sys.argv else None
if MADE:
    del sys.argv[-2:]
KEPT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "report_plan.pgm.gz")
STREAMS = "imu_hz = 10.0\ndepth_hz = 2.0\n"
TOOL = "accel_noise_mps2_per_sqrt_hz = 2e-4\n"
JOB = Job(25.0).replace("accel_noise_mps2_per_sqrt_hz = 0", "accel_noise_mps2_per_sqrt_hz = 2e-4")
THERE = Stop(120) + Move(200) + Stop(120)
LISTING = """Array.from(document.querySelectorAll('table.listing tbody tr')).map(
    r => Array.from(r.cells).map(c => c.textContent))"""


@unittest.skipUnless(browser.PROGRAM, "no Chromium on this machine")
class Report(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.browser = browser.Browser()
        cls.addClassCleanup(cls.browser.Close)
        if MADE:
            shutil.copytree(MADE, cls.Path("demo"))
        else:
            cls.Make("survey", "--job", os.path.join(DEMO, "job.toml"), "--from",
                     os.path.join(DEMO, "run.lcm"), "--out", cls.Path("demo"), "--report")

    def Survey(self, name, steps, *, faults="", job=JOB):
        simulation = self.Write(name + ".toml",
                                Simulation(steps, STREAMS, end_md_m=250.0, tool=TOOL) + faults)
        self.Make("simulate", "--job", simulation, "--out", self.Path(name + ".lcm"))
        return Run("survey", "--job", self.Write(name + ".job.toml", job), "--from",
                   self.Path(name + ".lcm"), "--out", self.Path(name))

    def Copy(self, name, **changed):
        """The demonstration's result with the text of some files changed, and run.toml by them."""
        shutil.copytree(self.Path("demo"), self.Path(name), dirs_exist_ok=True)
        for file, change in changed.items():
            path = file.replace("_", ".")
            before = self.Read(name, path)
            self.Write(os.path.join(name, path), change(before))
            hashes = [hashlib.sha256(text.encode()).hexdigest()
                      for text in (before, self.Read(name, path))]
            self.Write(os.path.join(name, "run.toml"), self.Read(name, "run.toml").replace(*hashes))
        return self.Path(name)

    def Page(self, name, *options, **of_page):
        page_file = self.Path(name + ".html")
        done = Run("report", self.Path(name), "--out", page_file, *options)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        page = browser.Page(self.browser, **of_page)
        page.Open(page_file)
        return page

    def SameNumbers(self, page, name):
        """The listing, and the document in the page, against survey.csv."""
        rows = self.Rows(name, "survey.csv")
        listed = page.Ask(LISTING)
        self.assertEqual(len(listed), len(rows))
        grid = "AZI_GRID[deg]" in rows[0]
        shown = [("MD[m]", 2), ("INC[deg]", 3), ("AZI_TRUE[deg]", 3)]
        shown += [("AZI_GRID[deg]", 3)] if grid else []
        shown += [("TVD[m]", 2), ("N[m]", 2), ("E[m]", 2)]
        shown += [("NORTHING[m]", 2), ("EASTING[m]", 2)] if grid else []
        shown += [("DLS[deg/30m]", 2), ("SIG_INC[deg]", 3), ("SIG_AZI[deg]", 3)]
        document = json.loads(page.Ask("document.getElementById('survey').textContent"))
        self.assertEqual(document["stations"]["columns"], list(rows[0]))
        for cells, row, exact in zip(listed, rows, document["stations"]["rows"], strict=True):
            for cell, (column, decimals) in zip(cells, shown, strict=False):
                if row[column] == "":
                    self.assertEqual(cell, "\u2013")
                else:
                    self.assertLessEqual(abs(float(cell) - float(row[column])),
                                         0.5001 * 10 ** -decimals, (column, row["MD[m]"]))
            for value, text in zip(exact, row.values(), strict=True):
                self.assertEqual(value, None if text == "" else text if isinstance(value, str)
                                 else float(text))

    def Quiet(self, page):
        self.assertEqual((page.requests, page.errors), ([], []))
        charts = page.Ask("""Array.from(document.querySelectorAll('figure.chart')).filter(
            f => !f.textContent.includes('not measured')).length""")
        self.assertEqual(page.Ask("document.documentElement.dataset.drawn"), str(charts))

    def test_of_the_demonstration(self):
        page = self.Page("demo")
        self.Quiet(page)
        self.SameNumbers(page, "demo")
        self.assertEqual(page.Ask("document.querySelectorAll('section[id^=block]').length"), 9)
        self.assertIn("Verdict: pass", page.Ask("document.querySelector('.verdict').textContent"))
        self.assertEqual(self.Bytes("demo", "report.html"), self.Bytes("demo.html"))
        document = json.loads(self.Read("demo", "survey.json"))
        self.assertEqual(document["format"], "wellgyro.survey/1")

    def test_of_a_run_that_fails(self):
        done = self.Survey("dead", THERE, faults='[[fault]]\ncause = "gyro_dead"\naxis = "x"\n')
        self.assertEqual(done.returncode, 4, done.stderr)
        page = self.Page("dead")
        self.Quiet(page)
        self.SameNumbers(page, "dead")
        said = page.Ask("document.querySelector('.verdict').textContent")
        self.assertIn("a gyro axis does not answer", said)
        self.assertIn("Not to be handed over", said)
        self.assertEqual(page.Ask("document.querySelector('main').firstElementChild.className"),
                         "verdict fail")

    def test_of_two_runs(self):
        half = 1_767_225_600_000_000 + 440_000_000  # of the simulation's time
        job = JOB + f"[[run]]\nnumber = 1\nend_utime_us = {half}\n" \
                    f"[[run]]\nnumber = 2\nbegin_utime_us = {half}\n"
        done = self.Survey("two", THERE + Stop(120) + Move(50) + Stop(120), job=job)
        self.assertIn(done.returncode, (0, 3, 4), done.stderr)
        page = self.Page("two")
        self.Quiet(page)
        self.SameNumbers(page, "two")
        self.assertEqual(len(self.Toml("two", "run.toml")["run"]),
                         page.Ask("document.querySelectorAll('table.samples tbody tr').length"))

    def test_of_a_stream_that_ended(self):
        ended = self.Copy("ended", source_toml=lambda text: text.replace(
            "name =", 'ended = "the bus was lost"\nname =', 1))
        self.assertTrue(os.path.isdir(ended))
        page = self.Page("ended")
        self.Quiet(page)
        self.assertIn("the bus was lost", page.Ask("document.querySelector('.verdict').textContent"))

    def test_the_run_along_time(self):
        page = self.Page("demo")
        rows = self.Rows("demo", "stretches.csv")
        charts = {chart["id"]: chart for chart in json.loads(
            page.Ask("document.getElementById('charts').textContent"))["charts"]}
        for chart, *columns in (("residuals", "RES_GYRO", "RES_ACCEL"), ("speed", "SPEED[m/s]"),
                                ("rotation", "ROTATION[rpm]"), ("temperature", "TEMPERATURE[degC]")):
            drawn = charts["run-1-" + chart]["series"]
            for series, column in zip(drawn, columns, strict=True):
                for x, y, row in zip(series["x"], series["y"], rows, strict=True):
                    self.assertAlmostEqual(x, float(row["T[s]"]) / 3600, delta=1e-5)
                    if row[column]:
                        self.assertAlmostEqual(y, float(row[column]), delta=1e-4)
                    else:
                        self.assertIsNone(y)
        self.assertNotIn("run-1-lost", charts)
        # On the way in and on the way out.
        page.Ask("document.getElementById('growth').dispatchEvent("
                 "new KeyboardEvent('keydown', {key: 'ArrowRight'}))")
        self.assertEqual(page.Ask("document.querySelectorAll('#run-1-speed .here').length"), 2)

    def test_a_plan_beside_what_came_of_it(self):
        plan = self.Write("plan.toml", """format = "wellgyro.plan/1"
feasible = true
[limits]
ellipse_m = 99.0
[expected]
ellipse_major_m = 12.5
[time]
at_rest_s = 1000
""" + "".join(f'[[stop]]\npass = "{way}"\nmd_m = {md}\nstop_s = {seconds}\nellipse_without_m = 20\n'
              for way, md, seconds in (("in", 897, 200), ("in", 1500, 60), ("in", 2200, 180),
                                       ("out", 1500, 180))))
        page = self.Page("demo", "--plan", plan)
        self.Quiet(page)
        rows = page.Ask("""Array.from(document.querySelectorAll('table.planned-stops tbody tr')).map(
            r => Array.from(r.cells).map(c => c.textContent))""")
        self.assertEqual([(row[0], row[1], row[2], row[5], row[7]) for row in rows],
                         [("in", "897.0", "200", "900.2", "made"), ("in", "1500.0", "60", "\u2013", "not made"),
                          ("in", "2200.0", "180", "2200.2", "made"),
                          ("out", "1500.0", "180", "1500.2", "made")])
        kept = page.Ask("document.querySelector('table.kept').textContent")
        for number in ("99.00", "12.50", "1000"):
            self.assertIn(number, kept)
        self.assertEqual(json.loads(page.Ask("document.getElementById('survey').textContent"))
                         ["plan"]["limits"], {"ellipse_m": 99.0})
        for text, complaint in (("format = 3", "not wellgyro.plan/1"), ("=", "odd-plan.toml:1")):
            done = Run("report", self.Path("demo"), "--out", self.Path("none.html"), "--plan",
                       self.Write("odd-plan.toml", text))
            self.assertEqual(done.returncode, 2)
            self.assertIn(complaint, done.stderr)

    def test_a_difference_between_in_and_out_is_marked_where_it_is(self):
        def Plant(text):
            lines = text.split("\n")
            at = next(i for i, line in enumerate(lines)
                      if line.startswith("1,out,") and line.split(",")[4] == "2000.0000")
            cells = lines[at].split(",")
            cells[5] = f"{float(cells[5]) + 0.4:.6f}"
            return "\n".join([*lines[:at], ",".join(cells), *lines[at + 1:]])

        rows = """Array.from(document.querySelectorAll('table.beyond tbody tr')).map(
            r => Array.from(r.cells).map(c => c.textContent))"""
        self.assertNotIn("2000.00", [row[1] for row in self.Page("demo").Ask(rows)])
        self.Copy("planted", passes_csv=Plant)
        page = self.Page("planted")
        marked = [row for row in page.Ask(rows) if row[0] == "inclination"]
        self.assertEqual([row[1] for row in marked], ["2000.00"])
        self.assertAlmostEqual(abs(float(marked[0][3])), 0.4, delta=0.02)
        flags = page.Ask("document.querySelectorAll('#run-1-out-inclination circle[r=\"6\"]').length")
        self.assertEqual(flags, 1)

    def test_any_name_is_shown_as_text(self):
        def Rename(text):
            for name in browser.HOSTILE:
                key, value = (json.dumps(text_of, ensure_ascii=False)
                              for text_of in ("key " + name[:30], name))
                text = text.replace("[identity]\n", f"[identity]\n{key} = {value}\n", 1)
            return text.replace('name = "ISCWSA 2"', "name = " + json.dumps(browser.HOSTILE[0]), 1)

        self.Copy("hostile", run_toml=Rename)
        page = self.Page("hostile")
        self.Quiet(page)
        self.assertEqual(page.Ask("document.querySelector('h1 bdi').textContent"), browser.HOSTILE[0])
        shown = page.Ask("Array.from(document.querySelectorAll('.facts dd bdi')).map(e => e.textContent)")
        for name in browser.HOSTILE:
            self.assertIn(name, shown)
        self.assertEqual(page.Ask("document.querySelectorAll('main script, main img, main b').length"), 0)
        self.assertEqual(page.Ask("document.scripts.length"), 5)
        self.assertLessEqual(page.Ask("document.documentElement.scrollWidth"), 1280)

    def test_a_thousand_stations(self):
        def Longer(text):
            head, *rows = text.rstrip("\n").split("\n")
            first = head.split(",").index("MD[m]")
            longer = [head]
            for k in range(3):
                for row in rows:
                    cells = row.split(",")
                    cells[first] = f"{float(cells[first]) + 4000 * k:.4f}"
                    longer.append(",".join(cells))
            return "\n".join(longer[:1001] if first == 0 else longer) + "\n"

        self.Copy("long", survey_csv=Longer, passes_csv=Longer)
        page = self.Page("long")
        self.Quiet(page)
        self.SameNumbers(page, "long")
        size = os.path.getsize(self.Path("long.html"))
        took = page.Ask("performance.timing.loadEventEnd - performance.timing.navigationStart")
        print(f"1000 stations: {size / 1e6:.2f} MB, drawn in {took / 1e3:.2f} s")
        self.assertLess(size, 5e6)
        self.assertLess(took, Limit(2000, 20000))

    def test_can_be_read_without_scripts(self):
        page = self.Page("demo", scripts=False)
        root = page.Do("DOM.getDocument")["root"]["nodeId"]
        count = lambda what: len(page.Do("DOM.querySelectorAll", nodeId=root, selector=what)["nodeIds"])
        self.assertGreaterEqual(count("figure.chart svg"), 8)
        self.assertEqual(count("figure.chart svg"), count("figure.chart"))
        self.assertEqual(count("table.listing tbody tr"), len(self.Rows("demo", "survey.csv")))
        self.assertEqual((page.requests, page.errors), ([], []))

    def test_can_be_read_by_everyone(self):
        page = self.Page("demo")
        self.assertEqual(page.Ask(browser.FAINT), [])
        for width in (1280, 390):
            page = self.Page("demo", width=width)
            self.assertLessEqual(page.Ask("document.documentElement.scrollWidth"), width)

    def test_one_cursor_goes_through_all_charts(self):
        page = self.Page("demo")
        page.Ask("document.getElementById('growth').dispatchEvent("
                 "new KeyboardEvent('keydown', {key: 'ArrowRight'}))")
        self.assertIn("MD 10.00 m", page.Ask("document.getElementById('readout').textContent"))
        self.assertGreaterEqual(page.Ask(
            "document.querySelectorAll('.cursor[visibility=visible], .here').length"), 8)

    def test_in_feet(self):
        page = self.Page("demo", "--units", "field", "--paper", "letter")
        rows = self.Rows("demo", "survey.csv")
        for cells, row in zip(page.Ask(LISTING), rows, strict=True):
            self.assertAlmostEqual(float(cells[0]), float(row["MD[m]"]) / 0.3048, delta=0.0051)

    def test_another_well_is_drawn_beside(self):
        other = self.Write("other.csv", "MD[m],INC[deg],AZI[deg]\n0,0,0\n500,10,200\n1000,20,210\n")
        page = self.Page("demo", "--other", other)
        self.assertIn("other", page.Ask("document.getElementById('plan').textContent"))
        self.Quiet(page)

    def test_files_that_are_not_those_of_the_run_are_refused(self):
        self.Copy("altered")
        for name in ("survey.csv", "checks.csv"):
            whole = self.Read("altered", name)
            self.Write(os.path.join("altered", name), whole.replace("7", "8", 1))
            done = Run("report", self.Path("altered"), "--out", self.Path("altered.html"))
            self.assertEqual(done.returncode, 2)
            self.assertIn(name + " is not the file", done.stderr.replace(":", ""))
            self.Write(os.path.join("altered", name), whole)
        for name in ("survey.csv", "survey.json"):
            done = Run("report", self.Path("altered"), "--out", self.Path("altered", name))
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertIn("written over", done.stderr)

    def test_what_is_no_result_is_refused(self):
        os.makedirs(self.Path("empty"), exist_ok=True)
        done = Run("report", self.Path("empty"), "--out", self.Path("none.html"))
        self.assertEqual(done.returncode, 2)
        self.assertFalse(os.path.exists(self.Path("none.html")))
        self.Copy("torn", passes_csv=lambda text: text[:text.rindex(",")])
        done = Run("report", self.Path("torn"), "--out", self.Path("none.html"))
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, r"passes.csv:761: \d+ fields where the header has \d+")
        self.Copy("foreign", run_toml=lambda text: text.replace("wellgyro.run/1", "other/1"))
        done = Run("report", self.Path("foreign"), "--out", self.Path("none.html"))
        self.assertEqual(done.returncode, 2)
        self.assertIn("run.toml", done.stderr)

    @unittest.skipUnless(shutil.which("pdftotext"), "no poppler-utils on this machine")
    def test_on_paper(self):
        for paper, width, height in (("a4", 595, 842), ("letter", 612, 792)):
            pdf = self.Path(paper + ".pdf")
            done = Run("report", self.Path("demo"), "--out", self.Path("paper.html"), "--pdf", pdf,
                       "--paper", paper)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            boxes = subprocess.run(["pdftotext", "-bbox", pdf, "-"], capture_output=True, text=True,
                                   check=True).stdout
            pages = re.split(r"<page ", boxes)[1:]
            self.assertGreater(len(pages), 5)
            for page in pages:
                size = [float(v) for v in re.findall(r'(?:width|height)="([\d.]+)"', page)[:2]]
                self.assertLess(abs(size[0] - width) + abs(size[1] - height), 2)
                words = re.findall(r'xMin="([-\d.]+)" yMin="([-\d.]+)" xMax="([-\d.]+)" '
                                   r'yMax="([-\d.]+)">([^<]*)', page)
                top = " ".join(w[4] for w in words if float(w[1]) < 60)
                self.assertIn("ISCWSA 2", top)
                self.assertIn("VERDICT PASS", top.upper())
                for left, up, right, down, word in words:
                    self.assertGreater(float(left), 30, word)
                    self.assertLess(float(right), width - 30, word)
                    self.assertGreater(float(up), 25, word)
                    self.assertLess(float(down), height - 12, word)
            fonts = subprocess.run(["pdffonts", pdf], capture_output=True, text=True,
                                   check=True).stdout.splitlines()[2:]
            self.assertGreater(len(fonts), 0)
            for font in fonts:
                self.assertRegex(font, r"\byes (yes|no ) ?(yes|no)")

    def Spiral(self):
        """A result by formula, so that its picture changes only when the drawing does."""
        columns = self.Read("demo", "survey.csv").split("\n", 1)[0].split(",")[:18]
        lines = [",".join(columns)]
        for k in range(61):
            turn = 0.05 * k
            cells = [50 * k, 45, math.degrees(turn) % 360, 0, 35 * k, 700 * math.sin(turn),
                     700 * (1 - math.cos(turn)), 2, (0.1 * k) ** 2, 0, 0, (0.05 * k) ** 2, 0,
                     (0.02 * k) ** 2, 0.05, 0.3]
            kind = "continuous" if k else "tie_in"
            lines.append(",".join(f"{c:.6f}" for c in cells) + f",{kind},good")
        os.makedirs(self.Path("spiral"), exist_ok=True)
        self.Write("spiral/survey.csv", "\n".join(lines) + "\n")
        self.Write("spiral/run.toml", 'format = "wellgyro.run/1"\n[well]\nname = "Spiral"\n')

    @unittest.skipUnless(shutil.which("pdftoppm"), "no poppler-utils on this machine")
    def test_the_plan_on_paper_is_the_one_that_was_looked_at(self):
        self.Spiral()
        pdf = self.Path("spiral.pdf")
        self.Make("report", self.Path("spiral"), "--out", self.Path("spiral.html"), "--pdf", pdf)
        drawn = subprocess.run(["pdftoppm", "-gray", "-r", "60", "-f", "2", "-l", "2", pdf],
                               capture_output=True, check=True).stdout
        if REDRAW:
            with open(KEPT, "wb") as file:
                file.write(gzip.compress(drawn, mtime=0))
        with gzip.open(KEPT) as file:
            kept = file.read()
        self.assertEqual(drawn[:15], kept[:15])
        ink = sum(255 - v for v in kept[15:])
        differs = sum(abs(a - b) for a, b in zip(drawn[15:], kept[15:], strict=True))
        print(f"the plan on paper: {100 * differs / ink:.3f} % of its ink differs")
        self.assertLess(differs, 0.01 * ink)


if __name__ == "__main__":
    unittest.main()
