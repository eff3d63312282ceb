#!/usr/bin/env python3
"""The commands compare and merge, from the command line, with what they make of mistakes."""
import math
import os
import unittest

from harness import FreshProgramTest, Run

PLACE = ["--latitude-deg", "60"]
MWD = ["--field-nt", "50000", "--dip-deg", "70", "--declination-deg", "0"]


def Hole(md):
    return (min(md / 20, 60.0), (40 + 20 * math.sin(md / 700)) % 360)


class CompareAndMerge(FreshProgramTest):
    def setUp(self):
        super().setUp()
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder)
        self.Survey("gyro.csv", range(0, 1501, 25))
        self.Survey("mwd.csv", range(0, 2101, 30))

    def Survey(self, name, depths, azimuth=0.0, md=0.0):
        rows = "".join(f"{d + (md if d else 0):.4f},{Hole(d)[0]:.6f},{Hole(d)[1] + azimuth:.6f}\n"
                       for d in depths)
        self.Write(name, "MD[m],INC[deg],AZI_TRUE[deg]\n" + rows)

    def Table(self, *names):
        return self.Rows(*names)

    def test_two_surveys_of_one_hole_agree(self):
        done = Run("compare", "gyro.csv", "mwd.csv", "--model-a", "GYRO-NS-CT", "--model-b",
                   "ISCWSA MWD Rev 4", *PLACE, *MWD, "--out", "out")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("verdict: pass", done.stdout)
        rows = self.Table("out", "compare.csv")
        self.assertEqual([float(row["MD[m]"]) for row in rows], list(range(30, 1501, 30)))
        for row in rows:
            self.assertLess(abs(float(row["D_INC[deg]"])), 0.01)
            self.assertGreater(float(row["SIG_D_INC[deg]"]), 0.05)
        codes = [row["CODE"] for row in self.Table("out", "checks.csv")]
        self.assertEqual(codes, ["compare_inclination", "compare_azimuth", "compare_depth_offset",
                                 "compare_depth_stretch", "compare_azimuth_offset",
                                 "compare_position"])
        said = self.Toml("out", "compare.toml")
        self.assertEqual(said["verdict"], "pass")
        self.assertEqual(len([i for i in said["input"] if i["role"] == "survey"]), 2)

    def test_a_shift_of_azimuth_fails_and_is_measured(self):
        self.Survey("turned.csv", range(0, 1501, 30), azimuth=15.0)
        done = Run("compare", "gyro.csv", "turned.csv", "--model-a", "GYRO-NS-CT", "--model-b",
                   "GYRO-NS-CT", *PLACE, "--out", "out")
        self.assertEqual(done.returncode, 4, done.stdout + done.stderr)
        self.assertIn("verdict: fail", done.stdout)
        offset = self.Toml("out", "compare.toml")["azimuth_offset_deg"]
        self.assertAlmostEqual(offset["value"], 15.0, delta=0.3)
        self.assertGreater(offset["smallest_found_4_in_5"], 3 * offset["sigma"])

    def test_depths_are_chosen(self):
        done = Run("compare", "gyro.csv", "mwd.csv", "--model-a", "GYRO-NS-CT", "--model-b",
                   "GYRO-NS-CT", *PLACE, "--at", "333,777.5", "--every", "500", "--out", "out")
        self.assertEqual(done.returncode, 0, done.stderr)
        depths = [float(row["MD[m]"]) for row in self.Table("out", "compare.csv")]
        self.assertEqual(depths, [0, 333, 500, 777.5, 1000, 1500])

    def test_mistakes_of_compare_are_told(self):
        names = ",".join(f"{name}[m2]" for name in ("VAR_NN", "COV_NE", "COV_NV", "VAR_EE",
                                                    "COV_EV", "VAR_VV"))
        self.Write("variances.csv", f"MD[m],INC[deg],AZI_TRUE[deg],{names}\n" + "".join(
            f"{d},{Hole(d)[0]},{Hole(d)[1]},1,0,0,1,0,1\n" for d in range(0, 1501, 25)))
        for arguments, code, says in (
                (["gyro.csv", "mwd.csv"], 1, "name its error model"),
                (["gyro.csv", "none.csv", "--model-a", "GYRO-NS-CT", "--model-b", "GYRO-NS-CT"], 2,
                 "none.csv"),
                (["gyro.csv", "mwd.csv", "--model-a", "GYRO", "--model-b", "GYRO"], 2, "GYRO-NS"),
                (["gyro.csv", "mwd.csv", "--model-a", "GYRO-NS-CT", "--model-b", "GYRO-NS-CT"], 1,
                 "latitude"),
                (["gyro.csv", "mwd.csv", "--model-a", "GYRO-NS-CT", "--model-b", "GYRO-NS-CT",
                  *PLACE, "--at", "2000"], 1, "not in both"),
                (["gyro.csv"], 1, "B"),
                (["variances.csv", "mwd.csv"], 1, "no column SIG_INC")):
            done = Run("compare", *arguments)
            self.assertEqual(done.returncode, code, (arguments, done.stderr))
            self.assertIn(says, done.stderr)

    def test_a_surveys_folder_keeps_its_own_files(self):
        os.mkdir("result")
        for name in ("run.toml", "checks.csv"):
            self.Write("result/" + name, "the survey's\n")
        words = ["compare", "gyro.csv", "mwd.csv", "--model-a", "GYRO-NS-CT", "--model-b",
                 "GYRO-NS-CT", *PLACE, "--out", "result"]
        done = Run(*words)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("result holds a survey, which has a checks.csv of its own", done.stderr)
        self.assertEqual(sorted(os.listdir(self.Path("result"))), ["checks.csv", "run.toml"])
        self.assertEqual(self.Read("result/checks.csv"), "the survey's\n")
        os.remove(self.Path("result", "run.toml"))
        self.assertEqual(Run(*words).returncode, 0)
        self.assertEqual(Run(*words).returncode, 0, "its own may be written again")

    def Plan(self, text):
        self.Write("plan.toml", 'format = "wellgyro.merge/1"\n' + text)

    LEGS = """[[leg]]
survey = "gyro.csv"
model = "GYRO-NS-CT"
[[leg]]
survey = "mwd.csv"
model = "ISCWSA MWD Rev 4"
"""

    def Merge(self, *arguments):
        return Run("merge", "plan.toml", *PLACE, *MWD, "--out", "out", *arguments)

    def test_legs_become_one_survey_with_reasons(self):
        self.Plan(self.LEGS)
        self.assertEqual(self.Merge().returncode, 0)
        self.assertIn("with gyro instead", self.Table("out", "choices.csv")[0]["REASON"])
        self.Plan('[policy]\nchoose = "order"\n' + self.LEGS)
        done = self.Merge("--every", "100", "--to", "las")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        choices = self.Table("out", "choices.csv")
        self.assertEqual([row["LEG"] for row in choices], ["gyro", "mwd"])
        self.assertIn("first in the list", choices[0]["REASON"])
        self.assertIn("no other leg", choices[1]["REASON"])
        rows = self.Table("out", "definitive.csv")
        self.assertEqual(float(rows[-1]["MD[m]"]), 2100)
        self.assertGreater(float(rows[-1]["VAR_EE[m2]"]), 1)
        depths = [float(row["MD[m]"]) for row in self.Table("out", "resampled.csv")]
        self.assertEqual(depths, list(range(0, 2101, 100)))
        again = Run("convert", "out/definitive.las", "again.csv")
        self.assertEqual(again.returncode, 0, again.stderr)
        # The program that it writes has the same covariances.
        done = Run("uncertainty", "--program", "out/program.toml", *PLACE, *MWD, "--out", "u")
        self.assertEqual(done.returncode, 0, done.stderr)
        last = self.Table("u", "covariance.csv")[-1]
        for column in ("VAR_NN[m2]", "COV_NE[m2]", "VAR_VV[m2]"):
            expected = float(rows[-1][column])
            self.assertAlmostEqual(float(last[column]), expected, delta=1e-5 * abs(expected))

    def test_a_side_track_keeps_its_parent(self):
        self.Plan(self.LEGS)
        self.assertEqual(self.Merge().returncode, 0)
        os.rename("out", "parent")
        rows = "".join(f"{d},{Hole(910)[0] + (d - 910) / 30:.4f},{Hole(910)[1] + (d - 910) / 15:.4f}\n"
                       for d in range(940, 1500, 30))
        self.Write("side.csv", "MD[m],INC[deg],AZI_TRUE[deg]\n" + rows)
        self.Plan('[parent]\nprogram = "parent/program.toml"\nkick_off_md_m = 910\n'
                  '[[leg]]\nsurvey = "side.csv"\nmodel = "GYRO-NS-CT"\nrun = 5\n')
        done = self.Merge()
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        choices = self.Table("out", "choices.csv")
        self.assertEqual(float(choices[0]["TO_MD[m]"]), 910)
        self.assertIn("parent", choices[0]["REASON"])
        self.assertEqual(choices[-1]["LEG"], "side")
        # Above the kick-off both holes are one, and so are their covariances.
        parent = {row["MD[m]"]: row for row in self.Table("parent", "definitive.csv")}
        same = [row for row in self.Table("out", "definitive.csv") if float(row["MD[m]"]) <= 850]
        self.assertGreater(len(same), 20)
        for row in same:
            self.assertEqual(row["VAR_EE[m2]"], parent[row["MD[m]"]]["VAR_EE[m2]"])

    def test_legs_that_disagree_fail_unless_the_policy_notes_it(self):
        self.Survey("mwd.csv", range(0, 2101, 30), azimuth=20.0)
        self.Plan(self.LEGS)
        done = self.Merge()
        self.assertEqual(done.returncode, 4, done.stdout + done.stderr)
        self.assertIn("gyro and mwd: ", done.stdout)
        self.Plan('[policy]\non_disagreement = "note"\n' + self.LEGS)
        done = self.Merge()
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("verdict: warn", done.stdout)

    def test_mistakes_of_merge_are_told_with_their_line(self):
        for text, says in (
                ("", "at least one [[leg]]"),
                ('[policy]\nchoose = "best"\n' + self.LEGS, "smallest"),
                ('[policy]\nmin_gian = 0.1\n' + self.LEGS, "min_gain"),
                ('[[leg]]\nsurvey = "gyro.csv"\n', "model"),
                ('[[leg]]\nsurvey = "gyro.csv"\nmodel = "GYRO-NS-CT"\nfrom_md_m = 5000\n',
                 "no station"),
                ('[parent]\nprogram = "none.toml"\nkick_off_md_m = 900\n' + self.LEGS, "none.toml")):
            self.Plan(text)
            done = self.Merge()
            self.assertEqual(done.returncode, 2, (text, done.stderr))
            self.assertIn(says, done.stderr)
        self.Plan(self.LEGS.replace('"GYRO-NS-CT"\n', '"GYRO-NS-CT"\nto_md_m = 300\n').replace(
            'Rev 4"\n', 'Rev 4"\nfrom_md_m = 900\n'))
        done = self.Merge()
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("gap", done.stderr)
        out = '[[leg]]\nsurvey = "gyro.csv"\nmodel = "GYRO-NS-CT"\nleft_out = "damaged"\n'
        for text, says in ((out, "every leg is ruled out"),
                           (self.LEGS.replace("GYRO-NS-CT", "GYRO-NS-XX"), "there are CB_")):
            self.Plan(text)
            done = self.Merge()
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn("plan.toml" if text is out else "GYRO-NS-XX", done.stderr)
            self.assertIn(says, done.stderr)

    def test_nothing_is_written_over_what_it_came_from(self):
        os.rename("gyro.csv", "choices.csv")
        self.Plan(self.LEGS.replace("gyro.csv", "choices.csv"))
        os.rename("plan.toml", "merge.toml")
        gyro = ["--model", "GYRO-NS-CT", *PLACE]
        kept = {name: self.Bytes(name) for name in os.listdir(".")}
        self.Write("covariance.csv", kept["choices.csv"])
        self.Write("compare.csv", kept["choices.csv"])
        self.Write("clearance.csv", kept["choices.csv"])
        for arguments in (["merge", "merge.toml", *PLACE, *MWD],
                          ["uncertainty", "--survey", "covariance.csv", *gyro],
                          ["clearance", "--reference", "mwd.csv", "--offset", "clearance.csv",
                           *gyro],
                          ["compare", "compare.csv", "mwd.csv", "--model-a", "GYRO-NS-CT",
                           "--model-b", "GYRO-NS-CT", *PLACE]):
            before = sorted(os.listdir("."))
            done = Run(*arguments, "--out", ".")
            self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
            self.assertIn("would be written over", done.stderr)
            self.assertEqual(sorted(os.listdir(".")), before)
        for name, content in kept.items():
            self.assertEqual(self.Bytes(name), content)


if __name__ == "__main__":
    unittest.main()
