#!/usr/bin/env python3
"""wellgyro allan as a user runs it: files, exit codes, sentences. allan_test.py PROGRAM"""
import math
import os
import random
import struct
import subprocess
import unittest
import xml.etree.ElementTree as ElementTree

from harness import FreshProgramTest, Run


def Allan(*arguments):
    return Run("allan", *arguments)


def White(samples, seed):
    generator = random.Random(seed)
    return [generator.gauss(0, 6) for _ in range(samples)]


class AllanOfFiles(FreshProgramTest):
    def PutDoubles(self, name, values):
        return self.Write(name, struct.pack(f"<{len(values)}d", *values))

    def test_writes_noise_table_and_plot(self):
        data = self.PutDoubles("log.f64", White(50000, 1))
        ran = Allan("--data", data, "--rate-hz", "100", "--unit", "deg_per_h",
                    "--out", self.Path("n.toml"), "--table", self.Path("t.csv"),
                    "--plot", self.Path("p.svg"))
        self.assertEqual(ran.returncode, 0, ran.stderr)
        noise = self.Toml("n.toml")
        self.assertEqual(noise["format"], "wellgyro.noise/1")
        c = noise["coefficients"]
        # 6 deg/h at 100 Hz: 0.6 (deg/h) sqrt(s), 0.01 deg/sqrt(h).
        n, sigma = (c["angle_random_walk_deg_per_sqrt_h" + end] for end in ("", "_sigma"))
        self.assertAlmostEqual(n / 0.01, 1, delta=0.03)
        self.assertTrue(0 < sigma < 0.0003)
        for key in ("quantization_arcsec", "bias_instability_deg_per_h",
                    "rate_random_walk_deg_per_h_sqrt_h", "rate_ramp_deg_per_h2"):
            if key in c:
                self.assertIn(key + "_sigma", c)
                self.assertNotIn(key + "_upper95", c)
            else:
                self.assertGreater(c[key + "_upper95"], 0)
        rows = self.Rows("t.csv")
        self.assertEqual([float(r["tau_s"]) for r in rows[:3]], [0.01, 0.02, 0.04])
        self.assertEqual([int(r["n"]) for r in rows[:3]], [49999, 49997, 49993])
        for row in rows:
            low, middle, high = (float(row[k + "_deg_per_h"]) for k in ("lower95", "adev",
                                                                         "upper95"))
            self.assertTrue(0 < low < middle < high)
        ElementTree.parse(self.Path("p.svg"))
        self.assertEqual(Run("check", self.Path("n.toml")).returncode, 0)

    def test_nbs10_by_hand(self):
        data = self.Write("nbs.txt", "892\n809\n823\n798\n671\n644\n883\n903\n677\n")
        for deviation, m2 in (("adev", 115.8082), ("oadev", 85.95287), ("mdev", 74.78849)):
            ran = Allan("--data", data, "--rate-hz", "1", "--unitless", "--deviation", deviation,
                        "--taus", "1,2", "--table", self.Path("t.csv"))
            self.assertEqual(ran.returncode, 0, ran.stderr)
            one, two = self.Rows("t.csv")
            self.assertAlmostEqual(float(one["adev"]), 91.22945, delta=5e-6)
            self.assertAlmostEqual(float(two["adev"]), m2, delta=5e-5)

    def test_losses_are_exit_3_and_named(self):
        values = White(5000, 2)
        values[777] = math.nan
        rows = [f"{i},{v!r}" for i, v in enumerate(values) if not 3000 <= i < 3010]
        data = self.Write("log.csv", "seq,gx\n" + "\n".join(rows) + "\n")
        ran = Allan("--data", data, "--channel", "gx", "--sequence", "seq", "--rate-hz", "50")
        self.assertEqual(ran.returncode, 3)
        self.assertIn("sample 777 (15.54 s)", ran.stderr)
        self.assertIn("10 samples missing by number: samples 3000 to 3009", ran.stderr)

    def test_headings_say_units_and_times(self):
        values = White(6000, 5)
        rows = [f"{0.1 * i:.3f},{v!r},{20 + 1e-3 * i}" for i, v in enumerate(values)]
        data = self.Write("log.csv", "TOOL[s],GX[deg/h],TEMP[degC]\n" + "\n".join(rows) + "\n")
        ran = Allan("--data", data, "--channel", "GX", "--table", self.Path("t.csv"))
        self.assertEqual(ran.returncode, 0, ran.stderr)
        first = self.Rows("t.csv")[0]
        self.assertAlmostEqual(float(first["tau_s"]), 0.1, places=9)
        self.assertAlmostEqual(float(first["adev_deg_per_h"]), 6, delta=0.3)
        # What contradicts the file is refused.
        for options in (["--rate-hz", "1"], ["--unit", "rad_per_s"]):
            self.assertEqual(Allan("--data", data, "--channel", "GX", *options).returncode, 1)
        bad = self.Write("bad.csv", "TOOL[s],GX[furlong]\n0,1\n1,2\n2,3\n")
        ran = Allan("--data", bad, "--channel", "GX")
        self.assertEqual(ran.returncode, 2)
        self.assertIn("no unit that is known", ran.stderr)
        ran = Allan("--data", self.Write("times.csv", "TOOL[s]\n0\n1\n2\n"))
        self.assertEqual(ran.returncode, 2)
        self.assertIn("no column beside times", ran.stderr)
        far = self.Write("far.csv", "TOOL[s],GX[deg/h]\n0,1\n1,2\n2,1\n3000000,2\n")
        ran = Allan("--data", far)
        self.assertEqual(ran.returncode, 2)
        self.assertIn("3000001 places for 4 samples", ran.stderr)

    def test_a_heading_without_unit_is_told(self):
        rows = "\n".join(repr(v) for v in White(2000, 6))
        for heading, told in (("gx", True), ("GX[deg/h]", False)):
            ran = Allan("--data", self.Write("u.csv", f"{heading}\n{rows}\n"), "--rate-hz", "10")
            self.assertEqual(ran.returncode, 0, ran.stderr)
            self.assertEqual("they are taken for rad/s" in ran.stderr, told, ran.stderr)

    def test_what_is_left_out_and_taken_off_is_told(self):
        values = White(20000, 6)
        for i in range(2000):
            values[i] += 500 * math.exp(-i / 300)
        values[9000] += 1000
        rows = [f"{v + 3 * (40 + 20 * math.sin(3e-4 * i))!r},{40 + 20 * math.sin(3e-4 * i)}"
                for i, v in enumerate(values)]
        data = self.Write("log.csv", "GX[deg/h],T\n" + "\n".join(rows) + "\n")
        ran = Allan("--data", data, "--channel", "GX", "--temperature", "T", "--rate-hz", "10",
                    "--exclude", "0:200", "--robust", "--detrend", "temperature", "--table",
                    self.Path("t.csv"), "--out", self.Path("cleaned.toml"))
        self.assertEqual(ran.returncode, 0, ran.stderr)
        self.assertIn("2000 samples from 0 to 200 s left out, as asked", ran.stderr)
        self.assertIn("1 spike left out", ran.stderr)
        self.assertIn("taken off: slope (3", ran.stderr)
        # The coefficients are of what is left, and their file says so.
        kept = self.Read(self.Path("cleaned.toml"))
        for word in ("2000 samples from 0 to 200 s", "1 spike left out", "taken off: slope (3"):
            self.assertIn(word, kept.split("cleaned = ")[1])
        for row in self.Rows("t.csv"):
            if float(row["edf"]) > 60:
                expected = 6 / math.sqrt(10 * float(row["tau_s"]))
                self.assertAlmostEqual(float(row["adev_deg_per_h"]) / expected, 1, delta=0.3)
        for words in ("600", "5:1", "a:b", "-1:5"):
            self.assertEqual(Allan("--data", data, "--channel", "GX", "--rate-hz", "10",
                                   "--exclude=" + words).returncode, 1, words)

    def test_unusable_is_exit_2_and_says_why(self):
        for name, data, word in (("e.f64", b"", "empty"), ("t.f64", b"1.5\n2.5\n", "csv"),
                                 ("c.f64", b"\0" * 9, "whole samples"),
                                 ("o.f64", struct.pack("<d", 1), "not one difference"),
                                 ("n.csv", b"1\n2\nx3\n", ":3:1"),
                                 ("l.lcm", b"no log at all", "log"),
                                 ("b.csv", b"\0\1\2\3", "binary")):
            ran = Allan("--data", self.Write(name, data), "--rate-hz", "1")
            self.assertEqual(ran.returncode, 2, name + ran.stderr)
            self.assertIn(word, ran.stderr, name)
            self.assertEqual(ran.stdout, "")
        constant = self.PutDoubles("k.f64", [3.0] * 500)
        ran = Allan("--data", constant, "--rate-hz", "1", "--out", self.Path("n.toml"))
        self.assertEqual(ran.returncode, 2)
        self.assertIn("every sample reads 3", ran.stderr)
        self.assertFalse(os.path.exists(self.Path("n.toml")))

    def test_times_and_temperatures_of_a_table(self):
        y = White(2000, 5)
        table = lambda head, row: self.Write("t.csv", head + "".join(map(row, range(2000))))
        back = table("TOOL[s],GX[deg/h]\n",
                     lambda i: f"{0.01 * (i if i != 700 else 650)},{y[i]}\n")
        ran = Allan("--data", back)
        self.assertEqual(ran.returncode, 2)
        self.assertIn("t.csv:702: its time is -0.49 s after", ran.stderr)
        self.assertIn("leave out the row", ran.stderr)
        still = table("TOOL[s],GX[deg/h]\n", lambda i: f"{i // 1000},{y[i]}\n")
        ran = Allan("--data", still)
        self.assertEqual(ran.returncode, 2)
        self.assertIn("t.csv:3: the times do not rise from row to row: sort the rows", ran.stderr)
        # TEMP is found by its name, K told from degC; without one there is nothing to take off.
        warm = lambda i: 25 + 5 * math.sin(i / 300)
        for unit, zero in (("degC", 0), ("K", 273.15)):
            data = table(f"GX[deg/h],TEMP[{unit}]\n",
                         lambda i: f"{y[i] + 20 * warm(i)},{warm(i) + zero}\n")
            ran = Allan("--data", data, "--rate-hz", "100", "--detrend", "temperature")
            self.assertEqual(ran.returncode, 0, ran.stderr)
            at = float(ran.stderr.split("per degC at ")[1].split()[0])
            self.assertAlmostEqual(at, 25, delta=3)
        data = table("GX[deg/h]\n", lambda i: f"{y[i]}\n")
        ran = Allan("--data", data, "--rate-hz", "100", "--detrend", "temperature")
        self.assertEqual(ran.returncode, 2)
        self.assertIn("no temperature to detrend by: name its column", ran.stderr)

    def test_a_wrong_command_line_is_exit_1(self):
        data = self.PutDoubles("log.f64", White(100, 3))
        for arguments in ((), ("--data", data), ("--data", data, "--rate-hz", "0"),
                          ("--data", data, "--rate-hz", "nan"),
                          ("--data", data, "--rate-hz", "1", "--unit", "furlong"),
                          ("--data", data, "--rate-hz", "1", "--unit", "counts"),
                          ("--data", data, "--rate-hz", "1", "--taus", "1,,2"),
                          ("--data", data, "--rate-hz", "1", "--unitless", "--out", "n.toml")):
            self.assertEqual(Allan(*arguments).returncode, 1, arguments)
        helped = Allan("--help")
        self.assertEqual(helped.returncode, 0)
        self.assertIn("Example:", helped.stdout)

    def test_nothing_is_written_over_what_it_came_from(self):
        data = self.Write("log.csv", "\n".join(map(repr, White(100, 3))))
        before = self.Read("log.csv")
        for option in ("--out", "--table", "--plot"):
            ran = Allan("--data", data, "--rate-hz", "1", option, data)
            self.assertEqual(ran.returncode, 1, option + ran.stderr)
            self.assertEqual(self.Read("log.csv"), before)

    def test_a_ramp_without_noise_is_told(self):
        data = self.Write("ramp.csv", "".join(f"{i}\n" for i in range(1000)))
        ran = Allan("--data", data, "--rate-hz", "100", "--out", self.Path("n.toml"))
        self.assertEqual(ran.returncode, 2, ran.stderr)
        self.assertIn("no noise shows", ran.stderr)
        self.assertFalse(os.path.exists(self.Path("n.toml")))

    def test_an_empty_line_among_samples_is_one_that_is_missing(self):
        rows = [repr(v) for v in White(2000, 5)]
        rows[777] = ""
        ran = Allan("--data", self.Write("log.csv", "GX[deg/h]\n\n" + "\n".join(rows) + "\n\n"),
                    "--rate-hz", "50")
        self.assertEqual(ran.returncode, 3, ran.stderr)
        self.assertIn("1 sample not finite, left out: sample 777", ran.stderr)

    def test_a_device_is_written_to_not_replaced(self):
        os.mkfifo(self.Path("pipe"))
        data = self.PutDoubles("log.f64", White(100, 4))
        reader = subprocess.Popen(["cat", self.Path("pipe")], stdout=subprocess.PIPE, text=True)
        ran = Allan("--data", data, "--rate-hz", "1", "--table", self.Path("pipe"))
        self.assertEqual(ran.returncode, 0, ran.stderr)
        self.assertTrue(reader.communicate(timeout=60)[0].startswith("tau_s,"))


if __name__ == "__main__":
    unittest.main()
