#!/usr/bin/env python3
"""The commands clearance, models and north, from the command line, with what they make of mistakes."""
import csv
import math
import os
import re
import shutil
import tempfile
import unittest
import xml.dom.minidom

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
        # Where they part both are one hole: that is listed, and judged only if the policy wants it.
        with open("policy.toml", "a", encoding="utf-8") as file:
            file.write("judged_from_md_m = 1150\n")
        done = self.Clear("--policy", "policy.toml")
        wells = {row["WELL"]: row for row in self.Rows("wells.csv")}
        self.assertGreaterEqual(float(wells["side"]["MD[m]"]), 1150)
        self.assertEqual(len([r for r in self.Rows("clearance.csv") if r["WELL"] == "side"]),
                         len(side))
        self.assertIn("judged from MD 1150.00 m", done.stderr)
        for judged, code in ((1850, 1), (800, 2)):
            with open("policy.toml", encoding="utf-8") as file:
                text = re.sub("judged_from_md_m.*", f"judged_from_md_m = {judged}", file.read())
            with open("policy.toml", "w", encoding="utf-8") as file:
                file.write(text)
            self.assertEqual(self.Clear("--policy", "policy.toml").returncode, code)
        # Just below the kick-off little has been gathered by either.
        self.assertLess(float(side[0]["SIGMA[m]"]), 1)

    def test_a_side_track_without_a_place_begins_on_its_parent_or_is_refused(self):
        """Dated 2026-11-23: it was put at north 0, east 0, 200 m off, and passed."""
        Survey("bent.csv", [(30.0 * k, min(2.0 * k, 40), 45) for k in range(60)])
        with open("side.csv", "w", encoding="utf-8") as file:
            file.write("MD[m],INC[deg],AZI_TRUE[deg]\n900,40,45\n930,42,50\n1200,50,80\n")
        done = self.Clear("--reference", "bent.csv", "--offset", "side.csv")
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertIn("begins at MD 900.00 m", done.stderr)
        self.assertIn("north_m", done.stderr)
        beside = ["uncertainty", "--survey", "bent.csv", "--other", "side.csv", "--model",
                  "GYRO-NS-CT", "--latitude-deg", "60", "--out", "own"]
        done = Run(*beside)
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertIn("does not begin at MD 0", done.stderr)
        self.assertEqual(Run(*beside, "--same-hole").returncode, 0)
        with open("policy.toml", "w", encoding="utf-8") as file:
            file.write('format = "wellgyro.clearance/1"\n[[offset]]\nsurvey = "side.csv"\n'
                       "kick_off_md_m = 900\n")
        done = self.Clear("--reference", "bent.csv", "--policy", "policy.toml")
        self.assertIn("put where the reference is at MD 900.00 m", done.stderr)
        rows = self.Rows("clearance.csv")
        self.assertLess(float(rows[0]["DISTANCE[m]"]), 3)
        again = self.Clear("--reference", "bent.csv", "--policy", "policy.toml", "--offset",
                           "side.csv")
        self.assertEqual(again.returncode, 1)
        self.assertIn("named twice", again.stderr)

    def test_what_no_model_covers_does_not_pass(self):
        Survey("up.csv", [(30.0 * k, min(160, 3.0 * k), 0) for k in range(60)], north=3000)
        for wells in (["--reference", "plan.csv", "--offset", "up.csv"],
                      ["--reference", "up.csv", "--offset", "plan.csv"]):
            done = Run("clearance", "--model", "GYRO-NS-CT", *PLACE, "--out", "out", *wells)
            self.assertEqual(done.returncode, 3, done.stderr)
            self.assertIn("verdict: warn", done.stdout)
            self.assertIn("not judged", done.stderr)
            self.assertEqual(self.Rows("wells.csv")[0]["VERDICT"], "warn")
            with open("out/clearance.html", encoding="utf-8") as file:
                self.assertIn("nothing below is judged", file.read())

    def Placed(self, name, north, east, northing, easting, head=""):
        """Vertical, with offsets and map coordinates."""
        with open(name, "w", encoding="utf-8") as file:
            file.write(head + "MD[m],INC[deg],AZI_TRUE[deg],TVD[m],N[m],E[m],NORTHING[m],"
                       "EASTING[m]\n")
            file.writelines(f"{30 * k},0,0,{30 * k},{north},{east},{northing},{easting}\n"
                            for k in range(20))

    def test_wells_of_two_heads_are_not_put_on_one_spot(self):
        self.Placed("a.csv", 0, 0, 6600000, 400000)
        self.Placed("b.csv", 0, 0, 6600300, 400400)
        done = self.Clear("--reference", "a.csv", "--offset", "b.csv")
        self.assertEqual(done.returncode, 1)
        self.assertIn("500.0 m apart by their map coordinates, 0.0 m by north and east",
                      done.stderr)
        with open("policy.toml", "w", encoding="utf-8") as file:
            file.write('format = "wellgyro.clearance/1"\n[[offset]]\nsurvey = "b.csv"\n'
                       "north_m = 300\neast_m = 400\ntvd_m = 0\n")
        done = self.Clear("--reference", "a.csv", "--policy", "policy.toml")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.Placed("b.csv", 300, 400, 6600300, 400400)
        self.assertEqual(self.Clear("--reference", "a.csv", "--offset", "b.csv").returncode, 0)

    def test_depths_of_two_datums_are_held_to_one(self):
        for name, north, elevation in (("a.csv", 0, 25), ("b.csv", 40, 37)):
            self.Placed(name, north, 0, 6600000 + north, 4e5,
                        f"# datum: RT\n# datum_elevation_m: {elevation}\n")
        with open("policy.toml", "w", encoding="utf-8") as file:
            file.write('format = "wellgyro.clearance/1"\n[rule]\nscan = "horizontal"\n'
                       "[limits]\nreport = 1000\n")
        done = self.Clear("--reference", "a.csv", "--offset", "b.csv", "--policy", "policy.toml")
        self.assertIn("it is put 12.00 m higher", done.stderr)
        rows = self.Rows("clearance.csv")
        self.assertAlmostEqual(float(rows[5]["OTHER_MD[m]"]) - float(rows[5]["MD[m]"]), 12,
                               places=6)

    def test_files_of_one_name_are_told_apart(self):
        for folder in ("a", "b"):
            os.mkdir(folder)
            shutil.copy("near.csv", f"{folder}/survey.csv")
        self.Clear("--reference", "plan.csv", "--offset", "a/survey.csv", "--offset",
                   "b/survey.csv")
        names = [row["WELL"] for row in self.Rows("wells.csv")]
        self.assertEqual(len(set(names)), 2)
        self.assertTrue(names[0].endswith("a/survey.csv"), names)
        done = self.Clear("--reference", "plan.csv", "--offset", "near.csv", "--offset", "near.csv")
        self.assertEqual(done.returncode, 1)
        self.assertIn("named twice", done.stderr)

    def test_names_of_files_break_no_page_or_picture(self):
        names = ["x<script>1<.csv", 'a,"b.csv', "\u0628\u0626\u0631.csv", "new\nline.csv",
                 os.fsdecode(b"bad\xff.csv")]
        for name in names:
            shutil.copy("near.csv", name)
        self.Clear("--reference", "plan.csv", *(x for name in names for x in ("--offset", name)))
        for name in ("ladder.svg", "travelling_cylinder.svg"):
            xml.dom.minidom.parse(os.path.join("out", name))
        with open("out/clearance.html", encoding="utf-8") as file:
            self.assertNotIn("<script", file.read())
        self.assertEqual(len(self.Rows("wells.csv")), len(names))

    def test_lines_end_at_the_edge_of_their_panel(self):
        self.Clear("--reference", "plan.csv", "--offset", "near.csv", "--offset", "far.csv",
                   "--correlation", "none")
        with open("out/ladder.svg", encoding="utf-8") as file:
            picture = file.read()
        lines = re.findall(r'<path class="[sa]"[^>]*>', picture)
        self.assertTrue(lines)
        self.assertTrue(all('clip-path="url(#' in line for line in lines))
        self.assertEqual(picture.count("<clipPath id="), 2)

    def test_check_names_what_was_written(self):
        self.Clear("--reference", "plan.csv", "--offset", "near.csv")
        Run("uncertainty", "--survey", "plan.csv", "--model", "GYRO-NS-CT", *PLACE, "--terms",
            "--plot", "--other", "near.csv", "--out", "own")
        with open("policy.toml", "w", encoding="utf-8") as file:
            file.write('format = "wellgyro.clearance/1"\n[rule]\nk = 3.5\n')
        files = ["policy.toml"] + [os.path.join(folder, name) for folder in ("out", "own")
                                   for name in sorted(os.listdir(folder))]
        self.assertGreater(len(files), 9)
        done = Run("check", *files)
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertNotIn("not one of", done.stdout)
        with open("policy.toml", "a", encoding="utf-8") as file:
            file.write("K = 3\n")
        self.assertEqual(Run("check", "policy.toml").returncode, 2)

    def test_what_is_not_stated_is_told_or_refused(self):
        with open("bare.csv", "w", encoding="utf-8") as file:
            file.write("MD,INC,AZI\n0,0,0\n30,0,0\n")
        done = self.Clear("--reference", "plan.csv", "--offset", "bare.csv")
        self.assertEqual(done.returncode, 1)
        self.assertIn("--depth-unit", done.stderr)
        with open("bare.csv", "w", encoding="utf-8") as file:
            file.write("MD[m],INC[deg],AZI_TRUE[deg]\n0,0,0\n30,0,0\n")
        done = self.Clear("--reference", "plan.csv", "--offset", "bare.csv")
        self.assertIn("bare: no place in its file", done.stderr)

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
        self.assertRegex(one.stdout, r"DRFR +DREF +random +2\.2 m\n")
        # As published: OWSG Set A A021Gc has 0.1 deg of misalignment and 0.5 deg/h of drift.
        self.assertRegex(one.stdout, r"XYM1 +XYM1 +systematic +0\.1 deg\n")
        self.assertRegex(one.stdout, r"GXY-GD +GXY-GD +systematic +0\.5 deg/h\n")
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
        done = Run("north", *place, "--date", "2026-01-01", "--magnetic-model", "none")
        self.assertEqual(done.returncode, 1)
        self.assertIn("igrf14", done.stderr)
        for latitude in ("nan", "inf", "91"):
            done = Run("north", "--latitude-deg", latitude, "--longitude-deg", "2")
            self.assertEqual(done.returncode, 1, latitude)
            self.assertEqual(done.stdout, "")
        self.assertEqual(Run("north", *place, "--crs", "EPSG:4326").returncode, 2)
        self.assertEqual(Run("north", *place, "--date", "2026-02-30").returncode, 1)
        done = Run("north", *place, "--date", "1850-01-01")
        self.assertEqual(done.returncode, 2)
        self.assertIn("--magnetic-model igrf14", done.stderr)
        # What would be passed over is said.
        for extra, word in ((["--declination-deg", "1"], "--date"),
                            (["--convergence-deg", "1"], "--crs"),
                            (["--easting", "1", "--northing", "2"], "one place"),
                            (["--easting", "1"], "go together")):
            done = Run("north", *place, *extra)
            self.assertEqual(done.returncode, 1, extra)
            self.assertIn(word, done.stderr)
        short = Run("north", *place, "--crs", "32631")
        self.assertEqual(short.stdout, Run("north", *place, "--crs", "EPSG:32631").stdout)


if __name__ == "__main__":
    unittest.main()
