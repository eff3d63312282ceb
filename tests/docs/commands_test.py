#!/usr/bin/env python3
"""Holds every command that README and documentation show to the program: each option to the --help of
its command, and README's commands are run one after the other, as they stand, on files of the names
that they use. What speaks on a network is run by live_test and rig_test. commands_test.py PROGRAM"""
import os
import re
import shlex
import shutil
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "apps"))
from harness import DEMO, TOP, Move, Run, Simulation, Stop
from demonstration import Begun

PAGES = ["README.md", ".github/CONTRIBUTING.md"] + sorted(
    os.path.join("lib/docs", name) for name in os.listdir(os.path.join(TOP, "lib", "docs"))
    if name.endswith(".md") and name != "changelog.md")  # which names what is gone, too
OPTION = re.compile(r"(?<![\w-])--[a-z][a-z0-9-]*")


def Text(page):
    with open(os.path.join(TOP, page), encoding="utf-8") as file:
        return file.read()


def Blocks(page, *kinds):
    found = re.findall(r"^```(\w*)\n(.*?)^```$", Text(page), re.M | re.S)
    return [text for kind, text in found if kind in kinds]


def Commands(page):
    """Of the blocks, without "wellgyro"."""
    for block in Blocks(page, "", "sh"):
        for line in block.replace("\\\n", " ").splitlines():
            if line.startswith("wellgyro "):
                yield line.removeprefix("wellgyro ").split("  #")[0]


def Helps():
    """Options by command, those of all of calibrate's methods as calibrate's."""
    def Names(text):
        listed = text[text.index("\nSubcommands:"):] if "\nSubcommands:" in text else ""
        return re.findall(r"^  ([a-z0-9-]+) ", listed, re.M)

    top = Run("--help").stdout
    helps = {"": set(OPTION.findall(top))}
    for command in Names(top):
        text = Run(command, "--help").stdout
        helps[command] = set(OPTION.findall(text)) | {"--help"}
        for method in Names(text):
            helps[command] |= set(OPTION.findall(Run(command, method, "--help").stdout))
    return helps


def Survey(name, end_md, *, lean=20.0, azimuth=45.0, north=0.0, begin_md=0):
    """Bends to its lean over the first 600 m."""
    with open(name, "w", encoding="utf-8") as file:
        file.write("MD[m],INC[deg],AZI_TRUE[deg],TVD[m],N[m],E[m]\n")
        for md in range(begin_md, end_md + 1, 30):
            place = f"{begin_md},{north},0" if md == begin_md else ",,"
            file.write(f"{md},{lean * min(1, md / 600)},{azimuth},{place}\n")


class ShownCommands(unittest.TestCase):
    def test_options_are_those_of_the_help(self):
        helps, checked, problems = Helps(), 0, []
        self.assertGreater(len(helps), 15)
        everywhere = set().union(*helps.values())
        for page in PAGES:
            shown = list(Commands(page))
            for quoted in re.findall(r"(?<!`)`([^`]+)`(?!`)", re.sub(r"^```.*?^```$", "", Text(page),
                                                                    flags=re.M | re.S)):
                shown.append(" ".join(quoted.split()).removeprefix("wellgyro "))
            for line in shown:
                word = line.split(" ")[0]
                if word not in helps and not word.startswith("--"):
                    continue  # of another program, or no command
                for option in OPTION.findall(line):
                    checked += 1
                    if option not in helps.get(word, everywhere):
                        problems.append(f"{page}: {line}: no {option}")
        self.assertFalse(problems, "\n".join(problems))
        self.assertGreater(checked, 100)

    def test_the_readme_runs_as_it_stands(self):
        folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, folder)
        os.chdir(folder)
        os.symlink(os.path.join(TOP, "data"), "data")
        self.Prepare()
        ran = set()
        for line in Commands("README.md"):
            words = shlex.split(line)
            if any(word.startswith("udpm:") for word in words):
                continue
            done = Run(*words, timeout=300)
            # 4: two wells come too near, two surveys differ.
            expected = (0, 3, 4) if words[0] in ("clearance", "compare", "merge") else (0,)
            self.assertIn(done.returncode, expected, line + "\n" + done.stdout + done.stderr)
            self.assertNotIn(".cc:", done.stderr, "a line of the solver's log")
            ran.add(words[0])
            if words[0] == "calibrate":
                self.assertIn(done.stdout.strip(), "\n".join(Blocks("README.md", "")))
        self.assertEqual(ran, {"simulate", "survey", "report", "convert", "allan", "uncertainty", "clearance",
                               "compare", "merge", "calibrate"})
        for made in ("result/survey.csv", "report.html", "well.las", "well.xml", "avar.svg",
                     "range/covariance.csv", "clear/clearance.csv", "compared/compare.csv",
                     "merged/definitive.csv", "accel.toml"):
            self.assertGreater(os.path.getsize(made), 100, made)

    def Prepare(self):
        """Files of the names that the README takes for those of its reader; its job is the README's."""
        with Begun() as demo:
            done = Run("convert", os.path.join(demo, "run.lcm"), "memory.csv")
        self.assertEqual(done.returncode, 0, done.stderr)
        os.rename("memory.depth.csv", "tally.csv")
        shutil.copy(os.path.join(DEMO, "noise.toml"), "noise.toml")
        with open("raw.txt", "w", encoding="utf-8") as file:
            file.writelines(f"{100 * k} {0.5 * k} 120.0\n" for k in range(30))
        with open("still.toml", "w", encoding="utf-8") as file:
            file.write(Simulation("start_md_m = 50.0\n" + Stop(900), "imu_hz = 50.0\n"))
        done = Run("simulate", "--job", "still.toml", "--out", "still.lcm")
        self.assertEqual(done.returncode, 0, done.stderr)
        for name, end_md, north in (("plan", 1800, 0), ("a", 1500, 400), ("b", 1500, 3000)):
            Survey(name + ".csv", end_md, north=north)
        Survey("sidetrack.csv", 1800, lean=26, begin_md=900)
        Survey("gyro.csv", 1500)
        Survey("mwd.csv", 1800)
        for text in Blocks("README.md", "toml"):
            for format_, name in (("job/1", "job.toml"), ("clearance/1", "clearance.toml"),
                                  ("merge/1", "plan.toml")):
                if f'"wellgyro.{format_}"' in text:
                    with open(name, "w", encoding="utf-8") as file:
                        file.write(text)


if __name__ == "__main__":
    unittest.main()
