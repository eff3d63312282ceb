#!/usr/bin/env python3
"""The commands clearance, models and north, from the command line, with what they make of mistakes."""
import csv
import math
import os
import re
import shutil
import tempfile
import unittest

from harness import Run

PLACE = ["--latitude-deg", "60", "--field-nt", "50000", "--dip-deg", "70", "--declination-deg", "0"]


def Survey(path, stations, north=0.0, east=0.0):
    """Straight or bent by minimum curvature: MD, inclination, azimuth; where it starts."""
    with open(path, "w", encoding="utf-8") as file:
        file.write("MD[m],INC[deg],AZI_TRUE[deg],TVD[m],N[m],E[m]\n")
        for k, (md, inc, azi) in enumerate(stations):
            place = f"0,{north},{east}" if k == 0 else ",,"
            file.write(f"{md},{inc},{azi},{place}\n")


class Clearance(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        os.chdir(self.folder)
        Survey("plan.csv", [(30.0 * k, 0, 0) for k in range(60)])
        Survey("near.csv", [(30.0 * k, 0, 0) for k in range(60)], east=12)
        Survey("far.csv", [(30.0 * k, 0, 0) for k in range(60)], north=3000)

    def Clear(self, *arguments):
        return Run("clearance", "--model", "ISCWSA MWD Rev 4", *PLACE, "--out", "out", *arguments)

    def Rows(self, name):
        with open(os.path.join("out", name), encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def test_a_near_well_fails_and_a_far_one_is_screened_out(self):
        done = self.Clear("--reference", "plan.csv", "--offset", "near.csv", "--offset", "far.csv")
        self.assertEqual(done.returncode, 4, done.stderr)
        self.assertIn("verdict: fail", done.stdout)
        wells = {row["WELL"]: row for row in self.Rows("wells.csv")}
        self.assertEqual(wells["far"]["SCREENED_OUT"], "yes")
        self.assertEqual(wells["near"]["VERDICT"], "fail")
        rows = self.Rows("clearance.csv")
        self.assertEqual(len(rows), 60)
        for row in rows:
            self.assertAlmostEqual(float(row["DISTANCE[m]"]), 12, places=4)
            expected = (12 - 0.3) / (3.5 * math.hypot(float(row["SIGMA[m]"]), 0.5))
            self.assertAlmostEqual(float(row["FACTOR"]), expected, delta=2e-3 * expected)
        for name in ("ladder.svg", "travelling_cylinder.svg", "clearance.html"):
            with open(os.path.join("out", name), encoding="utf-8") as file:
                self.assertIn("near", file.read())

    def test_what_both_wells_share_drops_out(self):
        # Of vertical wells no azimuth error is shared, as none moves them.
        for name, east in (("slant.csv", 0), ("beside.csv", 12)):
            Survey(name, [(30.0 * k, min(3.0 * k, 45), 0) for k in range(60)], east=east)
        wells = ["--reference", "slant.csv", "--offset", "beside.csv"]
        lowest = {}
        for word in ("none", "global", "full"):
            done = self.Clear(*wells, "--correlation", word)
            self.assertIn(done.returncode, (0, 4), done.stderr)
            lowest[word] = min(float(row["FACTOR"]) for row in self.Rows("clearance.csv"))
        self.assertLess(lowest["none"], lowest["global"])
        self.assertLessEqual(lowest["global"], lowest["full"])
        self.assertEqual(self.Clear(*wells, "--correlation", "some").returncode, 1)

    def test_policy_with_wells_holes_and_a_sidetrack(self):
        Survey("side.csv", [(900, 0, 0), (930, 3, 90), (960, 6, 90), (1200, 30, 90)])
        with open("side.csv", encoding="utf-8") as file:
            text = file.read().replace("0,0.0,0.0", "900,0,0")
        with open("side.csv", "w", encoding="utf-8") as file:
            file.write(text)
        with open("policy.toml", "w", encoding="utf-8") as file:
            file.write("""format = "wellgyro.clearance/1"
[rule]
k = 2.5
[hole]
reference_radius_m = [[500, 0.3], [2000, 0.2]]
offset_radius_m = 0.1
[reference]
survey = "plan.csv"
[[offset]]
survey = "near.csv"
[[offset]]
name = "side"
survey = "side.csv"
kick_off_md_m = 900
""")
        done = self.Clear("--policy", "policy.toml")
        self.assertEqual(done.returncode, 4, done.stderr)
        rows = self.Rows("clearance.csv")
        near = [row for row in rows if row["WELL"] == "near"]
        self.assertEqual({row["HOLES[m]"] for row in near}, {"0.4000", "0.3000"})
        side = [row for row in rows if row["WELL"] == "side"]
        self.assertGreater(float(side[0]["MD[m]"]), 900)
        self.assertLess(float(side[0]["DISTANCE[m]"]), 2)
        # Just below the kick-off little has been gathered by either.
        self.assertLess(float(side[0]["SIGMA[m]"]), 1)

    def test_mistakes(self):
        for arguments, code in (
                (["--reference", "plan.csv"], 1),
                (["--reference", "none.csv", "--offset", "near.csv"], 2),
                (["--reference", "plan.csv", "--offset", "near.csv", "--policy", "plan.csv"], 2)):
            self.assertEqual(self.Clear(*arguments).returncode, code, arguments)
        done = Run("clearance", "--reference", "plan.csv", "--offset", "near.csv", "--out", "out",
                   "--model", "NONE")
        self.assertEqual(done.returncode, 2)
        self.assertIn("GYRO-NS-CT", done.stderr)


class Models(unittest.TestCase):
    def test_list_and_one(self):
        listed = Run("models")
        self.assertEqual(listed.returncode, 0)
        for name in ("GYRO-NS-CT", "GYRO-MWD", "ISCWSA MWD Rev 4"):
            self.assertIn(name, listed.stdout)
        one = Run("models", "GYRO-NS-CT_Fl")
        self.assertEqual(one.returncode, 0, one.stderr)
        self.assertRegex(one.stdout, r"DRFR +DREF +random +2\.2")
        self.assertEqual(Run("models", "NOTHING").returncode, 2)


class North(unittest.TestCase):
    def test_a_job_says_place_date_and_norths(self):
        folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, folder)
        path = os.path.join(folder, "job.toml")
        with open(path, "w", encoding="utf-8") as file:
            file.write('format = "wellgyro.job/1"\n[well]\nlatitude_deg = 57.0\n'
                       'longitude_deg = 7.5\n[grid]\nutm_zone = "32N"\nepsg = "23032"\n'
                       'convergence_deg = -1.26\n[noise]\nangle_random_walk_deg_per_sqrt_h = 0.1\n'
                       "[magnetic]\ndeclination_deg = 4.0\nsigma_deg = 0.3\n"
                       "[[run]]\nnumber = 1\nbegin_utime_us = 1768457520000000\n")
        done = Run("north", "--job", path)
        self.assertEqual(done.returncode, 0, done.stderr)
        # EPSG:1613, of the Norwegian North Sea, and no other operation of these latitudes.
        self.assertIn("ED50 to WGS 84 (24)", done.stdout)
        self.assertIn("on 2026-01-15", done.stdout)
        self.assertIn("stated -1.2600 deg: it holds", done.stdout)
        self.assertIn("stated +4.0000 deg: it holds", done.stdout)
        self.assertNotIn("outside", done.stderr)
        elsewhere = Run("north", "--job", path, "--longitude-deg", "2", "--latitude-deg", "57")
        self.assertIn("outside the area of EPSG:23032", elsewhere.stderr)
        self.assertIn("2026-01-15", elsewhere.stdout)

    def test_grid_and_magnetic(self):
        done = Run("north", "--latitude-deg", "58.44", "--longitude-deg", "1.93", "--crs",
                   "EPSG:32631", "--date", "2026-11-22")
        self.assertEqual(done.returncode, 0, done.stderr)
        turn = float(re.search(r"convergence (\S+) deg", done.stdout).group(1))
        # tan(convergence) = tan(longitude from the central meridian) sin(latitude) on the sphere.
        sphere = math.degrees(math.atan(math.tan(math.radians(1.93 - 3)) *
                                        math.sin(math.radians(58.44))))
        self.assertAlmostEqual(turn, sphere, delta=1e-3)
        self.assertRegex(done.stdout, r"declination [+-]\d+\.\d+ deg")

    def test_the_stated_figure_holds_and_ours_is_the_check(self):
        done = Run("north", "--latitude-deg", "58.44", "--longitude-deg", "1.93", "--crs",
                   "EPSG:32631", "--convergence-deg", "2.5")
        self.assertEqual(done.returncode, 0)
        self.assertIn("it holds", done.stdout)
        self.assertIn("differs", done.stderr)

    def test_mistakes(self):
        place = ["--latitude-deg", "58", "--longitude-deg", "2"]
        self.assertEqual(Run("north").returncode, 1)
        self.assertEqual(Run("north", *place, "--crs", "EPSG:4326").returncode, 2)
        self.assertEqual(Run("north", *place, "--date", "2026-02-30").returncode, 1)
        self.assertEqual(Run("north", *place, "--date", "1850-01-01").returncode, 2)


if __name__ == "__main__":
    unittest.main()
