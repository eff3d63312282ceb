#!/usr/bin/env python3
"""Surveys the bundled log and holds the end of the hole against the truth. Apart from the program's
other tests because it is not run under the sanitizers, where it took a minute: what it does there,
their shorter logs do. demonstration_test.py PROGRAM [--keep FOLDER | --moved]
--keep      the result, for other tests
--moved     the numbers of the survey are meant to be others: notes them, to be told in the change log"""
import csv
import os
import re
import shutil
import sys
import unittest

from harness import DEMO, ProgramTest, Run

# Of these tables the keys are the job's own, or codes.
FREE = {"identity", "faults"}
FILES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "lib", "docs", "files.md")


NOTED = os.path.join(os.path.dirname(os.path.abspath(__file__)), "demonstration_noted.csv")
# What is noted of every tenth station, and the column of its sigma or variance.
NUMBERS = {"INC[deg]": "SIG_INC[deg]", "AZI_TRUE[deg]": "SIG_AZI[deg]", "N[m]": "VAR_NN[m2]",
           "E[m]": "VAR_EE[m2]", "TVD[m]": "VAR_VV[m2]"}

KEEP = sys.argv[sys.argv.index("--keep") + 1] if "--keep" in sys.argv else None
if KEEP:
    del sys.argv[-2:]
MOVED = "--moved" in sys.argv
if MOVED:
    sys.argv.remove("--moved")


def Sigma(row, column):
    return float(row[column]) ** (0.5 if column.startswith("VAR") else 1)


def Keys(table):
    """Names of all values below a table, and of those in lists of tables."""
    for key, value in table.items():
        if key in FREE:
            continue
        tables = value if isinstance(value, list) else [value]
        tables = [entry for entry in tables if isinstance(entry, dict)]
        if not tables and not isinstance(value, dict):
            yield key
        for entry in tables:
            yield from Keys(entry)


class Demonstration(ProgramTest):
    def test_its_end_is_where_it_says(self):
        done = Run("survey", "--job", os.path.join(DEMO, "job.toml"), "--from",
                   os.path.join(DEMO, "run.lcm"), "--out", self.Path("demo"), "--report")
        self.assertEqual(done.returncode, 0, done.stderr)
        if KEEP:
            shutil.rmtree(KEEP, ignore_errors=True)
            shutil.copytree(self.Path("demo"), KEEP)
        # Dated 2026-11-22: it was, though an azimuth is given.
        self.assertIs(self.Toml("demo", "run.toml")["run"][0]["fit"]["ambiguous"], False)
        with open(FILES, encoding="utf-8") as page:
            explained = set(re.findall(r"`(\w+)`", page.read()))
        for name in ("run.toml", "source.toml"):
            self.assertFalse(set(Keys(self.Toml("demo", name))) - explained, name)
        deepest = max(self.Rows(DEMO, "truth.csv"), key=lambda row: float(row["MD[m]"]))
        last = self.Rows("demo", "survey.csv")[-1]
        for column, variance in (("N[m]", "VAR_NN[m2]"), ("E[m]", "VAR_EE[m2]"),
                                 ("TVD[m]", "VAR_VV[m2]")):
            sigma = float(last[variance]) ** 0.5
            self.assertLess(sigma, 2)
            self.assertLess(abs(float(last[column]) - float(deepest[column])), 3 * sigma, column)
        self.IsAsNoted(self.Rows("demo", "survey.csv")[::10])
        made = self.Path("again.lcm")
        self.assertEqual(Run("simulate", "--job", os.path.join(DEMO, "simulation.toml"), "--out",
                             made, "--truth", self.Path("again.csv")).returncode, 0)
        self.assertEqual(os.path.getsize(made), os.path.getsize(os.path.join(DEMO, "run.lcm")))

    def IsAsNoted(self, stations):
        """No number moves by more than a hundredth of its sigma, in which compilers differ, without
        --moved and a word in lib/docs/changelog.md. Whether it is right the truth says."""
        columns = ["MD[m]", *NUMBERS, *NUMBERS.values()]
        if MOVED:
            with open(NOTED, "w", newline="", encoding="utf-8") as file:
                noted = csv.DictWriter(file, columns, extrasaction="ignore", lineterminator="\n")
                noted.writeheader()
                noted.writerows(stations)
        noted = self.Rows(NOTED)
        self.assertEqual([row["MD[m]"] for row in stations], [row["MD[m]"] for row in noted])
        most = 0
        for now, then in zip(stations, noted):
            for column, of_sigma in NUMBERS.items():
                sigma, digit = Sigma(then, of_sigma), 10.0 ** -len(then[column].split(".")[1])
                off = float(now[column]) - float(then[column])
                off = (off + 180) % 360 - 180 if column.startswith("AZI") else off
                self.assertLessEqual(abs(off), digit + 0.01 * sigma, f"{column} at MD {now['MD[m]']}")
                if sigma > 0:
                    most = max(most, (abs(off) - digit) / sigma, abs(Sigma(now, of_sigma) / sigma - 1))
        print(f"numbers and sigmas are within {most:.5f} sigmas of what was noted")
        self.assertLess(most, 0.01)


if __name__ == "__main__":
    unittest.main()
