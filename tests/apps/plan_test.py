#!/usr/bin/env python3
"""The command plan, from the command line, with what it makes of mistakes."""
import csv
import os
import re
import shutil
import tempfile
import tomllib
import unittest

from harness import DEMO, Run

JOB = os.path.join(DEMO, "job.toml")
SLANT = ((300, 5, 38), (600, 20, 40), (900, 40, 41), (1200, 58, 40), (1500, 60, 40), (2000, 60, 40))


class Plan(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        os.chdir(self.folder)
        with open("well.csv", "w", encoding="utf-8") as file:
            file.write("MD[m],INC[deg],AZI_TRUE[deg]\n")
            file.writelines(f"{md},{inc},{azi}\n" for md, inc, azi in SLANT)

    def Plan(self, *arguments, rpm="1"):
        return Run("plan", "--well", "well.csv", "--tool", JOB, "--latitude-deg", "60",
                   "--roll-rpm", rpm, "--out", "out", *arguments)

    def Toml(self, name="out/plan.toml"):
        with open(name, "rb") as file:
            return tomllib.load(file)

    def test_nothing_is_written_over_what_it_came_from(self):
        os.rename("well.csv", "expected.csv")
        done = Run("plan", "--well", "expected.csv", "--tool", JOB, "--ellipse-m", "25", "--out", ".")
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn("expected.csv would be written over", done.stderr)
        self.assertEqual(os.listdir("."), ["expected.csv"])

    def test_a_plan_meets_its_limits_in_less_time_than_practice(self):
        done = self.Plan("--ellipse-m", "2.7", "--practice", "every_m=300,stop_s=180")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        plan = self.Toml()
        self.assertTrue(plan["feasible"])
        self.assertLessEqual(plan["expected"]["ellipse_major_m"], 2.71)
        self.assertGreater(plan["without_stops"]["ellipse_major_m"], 2.71)
        self.assertEqual(sum(s["stop_s"] for s in plan["stop"]), plan["time"]["at_rest_s"])
        self.assertLessEqual(plan["time"]["bound_at_rest_s"], plan["time"]["at_rest_s"])
        for stop in plan["stop"]:
            self.assertGreater(stop["ellipse_without_m"], 2.7)
        self.assertIn("practice, 7 stops", done.stdout)
        self.assertIn("tool 5 times worse", done.stdout)
        self.assertEqual([i["role"] for i in plan["input"]], ["tool", "well"])
        with open("out/plan.txt", encoding="utf-8") as file:
            self.assertTrue(file.read().startswith(done.stdout.split("plan.toml\n")[1]))
        with open("out/plan.svg", encoding="utf-8") as file:
            self.assertIn("Time at rest", file.read())

    def test_what_turning_the_tool_would_save_is_said_of_one_that_slides(self):
        sliding = self.Plan("--ellipse-m", "5", rpm="0")
        self.assertEqual(sliding.returncode, 0, sliding.stdout + sliding.stderr)
        said = re.search(r"\(--toolfaces\): (\d+) stops, (\d+) s at rest", sliding.stdout)
        self.assertTrue(said, sliding.stdout)
        self.assertNotIn("toolface_deg", self.Toml()["stop"][0])
        turned = self.Plan("--ellipse-m", "5", "--toolfaces", rpm="0")
        self.assertNotIn("--toolfaces", turned.stdout)
        plan = self.Toml()
        self.assertEqual(len(plan["stop"]), int(said[1]))
        self.assertEqual(plan["time"]["at_rest_s"], int(said[2]))
        for stop in plan["stop"]:
            self.assertIn("toolface_deg", stop)
        rolling = self.Plan("--ellipse-m", "2.7")
        self.assertNotIn("--toolfaces", rolling.stdout)

    def test_what_is_expected_along_the_way_ends_as_the_plan_says(self):
        self.assertEqual(self.Plan("--ellipse-m", "2.7").returncode, 0)
        with open("out/expected.csv", encoding="utf-8") as file:
            rows = [{key: float(cell) for key, cell in row.items()} for row in csv.DictReader(file)]
        self.assertGreater(len(rows), 30)
        self.assertAlmostEqual(rows[-1]["MD[m]"], 2000, 3)
        with open("out/plan.txt", encoding="utf-8") as file:
            said = re.search(r"ellipse ([\d.]+) x ([\d.]+) m", file.read())
        self.assertAlmostEqual(rows[-1]["SEMI_MAJOR[m]"], float(said[1]), 2)
        self.assertAlmostEqual(rows[-1]["SEMI_MINOR[m]"], float(said[2]), 2)
        for before, after in zip(rows, rows[1:]):
            self.assertGreater(after["MD[m]"], before["MD[m]"])
            self.assertGreater(after["SEMI_MAJOR[m]"], 0.9 * before["SEMI_MAJOR[m]"])

    def test_the_same_inputs_give_the_same_bytes(self):
        texts = []
        for _ in range(2):
            self.assertEqual(self.Plan("--ellipse-m", "3").returncode, 0)
            with open("out/plan.toml", "rb") as file:
                texts.append(file.read())
        self.assertEqual(*texts)

    def test_what_no_plan_meets_is_said(self):
        done = self.Plan("--ellipse-m", "0.2")
        self.assertEqual(done.returncode, 4, done.stderr)
        self.assertIn("not feasible: no plan has an ellipse of 0.2 m", done.stdout)
        plan = self.Toml()
        self.assertFalse(plan["feasible"])
        self.assertNotIn("stop", plan)

    def test_a_simulation_follows_the_plan(self):
        self.assertEqual(self.Plan("--ellipse-m", "2.7").returncode, 0)
        plan = self.Toml()
        rows = ", ".join(f"[{md}.0, {inc}.0, {azi}.0]" for md, inc, azi in SLANT)
        with open("simulation.toml", "w", encoding="utf-8") as file:
            file.write(f"""format = "wellgyro.simulation/1"
seed = 4
[well]
table = [{rows}]
[earth]
latitude_deg = 60.0
[tool]
angle_random_walk_deg_per_sqrt_h = 0.005
[streams]
imu_hz = 4.0
depth_hz = 2.0
""")
        simulate = ("simulate", "--job", "simulation.toml", "--out", "run.lcm")
        self.assertIn("run", Run(*simulate).stderr)
        done = Run(*simulate, "--plan", "out/plan.toml")
        self.assertEqual(done.returncode, 0, done.stderr)
        with open("run.lcm.truth.csv", encoding="utf-8") as file:
            rows = [[float(cell) for cell in row[:5]] for row in csv.reader(file)
                    if row[0] != "T[s]"]
        depths = [row[1] for row in rows]
        self.assertAlmostEqual(max(depths), 2000, 2)
        self.assertAlmostEqual(depths[-1], 300, 2)
        turn = depths.index(max(depths))
        for stop in plan["stop"]:
            way = rows[:turn] if stop["pass"] == "in" else rows[turn:]
            rested = sum(1 for row in way if abs(row[1] - stop["md_m"]) < 0.01)
            self.assertAlmostEqual(rested, stop["stop_s"], delta=4)
        for text, says in (("format = \"wellgyro.plan/1\"\n", "run"), ("", "format")):
            with open("bad.toml", "w", encoding="utf-8") as file:
                file.write(text)
            done = Run(*simulate, "--plan", "bad.toml")
            self.assertEqual(done.returncode, 2)
            self.assertIn("bad.toml", done.stderr)
            self.assertIn(says, done.stderr)

    def test_mistakes_are_told(self):
        for arguments, code, says in (
                ((), 1, "--ellipse-m is required"),
                (("--ellipse-m", "5", "--practice", "every=3"), 1, "every_m"),
                (("--ellipse-m", "5", "--practice", "every_m=3x"), 1, "every_m=3x"),
                (("--ellipse-m", "5", "--end-md-m", "9000"), 1, "end_md must lie in the well"),
                (("--ellipse-m", "5", "--speed-mps", "0"), 1, "speed_in"),
                (("--ellipse-m", "5", "--least-stop-s", "500", "--longest-stop-s", "50"), 1,
                 "longest_stop"),
                (("--ellipse-m", "5", "--noise", "none.toml"), 2, "none.toml")):
            done = self.Plan(*arguments)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn(says, done.stderr)
            self.assertTrue(done.stderr.isascii())
        self.assertFalse(os.path.exists("out"))
        with open("well.csv", "w", encoding="utf-8") as file:
            file.write("MD[m],INC[deg],AZI_GRID[deg]\n0,0,0\n900,30,10\n")
        done = self.Plan("--ellipse-m", "5")
        self.assertEqual(done.returncode, 1)
        self.assertIn("convergence", done.stderr)


if __name__ == "__main__":
    unittest.main()
