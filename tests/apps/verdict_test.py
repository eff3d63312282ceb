"""No wrong survey leaves as good: what the program says of a survey, and its exit code."""
import os
import unittest

from harness import Job, Move, ProgramTest, Run, Simulation, Stop

STREAMS = "imu_hz = 10.0\ndepth_hz = 2.0\n"
TOOL = "accel_noise_mps2_per_sqrt_hz = 2e-4\n"
JOB = Job(25.0).replace("accel_noise_mps2_per_sqrt_hz = 0", "accel_noise_mps2_per_sqrt_hz = 2e-4")
FLIGHT = Simulation(Stop(120) + Move(200) + Stop(120), STREAMS, end_md_m=250.0, tool=TOOL)
CRASH = os.path.join(os.path.dirname(__file__), "..", "..", "..", "shared", "reference", "reports",
                     "adjustment-crash")


class Verdict(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.job = cls.Write("job.toml", JOB)

    def Survey(self, name, faults="", *, job=None, options=()):
        simulation = self.Write(name + ".toml", FLIGHT + faults)
        log = self.Path(name + ".lcm")
        self.Make("simulate", "--job", simulation, "--out", log)
        return Run("survey", "--job", job or self.job, "--from", log, "--out", self.Path(name),
                   *options)

    def test_a_good_survey_ends_with_its_verdict(self):
        done = self.Survey("good")
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
        self.assertRegex(done.stdout.splitlines()[-1], "^verdict (pass|warn)")
        run = self.Toml("good", "run.toml")
        self.assertIn(run["verdict"]["verdict"], ("pass", "warn"))
        self.assertEqual(run["verdict"]["false_alarm_rate"], 0.01)
        self.assertEqual(run["run"][0]["verdict"], run["verdict"]["verdict"])
        for row in self.Rows("good", "survey.csv"):
            self.assertNotIn("unfit", row["QUALITY"])

    def test_a_dead_gyro_is_exit_4_and_no_station_has_a_sigma(self):
        done = self.Survey("dead", '[[fault]]\ncause = "gyro_dead"\naxis = "x"\n',
                           options=("--formats", "las,p717,witsml,witsml21,compass"))
        self.assertEqual(done.returncode, 4, done.stdout + done.stderr)
        last = done.stdout.splitlines()[-1]
        self.assertTrue(last.startswith("verdict fail: "), last)
        self.assertIn("a gyro axis does not answer", last)
        run = self.Toml("dead", "run.toml")
        self.assertEqual(run["verdict"]["verdict"], "fail")
        self.assertTrue(any("does not answer" in cause for cause in run["verdict"]["causes"]))
        rows = self.Rows("dead", "survey.csv")
        self.assertGreater(len(rows), 3)
        for row in rows[1:]:
            self.assertIn("unfit", row["QUALITY"])
            for column in ("VAR_NN[m2]", "COV_EV[m2]", "SIG_INC[deg]", "SIG_AZI[deg]"):
                self.assertEqual(row[column], "")
        exported = [name for name in os.listdir(self.Path("dead"))
                    if name.startswith("survey") and name != "survey.json"]
        self.assertEqual(len(exported), 6, exported)
        for name in exported:
            if name != "survey.csv":
                self.assertIn("verdict fail", self.Read("dead", name), name)
        self.assertEqual(Run("check", self.Path("dead", "survey.csv")).returncode, 0)
        # What failed is not to be tied on to.
        tied = self.Write("tied.toml", JOB + '[tie_in]\nsurvey = "dead/survey.csv"\n')
        done = Run("survey", "--job", tied, "--from", self.Path("dead.lcm"), "--out",
                   self.Path("tied"))
        self.assertEqual(done.returncode, 2)
        self.assertIn("unfit", done.stderr)

    def test_4_wins_over_3(self):
        log = self.Path("cut.lcm")
        self.Survey("whole", '[[fault]]\ncause = "gyro_dead"\naxis = "y"\n')
        with open(self.Path("whole.lcm"), "rb") as whole, open(log, "wb") as cut:
            cut.write(whole.read()[:-7])
        done = Run("survey", "--job", self.job, "--from", log, "--out", self.Path("cut"))
        self.assertEqual(done.returncode, 4, done.stdout + done.stderr)
        self.assertIn("losses or damage", done.stderr)

    def test_a_job_without_noise_is_told(self):
        silent = self.Write("silent.job.toml", JOB.replace(
            "[noise]\nangle_random_walk_deg_per_sqrt_h = 0.005\n", ""))
        done = self.Survey("silent", job=silent)
        self.assertIn("the job states no [noise]", done.stdout.splitlines()[-1])

    # Dated 2026-11-22: a whirl on which the adjustment's residuals have no value.
    @unittest.skipUnless(os.path.isdir(CRASH), "no reports of use at " + CRASH)
    def test_a_whirl_is_a_verdict(self):
        done = Run("survey", "--job", os.path.join(CRASH, "job.toml"), "--from",
                   os.path.join(CRASH, "run.lcm"), "--out", self.Path("whirl"))
        self.assertIn(done.returncode, (0, 4), done.stdout + done.stderr)
        self.assertTrue(done.stdout.splitlines()[-1].startswith("verdict "))
        self.assertTrue(os.path.isfile(self.Path("whirl", "survey.csv")))
        for line in done.stderr.splitlines():
            self.assertTrue(line.startswith("wellgyro: "), line)


if __name__ == "__main__":
    unittest.main()
