#!/usr/bin/env python3
"""What the program says at a terminal. terminal_test.py PROGRAM"""
import os
import unittest

from harness import DEMO, FreshProgramTest, Run


class Terminal(FreshProgramTest):
    def test_help_is_at_most_100_columns_and_names_no_path(self):
        commands = [line.split()[0] for line in Run("--help").stdout.split("Subcommands:")[1]
                    .splitlines() if line.startswith("  ") and not line.startswith("   ")]
        self.assertIn("survey", commands)
        for words in [[]] + [[command] for command in commands]:
            text = Run(*words, "--help").stdout
            for line in text.splitlines():
                self.assertLessEqual(len(line), 100, line)
            self.assertIn("Usage: wellgyro", text)

    def test_a_slip_is_named_with_what_seems_to_be_meant(self):
        for words, said in ((("survy", "--job", "x"), "'survy' is no command; is 'survey' meant?"),
                            (("survey", "--jop", "x"), "'--jop' is no option of survey; is '--job'"),
                            (("check", "--job-key"), "'--job-key' is no option of check"),
                            (("zzz",), "'zzz' is no command\n")):
            done = Run(*words)
            self.assertEqual(done.returncode, 1)
            self.assertIn(said, done.stderr)

    def test_version_names_the_commit(self):
        self.assertRegex(Run("--version").stdout, r"^wellgyro \d+\.\d+\.\d+ \(.+\)$")

    def test_a_source_is_not_written_over(self):
        self.Write("in.csv", "MD[m],INC[deg],AZI_TRUE[deg]\n0,0,0\n30,1.5,350\n")
        os.symlink(self.Path("in.csv"), self.Path("link.csv"))
        for target in ("in.csv", "link.csv"):
            done = Run("convert", self.Path("in.csv"), self.Path(target))
            self.assertEqual(done.returncode, 2)
            self.assertIn("choose another OUT", done.stderr)
        self.assertTrue(self.Read("in.csv").startswith("MD[m],INC"))

    def test_a_log_becomes_tables(self):
        done = Run("convert", os.path.join(DEMO, "run.lcm"), self.Path("run.csv"))
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertTrue(self.Read("run.csv").startswith("TOOL[ns],UTC[us],GX[rad/s]"))
        self.assertTrue(self.Read("run.depth.csv").startswith("UTC[us],MD[m]"))
        done = Run("check", self.Path("run.csv"), self.Path("run.depth.csv"))
        self.assertEqual(done.returncode, 0, done.stdout)
        done = Run("convert", os.path.join(DEMO, "run.lcm"), self.Path("run.las"))
        self.assertEqual(done.returncode, 1)
        done = Run("convert", os.path.join(DEMO, "run.lcm"), self.Path("absent/run.csv"))
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(self.Read("absent/run.csv"), self.Read("run.csv"))


if __name__ == "__main__":
    unittest.main()
