#!/usr/bin/env python3
"""Runs the commands that the documentation shows, page by page, each in an empty folder: blocks of
sh line by line, a block of toml being the job.toml that the page has saved by then; the
demonstration's log is its first sixth. tutorial_test.py PROGRAM"""
import os
import re
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "apps"))
from harness import PROGRAM, TOP
from demonstration import Begun

DOCS = os.path.join(TOP, "lib", "docs")


def Blocks(name):
    with open(os.path.join(DOCS, name), encoding="utf-8") as file:
        return re.findall(r"^```(sh|toml)\n(.*?)^```$", file.read(), re.M | re.S)


class Tutorial(unittest.TestCase):
    def Run(self, page):
        commands = 0
        with tempfile.TemporaryDirectory() as folder, Begun() as demo:
            for kind, text in Blocks(page):
                if kind == "toml":
                    with open(os.path.join(folder, "job.toml"), "w", encoding="utf-8") as job:
                        job.write(text)
                    continue
                for line in text.replace("\\\n", " ").splitlines():
                    line = line.replace("$DEMO", demo)
                    words = line.split()
                    self.assertEqual(words[0], "wellgyro")
                    done = subprocess.run([PROGRAM, *words[1:]], cwd=folder, capture_output=True,
                                          text=True, timeout=300, check=False)
                    self.assertEqual(done.returncode, 0, line + "\n" + done.stdout + done.stderr)
                    commands += 1
            self.assertGreater(commands, 0)
            return {name: self.Size(folder, name) for name in ("first.las", "result/survey.csv")}

    def Size(self, folder, name):
        with open(os.path.join(folder, name), encoding="utf-8") as file:
            return len(file.readlines())

    def test_first_survey(self):
        sizes = self.Run("first-survey.md")
        self.assertGreater(sizes["result/survey.csv"], 30)
        self.assertGreater(sizes["first.las"], sizes["result/survey.csv"])

    def test_first_survey_of_a_tool_without_utc(self):
        job = next(text for kind, text in Blocks("first-survey.md") if kind == "toml")
        with tempfile.TemporaryDirectory() as folder, Begun(1) as demo:
            def Do(*words):
                done = subprocess.run([PROGRAM, *words], cwd=folder, capture_output=True, text=True,
                                      timeout=300, check=False)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

            def Path(name):
                return os.path.join(folder, name)

            with open(Path("job.toml"), "w", encoding="utf-8") as out:
                out.write(job)
            Do("convert", os.path.join(demo, "run.lcm"), "tool.csv")
            with open(Path("tool.csv"), encoding="utf-8", newline="") as file:
                rows = [line.split(",") for line in file]
            utc = rows[0].index("UTC[us]")
            with open(Path("memory.csv"), "w", encoding="utf-8", newline="") as out:
                out.writelines(",".join(row[:utc] + row[utc + 1:]) for row in rows)
            Do("survey", "--job", "job.toml", "--from", "memory.csv", "--from", "tool.depth.csv",
               "--out", "result")
            with open(Path("result/run.toml"), encoding="utf-8") as file:
                self.assertIn("[clock_by_stops]", file.read())


if __name__ == "__main__":
    unittest.main()
