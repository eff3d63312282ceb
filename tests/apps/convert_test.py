#!/usr/bin/env python3
"""Runs `wellgyro convert` as a user does. convert_test.py PROGRAM"""
import os
import re
import sys
import unittest

from harness import FreshProgramTest, Run, Simulation, Stop

SURVEY = "MD[m],INC[deg],AZI_TRUE[deg]\n0,0,0\n30,1.5,350\n60,3,355.25\n"


class Convert(FreshProgramTest):
    def setUp(self):
        super().setUp()
        self.Write("in.csv", SURVEY)

    def Convert(self, source, target, *options):
        return Run("convert", self.Path(source), self.Path(target), *options)

    def Done(self, source, target, *options):
        done = self.Convert(source, target, *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        for line in done.stderr.splitlines():
            self.assertIn(": note: ", line)
        return done.stderr

    def Refused(self, source, target, *options):
        done = self.Convert(source, target, *options)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertFalse(os.path.exists(self.Path(target)))
        return done.stderr

    def test_bare_names_are_of_the_folder_it_runs_in(self):
        done = Run("convert", "in.csv", "out.las", cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("nothing in the file checks", done.stderr)
        self.assertIn("~A", self.Read("out.las").upper())

    def test_every_format_there_and_back(self):
        datum = ("--datum", "RT", "--datum-elevation-m", "25", "--convergence-deg", "1.25")
        for name in ("out.las", "out.p717", "out.xml", "out.dev", "out.txt", "out.csv"):
            self.Done("in.csv", name, *datum)
            self.Done(name, "back.csv", "--as-it-is")
            rows = [line.split(",")[:3] for line in self.Read("back.csv").split("\n")[:4]]
            self.assertEqual(rows, [["MD[m]", "INC[deg]", "AZI_TRUE[deg]"], ["0", "0", "0"],
                                    ["30", "1.5", "350"], ["60", "3", "355.25"]], name)
        self.Done("in.csv", "out21.xml", "--to", "witsml21")
        self.Done("in.csv", "out.json", *datum)

    def test_units_and_north(self):
        self.Done("in.csv", "out.csv", "--units", "field", "--north", "grid", "--convergence-deg",
                  "-1.5")
        header, _, row = self.Read("out.csv").split("\n")[:3]
        self.assertTrue(header.startswith("MD[ft],INC[deg],AZI_GRID[deg],TVD[ft],N[ft],E[ft]"))
        fields = row.split(",")
        self.assertEqual(fields[0], "98.4252")
        self.assertEqual(fields[2], "351.5")

    def test_refusals_say_what_to_do(self):
        self.Write("plain.csv", "md,inc,azi\n0,0,0\n10,1,2\n")
        self.assertIn("--depth-unit", self.Refused("plain.csv", "out.las"))
        self.assertIn("north", self.Refused("plain.csv", "out.las", "--depth-unit", "m"))
        self.assertIn("convergence", self.Refused("in.csv", "out.las", "--north", "grid"))
        self.assertIn("elevation", self.Refused("in.csv", "out.dev"))
        self.Write("bad.csv", SURVEY + "50,1,2\n")
        self.assertIn("bad.csv:5", self.Refused("bad.csv", "out.las"))
        self.Write("empty.csv", "")
        self.assertIn("empty", self.Refused("empty.csv", "out.las"))
        self.assertIn("open", self.Refused("missing.csv", "out.las"))
        self.Write("opposite.csv", "MD[m],INC[deg],AZI_TRUE[deg]\n0,0,0\n30,180,0\n")
        self.assertIn("at depth 30 m it points opposite", self.Refused("opposite.csv", "out.las"))

    def test_no_option_is_passed_over(self):
        for options, code, word in (
                (("--from", "foo"), 1, "none of csv"),
                (("--declination-date", "31.12.2020"), 1, "YYYY-MM-DD"),
                (("--latitude-deg", "60"), 1, "go together"),
                (("--columns", "INC=9"), 2, "no column is called so"),
                (("--columns", "FOO=1"), 2, "there is no FOO"),
                (("--columns", "MD=1,INC=1"), 2, "column 1 is named twice"),
                (("--north", "magnetic"), 2, "--declination-deg")):
            done = Run("convert", "in.csv", "out.csv", *options, cwd=self.folder)
            self.assertEqual(done.returncode, code, options)
            self.assertIn(word, done.stderr)

    def test_text_that_is_no_survey_is_refused_at_once(self):
        rows = "".join(f"{i},5;1,25;-3,5;9,81;0,02;0,03\n" for i in range(5000))
        self.Write("long.csv", "Zeit;a;b;c;d;e\n" + rows)
        usage = os.times().children_user
        self.assertIn("no line names columns", self.Refused("long.csv", "out.las"))
        self.assertLess(os.times().children_user - usage, 5)

    def test_a_pipe_is_refused_and_not_waited_for(self):
        os.mkfifo(self.Path("pipe.csv"))
        self.assertIn("this is a pipe", self.Refused("pipe.csv", "out.las"))
        done = Run("check", self.Path("pipe.csv"))
        self.assertEqual(done.returncode, 2)
        self.assertIn("this is a pipe", done.stderr)

    def test_no_number_is_no_number(self):
        for option in ("--convergence-deg", "--declination-deg", "--datum-elevation-m",
                       "--section-azimuth-deg", "--latitude-deg"):
            for word in ("nan", "inf", "-inf", "1e999"):
                done = self.Convert("in.csv", "out.p717", option, word)
                self.assertEqual(done.returncode, 1, (option, word))
                self.assertFalse(os.path.exists(self.Path("out.p717")))
        self.assertEqual(self.Convert("in.csv", "out.las", "--convergence-deg", "1e300").returncode,
                         1)
        self.assertEqual(Run("convert", "in.csv", "-", "--to", "csv", cwd=self.folder).returncode, 1)
        self.assertFalse(os.path.exists(self.Path("-")))

    def test_convergence_of_the_files_own_position(self):
        turns = set()
        for name, head, place in (("map.csv", "NORTHING[m],EASTING[m]", "6652048.573,444314.836"),
                                  ("geo.csv", "LAT[deg],LON[deg]", "60,2"), ("none.csv", "X9", "1")):
            self.Write(name, f"MD[m],INC[deg],AZI_TRUE[deg],{head}\n0,0,0,{place}\n"
                       f"30,0,0,{place}\n")
            if name == "none.csv":
                self.assertIn("no position", self.Refused(name, "x.las", "--crs", "EPSG:23031"))
                continue
            told = self.Convert(name, "out.csv", "--crs", "EPSG:23031", "--north", "grid").stderr
            turns.add(re.search(r"convergence (\S+) deg, from EPSG:23031", told).group(1))
        self.assertEqual(turns, {"-0.864609"})

    def test_check_says_whose_options_it_names(self):
        self.Write("two.csv", "WELL,MD[m],INC,AZI_TRUE\nA,0,0,0\nA,9,1,1\nB,0,0,0\nB,9,1,1\n")
        done = Run("check", self.Path("two.csv"))
        self.assertEqual(done.returncode, 2)
        self.assertIn("options are those of wellgyro convert", done.stdout)

    def test_damage_of_a_log_is_told(self):
        simulation = self.Write("run.toml", Simulation(
            Stop(20), "imu_hz = 20.0\ndepth_hz = 4.0\nbatch = 20\n"))
        self.Make("simulate", "--job", simulation, "--out", self.Path("run.lcm"))
        self.Make("convert", self.Path("run.lcm"), self.Path("run.csv"))
        whole = self.Bytes("run.lcm")
        middle = len(whole) // 2
        for name, log, says in (("cut", whole[:-7], "ends inside an event"),
                                ("torn", whole[:middle] + whole[middle + 9:], "damaged bytes")):
            self.Write(name + ".lcm", log)
            done = self.Convert(name + ".lcm", name + ".csv")
            self.assertEqual(done.returncode, 3, name + done.stderr)
            self.assertIn(says, done.stderr)

    def test_nothing_is_written_over_what_it_came_from(self):
        datum = ("--datum", "RT", "--datum-elevation-m", "25", "--convergence-deg", "1")
        for out in ("in.csv", "./in.csv", "in.json"):
            done = Run("convert", "in.csv", out, *datum, cwd=self.folder)
            self.assertEqual(done.returncode, 1, out + done.stderr)
            self.assertEqual(self.Read("in.csv"), SURVEY)
        self.assertEqual(os.listdir(self.folder), ["in.csv"])
        done = Run("convert", "in.csv", "out.json", *datum, cwd=self.folder)
        self.assertEqual((done.returncode, done.stdout), (0, "wrote out.csv too\n"))

    def test_why_no_positions_are_summed_is_told(self):
        self.Write("deep.csv", "MD[m],INC[deg],AZI_TRUE[deg]\n100,5,40\n130,6,40\n")
        self.assertIn("no positions are summed: the first station, at MD 100.00 m",
                      self.Done("deep.csv", "out.csv"))
        self.assertNotIn("positions are summed", self.Done("deep.csv", "out.csv", "--as-it-is"))

    def test_a_row_that_is_cut_is_refused(self):
        head = "MD[m],INC[deg],AZI_TRUE[deg],TVD[m]\n0,0,0,0\n30,1.5,350,\n"
        self.Write("cut.csv", head + "60,3,35")
        self.assertIn("cut.csv:4: 3 fields where the header has 4",
                      self.Refused("cut.csv", "out.las"))
        self.assertEqual(Run("check", self.Path("cut.csv")).returncode, 2)
        self.Write("empty_cell.csv", head + "60,3,355,\n")
        self.Done("empty_cell.csv", "out.csv")

    def test_command_line(self):
        self.assertEqual(self.Convert("in.csv", "out.unknown").returncode, 1)
        self.assertEqual(self.Convert("in.csv", "out.csv", "--to", "docx").returncode, 1)
        help_text = Run("convert", "--help")
        self.assertEqual(help_text.returncode, 0)
        self.assertIn("Example:\n  wellgyro convert", help_text.stdout)


if __name__ == "__main__":
    sys.exit(0 if unittest.main(verbosity=1, exit=False).result.wasSuccessful() else 1)
