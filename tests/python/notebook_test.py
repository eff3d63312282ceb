#!/usr/bin/env python3
"""The package's notebooks, each run from its first cell to its last as a reader would, of the failing
run the first half, and what it has shown by then. The program is WELLGYRO_PROGRAM."""
import ast
import json
import os
import sys
import unittest

import matplotlib

matplotlib.use("Agg")

TOP = os.path.realpath(os.path.join(os.path.dirname(__file__), "..", ".."))
sys.path.insert(0, os.path.join(TOP, "tests", "support"))
from demonstration import Begun

FOLDER = os.path.join(TOP, "lib", "python", "notebooks")


def RunCell(source, names):
    """A cell, and as a notebook shows it the value of its last line."""
    cell = ast.parse(source)
    shown = cell.body.pop() if cell.body and isinstance(cell.body[-1], ast.Expr) else None
    exec(compile(cell, "cell", "exec"), names)
    if shown is not None:
        value = eval(compile(ast.Expression(shown.value), "cell", "eval"), names)
        getattr(value, "_repr_html_", value.__repr__)()


def RunNotebook(name):
    with open(os.path.join(FOLDER, name), encoding="utf-8") as file:
        cells = json.load(file)["cells"]
    names = {}
    for number, cell in enumerate(cells):
        assert not cell.get("outputs"), f"{name}: cell {number} has outputs, which belong nowhere"
        if cell["cell_type"] == "code":
            RunCell("".join(cell["source"]), names)
    return names


class Notebooks(unittest.TestCase):
    def test_there_are_three(self):
        self.assertEqual(sorted(os.listdir(FOLDER)),
                         ["bench-to-survey.ipynb", "failing-run.ipynb", "first-survey.ipynb"])

    def test_a_first_survey(self):
        seen = RunNotebook("first-survey.ipynb")
        self.assertIn(seen["result"].verdict, ("pass", "warn"), seen["result"].causes)
        self.assertLess(abs(seen["off"]), 3.5 * seen["last"].sigma_azimuth_deg)
        self.assertLess(seen["last"].sigma_azimuth_deg, 1)
        sigma = seen["result"].cov[-1].diagonal() ** 0.5
        self.assertTrue((abs(seen["wrong"]) < 3.5 * sigma).all(), (seen["wrong"], sigma))
        self.assertEqual(seen["last"].md_m, 200)

    def test_a_failing_run(self):
        with Begun(2) as demo:
            os.environ["WELLGYRO_DEMO"] = demo
            seen = RunNotebook("failing-run.ipynb")
        self.assertEqual(seen["wrong"].verdict, "fail")
        self.assertEqual(seen["right"].verdict, "pass", seen["right"].causes)
        self.assertEqual(seen["wrong"].diagnosis.iloc[0]["CODE"], "latitude")
        self.assertGreater(seen["moved"], 0.3)

    def test_from_the_bench_to_the_survey(self):
        seen = RunNotebook("bench-to-survey.ipynb")
        self.assertNotEqual(seen["result"].verdict, "fail", seen["result"].causes)
        stations = seen["stations"]
        self.assertEqual(len(stations), 12)
        self.assertTrue((abs(seen["off"]) < 3.5 * stations.sigma_azimuth_deg).all(), seen["off"])
        self.assertLess(stations.sigma_azimuth_deg.max(), 0.6)


if __name__ == "__main__":
    unittest.main()
