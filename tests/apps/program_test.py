#!/usr/bin/env python3
"""Runs the program as a user does: results, exit codes, sentences. program_test.py PROGRAM"""
import filecmp
import math
import os
import random
import shutil
import unittest

from harness import RESULT, Job, Move, ProgramTest, Run, Simulation, Stop

# Of seed 3 the way down to 40 m, alone, is 3.8 sigmas off the north above it.
SIMULATION = Simulation(Stop(120) + Move(300) + Stop(20),
                        "imu_hz = 20.0\ndepth_hz = 4.0\nbatch = 20\n", seed=4)
SHORT_STOP = SIMULATION.replace(Stop(120), Stop(20))
JOB = Job(25.0)


class Program(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.job = cls.Write("job.toml", JOB)
        cls.log = cls.Log("run", SIMULATION)
        cls.bytes = cls.Bytes("run.lcm")

    @classmethod
    def Log(cls, name, simulation):
        """The log of a simulation, NAME.toml to NAME.lcm."""
        job, log = cls.Write(name + ".toml", simulation), cls.Path(name + ".lcm")
        cls.Make("simulate", "--job", job, "--out", log)
        return log

    def Survey(self, log, out, job=None):
        return Run("survey", "--job", job or self.job, "--from", log, "--out", self.Path(out))

    def test_a_survey_of_the_truth(self):
        done = self.Survey(self.log, "good")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        rows = self.Rows("good", "survey.csv")
        self.assertEqual([float(r["MD[m]"]) for r in rows], [25.0 * k for k in range(13)])
        for row in rows[1:]:
            self.assertAlmostEqual(float(row["INC[deg]"]), 25.0, delta=0.01)
            sigma = float(row["SIG_AZI[deg]"])
            self.assertGreater(sigma, 0.01)
            self.assertLess(sigma, 0.5)
            self.assertAlmostEqual(float(row["AZI_TRUE[deg]"]), 300.0, delta=5 * sigma)
        self.assertEqual(rows[0]["KIND"], "tie_in")

    def test_the_same_log_twice_gives_the_same_bytes(self):
        for out in ("one", "two"):
            self.assertEqual(self.Survey(self.log, out).returncode, 0)
        names = sorted(os.listdir(self.Path("one")))
        self.assertEqual(names, sorted([*RESULT, "source.toml", "survey.json"]))
        same, differ, odd = filecmp.cmpfiles(self.Path("one"), self.Path("two"), names,
                                             shallow=False)
        self.assertEqual((len(same), differ, odd), (len(names), [], []))
        known = Run("check", *(self.Path("one", name) for name in names))
        self.assertNotIn("unknown kind", known.stdout)

    def test_run_toml_names_the_adjuster(self):
        self.assertEqual(self.Survey(self.log, "adjusted").returncode, 0)
        self.assertEqual(self.Toml("adjusted", "run.toml")["adjuster"],
                         "least squares of rotations")

    def test_a_pipe_is_as_good_as_a_file(self):
        self.assertEqual(self.Survey(self.log, "file").returncode, 0)
        with open(self.log, "rb") as log:
            done = Run("survey", "--job", self.job, "--from", "-", "--out", self.Path("pipe"),
                       stdin=log)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.SameAs("file", "pipe")

    def test_a_log_cut_at_any_byte_is_a_shorter_survey(self):
        # Behind the last mark depth is a guess, whatever the job says of depths that are marked.
        whole = self.Survey(self.log, "whole")
        self.assertEqual(whole.returncode, 0)
        chance = random.Random(1)
        ends = [k for k in range(len(self.bytes)) if self.bytes[k:k + 4] == b"\xed\xa1\xda\x01"]
        cuts = [chance.randrange(1, len(self.bytes)) for _ in range(10)]
        surveys = 0
        for cut in cuts + [ends[len(ends) // 2], ends[-1]]:
            with self.subTest(cut=cut):
                log = self.Write("cut.lcm", self.bytes[:cut])
                shutil.rmtree(self.Path("cut"), ignore_errors=True)
                done = self.Survey(log, "cut")
                self.assertIn(done.returncode, (0, 2, 3), done.stderr)
                if done.returncode == 2:
                    self.assertTrue(done.stderr.startswith("wellgyro: "), done.stderr)
                    continue
                surveys += 1
                self.assertEqual(done.returncode, 0 if cut in ends else 3)
                rows, all_rows = self.Rows("cut", "survey.csv"), self.Rows("whole", "survey.csv")
                for row, full in zip(rows[:-2], all_rows):
                    self.assertEqual(row["MD[m]"], full["MD[m]"])
                    self.assertAlmostEqual(float(row["INC[deg]"]), float(full["INC[deg]"]),
                                           delta=0.02)

        self.assertGreater(surveys, len(cuts) // 3)
        begin = self.Survey(self.Write("begin.lcm", self.bytes[:100]), "begin")
        self.assertEqual(begin.returncode, 2)
        self.assertIn("no samples came", begin.stderr)
        self.assertIn("begin.lcm ends inside an event", begin.stderr)

    def test_flipped_bytes_never_crash_and_are_told(self):
        chance = random.Random(2)
        told = 0
        for round_ in range(10):
            damaged = bytearray(self.bytes)
            for _ in range(8):
                damaged[chance.randrange(len(damaged))] ^= 1 << chance.randrange(8)
            log = self.Write("flipped.lcm", bytes(damaged))
            shutil.rmtree(self.Path("flipped"), ignore_errors=True)
            done = self.Survey(log, "flipped")
            self.assertIn(done.returncode, (0, 2, 3, 4), f"{round_}: {done.stderr}")
            if done.returncode in (3, 4):
                told += 1
                self.assertTrue(self.Toml("flipped", "source.toml").get("fault") or
                                self.Toml("flipped", "run.toml")["faults"], done.stderr)
        self.assertGreater(told, 0)

    def test_what_is_no_log_is_named(self):
        for name, content, word in (("empty.lcm", b"", "empty"), ("text.lcm", b"hello " * 50, "text"),
                                    ("zip.lcm", b"PK\x03\x04" + bytes(range(256)), "")):
            done = self.Survey(self.Write(name, content), "nothing")
            self.assertEqual(done.returncode, 2)
            self.assertIn(name, done.stderr)
            self.assertIn(word, done.stderr)
            self.assertFalse(os.path.exists(self.Path("nothing")))
        done = self.Survey(self.Path("missing.lcm"), "nothing")
        self.assertEqual(done.returncode, 2)
        self.assertIn("No such file", done.stderr)

    def test_the_motion_itself_finds_north(self):
        done = self.Survey(self.Log("moving", SHORT_STOP), "moving")
        self.assertEqual(done.returncode, 0, done.stderr)
        last = self.Rows("moving", "survey.csv")[-1]
        sigma = float(last["SIG_AZI[deg]"])
        self.assertLess(sigma, 1)
        self.assertAlmostEqual(float(last["AZI_TRUE[deg]"]), 300.0, delta=4 * sigma)

    def test_no_north_is_a_sentence(self):
        # A straight horizontal hole turns alike under an azimuth and under its mirror.
        flat = SHORT_STOP.replace("inclination_deg = 25.0", "inclination_deg = 90.0")
        done = self.Survey(self.Log("flat", flat), "flat")
        self.assertEqual(done.returncode, 2)
        self.assertIn("no north", done.stderr)

    def test_a_gap_above_the_survey_is_named(self):
        deep = self.Log("deep", SIMULATION.replace("[run]\n", "[run]\nstart_md_m = 60.0\n"))
        done = self.Survey(deep, "deep")
        self.assertEqual(done.returncode, 2)
        self.assertIn("60.0", done.stderr)
        tied = self.Write("tied.toml", JOB + "[tie_in]\ninclination_deg = 25.0\n"
                          "azimuth_true_deg = 300.0\n")
        done = self.Survey(deep, "deep", tied)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(float(self.Rows("deep", "survey.csv")[1]["MD[m]"]), 75.0)

    def test_mistakes_in_the_job_name_their_line(self):
        for text, line, word in ((JOB + "[typo]\n", 20, "typo"),
                                 (JOB.replace("61.0", "'north'"), 4, "latitude_deg"),
                                 (JOB.replace("25.0", "-1"), 19, "every_m")):
            job = self.Write("bad.toml", text)
            done = self.Survey(self.log, "bad", job)
            self.assertEqual(done.returncode, 2)
            self.assertIn(f"bad.toml:{line}:", done.stderr)
            self.assertIn(word, done.stderr)

    def test_an_accepted_survey_is_never_written_over(self):
        job = self.Write("accepted.toml", JOB + "[[event]]\nevent = \"accept\"\n"
                         "utime_us = 1767225900000000\n")
        self.assertEqual(self.Survey(self.log, "accepted", job).returncode, 0)
        rows = self.Rows("accepted", "passes.csv")
        self.assertEqual({row["STATUS"] for row in rows}, {"definitive"})
        before = os.stat(self.Path("accepted", "survey.csv")).st_mtime_ns
        done = self.Survey(self.log, "accepted")
        self.assertEqual(done.returncode, 2)
        self.assertIn("choose a new --out", done.stderr)
        self.assertEqual(os.stat(self.Path("accepted", "survey.csv")).st_mtime_ns,
                         before)

    def test_tables_of_averages_make_a_survey(self):
        latitude, inclination, toolface = math.radians(61.0), math.radians(30.0), math.radians(20.0)
        rate, gravity = 15.0410672, 9.8192
        rows = ["UTC[s],DURATION[s],MD[m],GX[deg/h],GY[deg/h],GZ[deg/h],AX[m/s2],AY[m/s2],"
                "AZ[m/s2],SIG_GX[deg/h],SIG_GY[deg/h],SIG_GZ[deg/h]"]
        ci, si = math.cos(inclination), math.sin(inclination)
        ct, st = math.cos(toolface), math.sin(toolface)
        for k, azimuth in enumerate((100.0, 102.0, 105.0)):
            ca, sa = math.cos(math.radians(azimuth)), math.sin(math.radians(azimuth))
            north, down = rate * math.cos(latitude), -rate * math.sin(latitude)
            high = north * ca * ci - down * si  # of the Earth's rate; right is -north sin A
            right = -north * sa
            w = (high * ct + right * st, -high * st + right * ct, north * ca * si + down * ci)
            f = (gravity * si * ct, -gravity * si * st, -gravity * ci)
            rows.append(",".join(f"{value:.9g}" for value in (
                1700000000 + 600 * k, 60, 100 + 30 * k, *w, *f, 0.02, 0.02, 0.02)))
        table = self.Write("still.csv", "\n".join(rows) + "\n")
        job = self.Write("points.toml", JOB.replace("every_m = 25.0", "every_m = 0\nat_stops = true")
                         + "[tie_in]\nmd_m = 90.0\ntvd_m = 80.0\ninclination_deg = 30.0\n"
                           "azimuth_true_deg = 100.0\n")
        done = Run("survey", "--job", job, "--from", table, "--out", self.Path("points"))
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        stations = self.Rows("points", "survey.csv")
        self.assertEqual([row["KIND"] for row in stations], ["tie_in", "still", "still", "still"])
        for row, azimuth in zip(stations[1:], (100.0, 102.0, 105.0)):
            self.assertAlmostEqual(float(row["INC[deg]"]), 30.0, delta=0.001)
            self.assertAlmostEqual(float(row["AZI_TRUE[deg]"]), azimuth, delta=0.05)
        done = Run("check", table)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("averages at rest, whole", done.stdout)
        self.assertIn("still.csv", self.Read("points", "run.toml"))
        broken = self.Write("broken.csv", "\n".join([rows[0], rows[1].replace("100", "a", 1)]))
        done = Run("survey", "--job", job, "--from", broken, "--out", self.Path("broken"))
        self.assertEqual(done.returncode, 2)
        self.assertIn("broken.csv:2:", done.stderr)

    def test_check_says_what_files_are(self):
        done = Run("check", self.job, self.log, self.Path("run.toml"))
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("a wellgyro job", done.stdout)
        self.assertIn("imu_batch_t", done.stdout)
        cut = self.Write("cut_for_check.lcm", self.bytes[:-7])
        done = Run("check", cut)
        self.assertEqual(done.returncode, 3, done.stdout)
        done = Run("check", self.Write("empty", b""))
        self.assertEqual(done.returncode, 2)
        self.assertIn("empty", done.stdout)
        # A log of which nothing can be read is either a log or not, and is named once.
        stub = self.Write("stub.lcm", self.bytes[:20])
        for arguments in (("check", stub), ("survey", "--job", self.job, "--from", stub, "--out",
                                            self.Path("from_stub")),
                          ("survey", "--job", self.job, "--from", self.Path("no_such.lcm"),
                           "--out", self.Path("from_nothing"))):
            done = Run(*arguments)
            self.assertEqual(done.returncode, 2)
            said = done.stdout + done.stderr
            self.assertEqual(said.count(arguments[1 if len(arguments) == 2 else 4]), 1, said)
            self.assertFalse("an LCM log" in said and "no LCM log" in said, said)

    def test_check_says_what_it_cannot_know(self):
        self.assertEqual(self.Survey(self.log, "checked").returncode, 0)
        lines = self.Read("checked", "survey.csv").splitlines(keepends=True)
        done = Run("check", self.Write("shorter.csv", "".join(lines[:6])))
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertIn("a cut could not be seen", done.stdout)
        self.assertNotIn("whole", done.stdout)
        done = Run("check", self.Write("closed.csv", "".join(lines) + "\n\n"))
        self.assertEqual(done.returncode, 0, done.stdout)
        for text, says in ((JOB.replace("job/1", "job/2"), "this version does not know"),
                           (JOB.split("\n", 1)[1], 'format = "wellgyro.job/1"')):
            done = Run("check", self.Write("unknown.toml", text))
            self.assertEqual(done.returncode, 2, done.stdout)
            self.assertIn(says, done.stdout)

    def test_a_survey_is_not_written_over_what_it_came_from(self):
        os.makedirs(self.Path("kept"))
        for name in ("job.toml", "run.lcm"):
            shutil.copy(self.Path(name), self.Path("kept"))
        os.rename(self.Path("kept", "job.toml"), self.Path("kept", "run.toml"))
        done = self.Survey(self.log, "kept", self.Path("kept", "run.toml"))
        self.assertEqual(done.returncode, 1, done.stderr)
        os.rename(self.Path("kept", "run.lcm"), self.Path("kept", "survey.csv"))
        done = self.Survey(self.Path("kept", "survey.csv"), "kept")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertEqual(self.Bytes("kept", "survey.csv"), self.bytes)
        self.assertEqual(sorted(os.listdir(self.Path("kept"))), ["run.toml", "survey.csv"])

    def test_a_report_is_not_written_over_what_it_tells(self):
        self.assertEqual(self.Survey(self.log, "told").returncode, 0)
        before, page = self.Read("told", "survey.csv"), self.Path("page.html")
        for options in (["--out", self.Path("told", "survey.csv")],
                        ["--out", page, "--json", self.Path("told", "run.toml")],
                        ["--out", page, "--json", page],
                        ["--out", page, "--other", page]):
            done = Run("report", self.Path("told"), *options)
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertFalse(os.path.exists(page))
        self.assertEqual(self.Read("told", "survey.csv"), before)

    def test_an_older_result_leaves_nothing_that_says_what_was(self):
        out = ["--from", self.log, "--out", self.Path("anew")]
        done = Run("survey", "--job", self.job, *out, "--formats", "las,petrel", "--report")
        self.assertEqual(done.returncode, 0, done.stderr)
        older = set(os.listdir(self.Path("anew")))
        self.assertEqual({os.path.basename(line[6:]) for line in done.stdout.splitlines()
                          if line.startswith("wrote ")}, older)
        own = {"notes.txt", "survey.txt", "mine.las"}
        for name in own:
            self.Write(os.path.join("anew", name), "mine")
        self.assertEqual(Run("survey", "--job", self.job, *out).returncode, 0)
        gone = {"survey.las", "survey.dev", "report.html"}
        self.assertLess(gone, older)
        self.assertEqual(set(os.listdir(self.Path("anew"))), (older - gone) | own)

    def test_what_is_no_sensor_table_is_named(self):
        lacking = self.Write("lacking.csv", "UTC[s],GX[deg/h]\n1,2\n")
        other = self.Write("other.csv", "a,b,c\n1,2,3\n")
        depth = self.Write("depth.csv", "UTC[us],MD[m]\n1,2\n")
        head = "UTC[s],GX[deg/h],GY[deg/h],AX[m/s2],AY[m/s2],AZ[m/s2]\n"
        semicolons = self.Write("semicolons.csv", head.replace(",", ";") + "1,5;2;3;4;5;6\n")
        back = self.Write("back.csv", head + "2,0,0,0,0,9.8\n1,0,0,0,0,9.8\n")
        for files, says in (((self.log, self.log), "is named twice"),
                            ((self.log, depth), "an LCM log, no table"),
                            ((lacking,), "lacks GY, AX, AY, AZ"),
                            ((other,), "no LCM log, nor a table"),
                            ((other, self.log), "no LCM log, nor a table"),
                            ((semicolons,), "';' stands between its fields"),
                            ((back,), "time goes back from row to row"),
                            ((other, depth), "unknown kind, no table")):
            sources = [word for file in files for word in ("--from", file)]
            done = Run("survey", "--job", self.job, *sources, "--out", self.Path("no_table"))
            self.assertEqual(done.returncode, 2)
            self.assertIn(says, done.stderr)
            self.assertTrue(done.stderr.isascii(), done.stderr)

    def test_the_command_line(self):
        self.assertEqual(Run().returncode, 1)
        self.assertEqual(Run("survey", "--no-such-option").returncode, 1)
        self.assertEqual(Run("--version").stdout.split()[0], "wellgyro")
        listed = Run("--help").stdout.split("Subcommands:")[1]
        commands = [line.split()[0] for line in listed.splitlines() if line.startswith("  ")
                    and line[2] != " "]
        self.assertEqual(sorted(commands), ["allan", "bridge", "calibrate", "check",
                                            "clearance", "compare", "convert",
                                            "merge", "models",
                                            "north", "plan", "record", "report", "send",
                                            "simulate", "survey",
                                            "uncertainty", "watch"])
        for words in (["surveyy"], ["calibrate", "toool"]):
            done = Run(*words, "--help")
            self.assertEqual((done.returncode, done.stdout), (1, ""))
            self.assertIn("meant?", done.stderr)
        for command in commands:
            done = Run(command, "--help")
            self.assertEqual(done.returncode, 0)
            self.assertIn(f"wellgyro {command}", done.stdout, "an example")


if __name__ == "__main__":
    unittest.main()
