#!/usr/bin/env python3
"""What the program says at a terminal. terminal_test.py PROGRAM"""
import json
import math
import os
import re
import subprocess
import unittest

from harness import PROGRAM, TOP, FreshProgramTest, Job, Move, Run, Simulation, Stop
from demonstration import DEMO, Begin, Ends


def Help(*words, columns):
    return subprocess.run([PROGRAM, *words, "--help"], capture_output=True, text=True,
                          env=os.environ | {"COLUMNS": str(columns)}, check=True).stdout


def Commands(*words):
    """What may stand behind `words`."""
    listed = Help(*words, columns=100).split("Subcommands:\n")[1].split("\n\n")[0]
    return re.findall(r"(?m)^  (\S+)", listed)


class Terminal(FreshProgramTest):
    def test_help_is_at_most_100_columns_and_names_no_path(self):
        calls = [[]] + [[command] for command in Commands()]
        calls += [["calibrate", method] for method in Commands("calibrate")]
        self.assertIn(["survey"], calls)
        self.assertIn(["calibrate", "learn"], calls)
        for words in calls:
            text = Help(*words, columns=100)
            self.assertEqual([line for line in text.splitlines() if len(line) > 100], [])
            self.assertIn("Usage: wellgyro", text)
            self.assertNotIn("{", text)  # lists as CLI11 shows them
            self.assertNotRegex(text, r"(FLOAT|INT):")  # and ranges
            examples = re.findall(r"(?m)^  +wellgyro .*(?:(?<=\\)\n.*)*", text)
            self.assertEqual([line for example in examples for line in example.splitlines()
                              if len(line) > 80], [])
            for columns in (60, 80):
                narrow = Help(*words, columns=columns)
                self.assertEqual(narrow.split(), text.split())
                # A word alone is not broken; behind the options, what is indented is to be copied
                # as it stands.
                parts = re.split(r"(?m)^(?=.*Examples?:$)", narrow, maxsplit=1)
                long = [line for line in parts[0].splitlines()
                        if len(line) > columns and len(line.split()) > 1]
                long += [line for line in "".join(parts[1:]).splitlines()
                         if len(line) > columns and line[0] != " "]
                self.assertEqual(long, [], words)

    def test_bash_completes_commands_methods_orders_and_options(self):
        os.symlink(PROGRAM, self.Path("wellgyro"))
        completion = os.path.join(TOP, "apps", "wellgyro.bash")
        for typed, offered in ((["sur"], {"survey"}), (["calibrate", ""], set(Commands("calibrate"))),
                               (["calibrate", "tool", "--certificate-"], {"--certificate-number"}),
                               (["calibrate", "--he"], {"--help"}),
                               (["calibrate", "tool", "be"], set()),
                               (["send", "re"], {"reject", "remark", "return-to-zero", "rezero"}),
                               (["survey", "--ver"], set()), (["survey", "ru"], set())):
            words = " ".join(f"'{word}'" for word in ["wellgyro", *typed])
            done = subprocess.run(
                ["bash", "-c", f"source '{completion}'; COMP_WORDS=({words}); "
                 f"COMP_CWORD={len(typed)}; _wellgyro; echo \"${{COMPREPLY[@]}}\""],
                capture_output=True, text=True, check=True,
                env=os.environ | {"PATH": self.folder + ":" + os.environ["PATH"]})
            self.assertEqual(set(done.stdout.split()), offered, typed)
            self.assertEqual(done.stderr, "")

    def test_a_slip_is_named_with_what_seems_to_be_meant(self):
        method = "'six-postion' is no method of calibrate; is 'six-position' meant?\n"
        for words, said in ((("survy", "--job", "x"), "'survy' is no command; is 'survey' meant?"),
                            (("survey", "--jop", "x"), "'--jop' is no option of survey; is '--job'"),
                            (("check", "--job-key"), "'--job-key' is no option of check"),
                            (("zzz",), "'zzz' is no command\n"),
                            (("zzz", "survey"), "'zzz' is no command\n"),
                            (("calibrate", "six-postion"), method),
                            (("calibrate", "six-postion", "--data", "x"), method),
                            (("calibrate", "guess"), "'guess' is no method of calibrate\n"),
                            (("calibrate", "--dip", "affine"), "'--dip' is no option of calibrate"),
                            (("calibrate", "affine", "--dta", "x"), "'--dta' is no option of affine; "
                             "is '--data' meant?\nwellgyro calibrate affine --help says"),
                            (("survey", "--from", "a.csv", "b.csv"),
                             "'b.csv' belongs to no option of survey; one that may be given several "
                             "times stands before each value\n")):
            done = Run(*words)
            self.assertEqual(done.returncode, 1)
            self.assertIn(said, done.stderr)

    def test_a_word_that_is_refused_comes_with_those_that_are_taken(self):
        for words, said in (
                ("send finsh", "adjust, finish, take-station; is 'finish' meant?"),
                ("report r --out p --units fild",
                 "--units: 'fild' is none of metric, field; is 'field' meant?"),
                ("report r --out p --units 1", "--units: '1' is none of metric, field\n"),
                ("report r --out p --paper a9", "'a9' is none of a4, letter; is 'a4' meant?"),
                ("allan --data d --unit foo", "--unit: 'foo' is none of deg_per_h, deg_per_s, "
                 "rad_per_s, counts, mps2, milli_g\n"),
                ("allan --data d --deviation adv", "oadev, mdev; is 'adev' meant?"),
                ("survey --formats las,compas", "osdu; is 'compass' meant?"),
                ("convert a b --north tru", "true, grid, magnetic; is 'true' meant?"),
                ("merge p --to las,wits --out o", "gpkg; is 'witsml' meant?"),
                ("clearance --correlation globl", "none, global, full; is 'global' meant?"),
                ("uncertainty --correlation globl", "none, global, full; is 'global' meant?"),
                ("uncertainty --allan exat", "exact, printed; is 'exact' meant?"),
                ("calibrate affine --second-order ful", "none, own, full; is 'full' meant?"),
                ("calibrate gyro-rate-table --force ful", "full, none; is 'full' meant?"),
                ("calibrate affine --bench-axes tol", "trade, tool; is 'tool' meant?")):
            done = Run(*words.split())
            self.assertEqual(done.returncode, 1, words)
            self.assertIn(said, done.stderr)

    def test_version_names_the_commit(self):
        self.assertRegex(Run("--version").stdout, r"^wellgyro \d+\.\d+\.\d+ \(.+\)$")

    def test_a_source_is_not_written_over(self):
        self.Write("in.csv", "MD[m],INC[deg],AZI_TRUE[deg]\n0,0,0\n30,1.5,350\n")
        os.symlink(self.Path("in.csv"), self.Path("link.csv"))
        for target in ("in.csv", "link.csv"):
            done = Run("convert", self.Path("in.csv"), self.Path(target))
            self.assertEqual(done.returncode, 1)
            self.assertIn("must be different files", done.stderr)
        for option in ("--job", "--plan", "--tool", "--truth"):
            words = {"--job": self.Path("job.toml")} | {option: self.Path("in.csv")}
            done = Run("simulate", *[w for pair in words.items() for w in pair], "--out",
                       self.Path("link.csv"))
            self.assertEqual(done.returncode, 1)
            self.assertIn("must be different files", done.stderr)
        self.assertTrue(self.Read("in.csv").startswith("MD[m],INC"))

    def test_an_ending_that_names_no_format_comes_with_those_that_are_taken(self):
        self.Write("in.csv", "MD[m],INC[deg],AZI_TRUE[deg]\n0,0,0\n30,1.5,350\n")
        done = Run("convert", self.Path("in.csv"), self.Path("out.xyz"))
        self.assertEqual(done.returncode, 1)
        for word in ("--to", "las", "witsml", "p717"):
            self.assertIn(word, done.stderr)

    def test_a_log_becomes_tables(self):
        log = self.Write("begin.lcm", Begin())
        done = Run("convert", log, self.Path("run.csv"))
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertTrue(self.Read("run.csv").startswith("TOOL[ns],UTC[us],GX[rad/s]"))
        self.assertTrue(self.Read("run.depth.csv").startswith("UTC[us],MD[m]"))
        done = Run("check", self.Path("run.csv"), self.Path("run.depth.csv"))
        self.assertEqual(done.returncode, 0, done.stdout)
        done = Run("convert", log, self.Path("run.las"))
        self.assertEqual(done.returncode, 1)
        done = Run("convert", log, self.Path("absent/run.csv"))
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(self.Read("absent/run.csv"), self.Read("run.csv"))

    def test_units_and_headings_that_are_refused_come_with_the_known_ones(self):
        for heads, said in (("MD[furlong],INC[deg],AZI_TRUE[deg]", "known are m, ft, ftUS"),
                            ("MD[m],INC[turns],AZI_TRUE[deg]", "known are deg, "),
                            ("MD[m],LEAN[deg],AZI_TRUE[deg]", "as MD[m], INC[deg], AZI_TRUE[deg]")):
            self.Write("in.csv", heads + "\n0,0,0\n30,1.5,350\n")
            done = Run("convert", self.Path("in.csv"), self.Path("out.las"))
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(said, done.stderr)

    def Demo(self, *more):
        self.Write("begin.lcm", Begin())
        return Run("survey", "--job", os.path.join(DEMO, "job.toml"), "--from",
                   self.Path("begin.lcm"), "--out", self.Path("result"), *more)

    def test_a_quiet_survey_says_nothing(self):
        done = self.Demo("--quiet")
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))
        self.assertEqual(self.Demo("--quiet", "--json").returncode, 1)
        with open(self.Path("empty.lcm"), "wb"):
            pass
        done = Run("survey", "--job", os.path.join(DEMO, "job.toml"), "--from",
                   self.Path("empty.lcm"), "--out", self.Path("none"), "--quiet")
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertTrue(done.stderr, "trouble is said all the same")

    def test_a_terminal_is_told_how_long_the_adjustment_takes(self):
        self.Write("begin.lcm", Begin())
        reading, terminal = os.openpty()
        subprocess.run([PROGRAM, "survey", "--job", os.path.join(DEMO, "job.toml"), "--from",
                        self.Path("begin.lcm"), "--out", self.Path("result")],
                       stdout=subprocess.DEVNULL, stderr=terminal, check=True)
        os.close(terminal)
        with os.fdopen(reading, "rb") as said:
            shown = said.read1(65536).decode()
        self.assertRegex(shown, r"\radjusting, 0 s(\radjusting, \d+ s)*\r +\r$")

    def test_the_summary_as_a_document_says_what_the_files_say(self):
        done = self.Demo("--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        said = json.loads(done.stdout)
        self.assertEqual((said["format"], said["exit_code"]), ("wellgyro.summary/1", 0))
        self.assertEqual(said["verdict"], self.Toml("result", "run.toml")["verdict"]["verdict"])
        tool, = said["tools"]
        self.assertIn("survey.json", tool["files"])
        for name in tool["files"]:
            self.assertTrue(os.path.isfile(self.Path("result", name)), name)
        rows = self.Rows("result", "survey.csv")
        self.assertEqual(tool["stations"], len(rows))
        for key, column in (("md_m", "MD[m]"), ("azimuth_true_deg", "AZI_TRUE[deg]"),
                            ("north_m", "N[m]"), ("tvd_m", "TVD[m]")):
            self.assertAlmostEqual(tool["end"][key], float(rows[-1][column]), 4)
        self.assertAlmostEqual(tool["end"]["tvd_95_m"],
                               1.959964 * float(rows[-1]["VAR_VV[m2]"]) ** 0.5, 5)
        # The half axes' squares sum to the trace, as 2.4477 sigma.
        ellipse = tool["end"]["ellipse_95"]
        self.assertAlmostEqual(ellipse["semi_major_m"] ** 2 + ellipse["semi_minor_m"] ** 2,
                               -2 * math.log(0.05) * (float(rows[-1]["VAR_NN[m2]"]) +
                                                      float(rows[-1]["VAR_EE[m2]"])), 4)
        bad = [row["CODE"] for row in self.Rows("result", "checks.csv") if row["VERDICT"] != "pass"]
        self.assertEqual([check["code"] for check in tool["checks_not_passed"]], bad)

    def test_a_rotated_log_is_one_survey(self):
        simulation = self.Write("simulation.toml", Simulation(
            Stop(120) + Move(200) + Stop(60), "imu_hz = 20.0\ndepth_hz = 4.0\nbatch = 20\n"))
        whole, job = self.Path("whole.lcm"), self.Write("job.toml", Job(25.0))
        self.Make("simulate", "--job", simulation, "--out", whole)
        data = self.Bytes("whole.lcm")
        ends = Ends(data)
        cuts = [0, ends[len(ends) // 3], ends[2 * len(ends) // 3], len(data)]
        names = ["rig.lcm", "rig.001.lcm", "rig.002.lcm"]
        logger = ["rig.lcm.07", "rig.lcm.08", "rig.lcm.09"]  # lcm-logger --increment --split-mb
        for name, begin, end in zip(names + logger, 2 * cuts[:-1], 2 * cuts[1:]):
            with open(self.Path(name), "wb") as part:
                part.write(data[begin:end])
        self.assertEqual(Run("survey", "--job", job, "--from", whole, "--out",
                             self.Path("whole")).returncode, 0)
        for name, out in (("rig.lcm", "first"), ("rig.lcm.07", "logger")):
            Run("survey", "--job", job, "--from", self.Path(name), "--out", self.Path(out))
        for out, order in (("each", names), ("listed", sorted(names)), ("back", names[::-1])):
            each = [word for name in order for word in ("--from", self.Path(name))]
            Run("survey", "--job", job, *each, "--out", self.Path(out))
        for name in ("survey.csv", "passes.csv", "checks.csv"):
            wanted = self.Read("whole/" + name)
            for out in ("first", "logger", "each", "listed", "back"):
                self.assertEqual(self.Read(out + "/" + name), wanted, out)
        self.assertIn("rig.002.lcm", self.Read("first/source.toml"))
        for name in ("whole", "rig"):
            done = Run("convert", self.Path(name + ".lcm"), self.Path(name + ".csv"))
            self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.Read("rig.csv"), self.Read("whole.csv"))
        os.remove(self.Path("rig.001.lcm"))
        for words in (("survey", "--job", job, "--from", self.Path("rig.lcm"), "--out",
                       self.Path("holed")), ("convert", self.Path("rig.lcm"), self.Path("o.csv"))):
            done = Run(*words)
            self.assertEqual(done.returncode, 2)
            self.assertRegex(done.stderr, r"rig\.001\.lcm: is missing, and .*rig\.002\.lcm is there")


if __name__ == "__main__":
    unittest.main()
