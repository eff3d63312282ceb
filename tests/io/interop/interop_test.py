"""Surveys that wellgyro writes, read by independent programs: pandas, wellpathpy, lasio, lascheck,
komle (WITSML 1.4.1.1 write bindings), energyml (WITSML 2.1) and osdu-python-models; and a workbook
that openpyxl writes, read by wellgyro."""
import csv
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import unittest
import warnings

warnings.filterwarnings("ignore")
PROGRAM = os.path.abspath(sys.argv.pop(1))

# A survey written by hand: uneven depths, a wrap of azimuth, a rise through the horizontal.
STATIONS = [(0, 0, 0), (30, 0.5, 358.25), (60.5, 3.75, 1.5), (90, 12, 4.125), (125.25, 31.5, 10),
            (160, 55.25, 22.75), (200, 88.5, 40), (230, 93.125, 47.5)]
PREAMBLE = """# tool: gyroscopic inertial
# error_model: A021Gc GYRO-NS-CT
# contractor: Survey & Co
# declination_deg: 0.75
# declination_source: BGGM 2025
# section_azimuth_deg: 5
# crs: EPSG:23031
# grid_scale: 0.9997
# begin: 2026-01-15
# remark: in-run
"""
# Columns besides the attitude: value at the first station and step.
MORE = {"GTF[deg]": (10, 1.5), "VAR_NN[m2]": (0.0025, 0.001), "COV_NE[m2]": (1e-4, -1e-5),
        "COV_NV[m2]": (0, 1e-6), "VAR_EE[m2]": (0.003, 0.001), "COV_EV[m2]": (0, -1e-6),
        "VAR_VV[m2]": (0.01, 0.0), "SIG_INC[deg]": (0.05, 0.0), "SIG_AZI[deg]": (0.3, 0.01),
        "LAT[deg]": (59.7553, 1e-5), "LON[deg]": (1.7134, 0), "GRAVITY[m/s2]": (9.81229, 0),
        "GRAVITY_REF[m/s2]": (9.81234, 0), "EARTH_RATE[deg/h]": (15.02, 0.001),
        "TEMP[degC]": (20, 0.5), "BUILD[deg/30m]": (0.1, 0), "UTC[s]": (1768457520, 300)}
EVEN = [(30 * i, 2.5 * i, 355 + i * 1.5) for i in range(9)]


def Positions(stations):
    """Minimum curvature by the centre of each arc, another way than the library's."""
    north = east = tvd = 0.0
    out = [(0.0, 0.0, 0.0)]
    for (m1, i1, a1), (m2, i2, a2) in zip(stations, stations[1:]):
        i1, a1, i2, a2 = (math.radians(x) for x in (i1, a1, i2, a2))
        t1 = (math.sin(i1) * math.cos(a1), math.sin(i1) * math.sin(a1), math.cos(i1))
        t2 = (math.sin(i2) * math.cos(a2), math.sin(i2) * math.sin(a2), math.cos(i2))
        half = math.asin(min(1.0, math.dist(t1, t2) / 2))
        factor = math.tan(half) / half if half > 1e-9 else 1.0
        step = (m2 - m1) / 2 * factor
        north, east, tvd = (p + step * (x + y) for p, x, y in zip((north, east, tvd), t1, t2))
        out.append((north, east, tvd))
    return out


class Interop(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.Write("survey.csv", STATIONS)
        cls.Write("even.csv", EVEN)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def Path(cls, name):
        return os.path.join(cls.folder.name, name)

    @classmethod
    def Write(cls, name, stations):
        """Stations with everything else that a format may hold, so that readers meet all of it."""
        with open(cls.Path(name), "w", encoding="utf-8") as file:
            file.write(PREAMBLE + "MD[m],INC[deg],AZI_GRID[deg]," + ",".join(MORE) +
                       ",NORTHING[m],EASTING[m],KIND,QUALITY,COMMENT,STATUS\n")
            places = Positions(stations)
            for i, (md, inc, azi) in enumerate(stations):
                more = ",".join(str(value + slope * i) for value, slope in MORE.values())
                more += f",{6625015.54 + places[i][0]},{427710.69 + places[i][1]}"
                kind = ("tie_in", "tie_in") if i == 0 else ("continuous", "surveyed")
                file.write(f"{md},{inc},{azi % 360},{more},{kind[0]},moved+gap,"
                           f"\"a, b & <c>\",{kind[1]}\n")

    def Convert(self, source, target, *options):
        path = self.Path(target)
        done = subprocess.run(
            [PROGRAM, "convert", self.Path(source), path, "--datum", "RT", "--datum-elevation-m",
             "25.3", "--convergence-deg", "-1.2345", "--well", "A-1 \u00e6", *options],
            capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return path

    def Same(self, rows, stations=STATIONS, unit=1.0, rounded=0.0):
        """rows of (md, inc, azi, north, east, tvd), lengths rounded to half of `rounded`"""
        rows = [[float(x) for x in row] for row in rows]
        self.assertEqual(len(rows), len(stations))
        for row, station, position in zip(rows, stations, Positions(stations)):
            self.assertAlmostEqual(row[0] * unit, station[0], delta=1e-9 + rounded)
            self.assertAlmostEqual(row[1], station[1], delta=1e-9)
            self.assertAlmostEqual(row[2], station[2] % 360, delta=1e-9)
            for got, want in zip(row[3:], position):
                self.assertAlmostEqual(got * unit, want, delta=2e-6 + rounded)

    def test_csv_by_pandas(self):
        import pandas
        for options in ((), ("--preamble",)):
            frame = pandas.read_csv(self.Convert("survey.csv", "out.csv", *options), comment="#")
            self.Same(frame[["MD[m]", "INC[deg]", "AZI_GRID[deg]", "N[m]", "E[m]", "TVD[m]"]]
                      .values.tolist())
        field = pandas.read_csv(self.Convert("survey.csv", "field.csv", "--units", "field"))
        self.Same(field[["MD[ft]", "INC[deg]", "AZI_GRID[deg]", "N[ft]", "E[ft]", "TVD[ft]"]]
                  .values.tolist(), unit=0.3048, rounded=0.3048e-4)
        self.assertIn("DLS[deg/100ft]", field.columns)

    def test_csv_by_wellpathpy(self):
        import wellpathpy
        md, inc, azi = wellpathpy.read_csv(self.Convert("survey.csv", "out.csv"), usecols=(0, 1, 2))
        path = wellpathpy.deviation(md, inc, azi).minimum_curvature()
        self.Same(zip(md, inc, azi, path.northing, path.easting, path.depth))

    def test_las_by_lasio(self):
        import lasio
        las = lasio.read(self.Convert("survey.csv", "variable.las"))
        self.assertEqual(float(las.well["STEP"].value), 0)
        self.assertEqual(las.params["I_AT"].value, "grid")
        self.assertEqual(float(las.params["I_RF"].value), 25.3)
        self.Same(zip(*(las[c] for c in ("DEPT", "DEVI", "AZIM", "NSDR", "EWDR", "TVD"))))
        even = lasio.read(self.Convert("even.csv", "even.las"))
        self.assertEqual(float(even.well["STEP"].value), 30)
        self.Same(zip(*(even[c] for c in ("DEPT", "DEVI", "AZIM", "NSDR", "EWDR", "TVD"))), EVEN)

    def test_las_by_lascheck(self):
        import lascheck
        # With step 0, which the format allows, lascheck divides by zero: fixed step only.
        las = lascheck.read(self.Convert("even.csv", "even.las"))
        self.assertTrue(las.check_conformity(), las.get_non_conformities())

    def test_las_comes_back(self):
        for name in ("variable.las", "even.las"):
            source = "even.csv" if name == "even.las" else "survey.csv"
            path = self.Convert(source, name)
            back = subprocess.run([PROGRAM, "convert", path, self.Path("back.csv")],
                                  capture_output=True, text=True, check=False)
            self.assertEqual(back.returncode, 0, back.stderr)

    def test_witsml_1411_by_komle(self):
        from komle.bindings.v1411.write import witsml
        with open(self.Convert("survey.csv", "out.xml"), "rb") as file:
            trajectory = witsml.CreateFromDocument(file.read()).trajectory[0]
        self.assertTrue(trajectory.validateBinding())
        self.assertEqual(str(trajectory.aziRef), "grid north")
        self.assertEqual(float(trajectory.gridConUsed.value()), -1.2345)
        self.assertEqual(trajectory.nameWell, "A-1 \u00e6")
        self.assertEqual(trajectory.trajectoryStation[0].md.datum, "RT")
        second = trajectory.trajectoryStation[1]
        self.assertEqual(str(second.typeSurveyTool), "gyroscopic inertial")
        self.assertEqual(second.iscwsaToolErrorModel.value(), "A021Gc GYRO-NS-CT")
        self.assertAlmostEqual(float(second.matrixCov.varianceNN.value()), 0.0035, delta=1e-15)
        self.assertEqual(str(trajectory.trajectoryStation[0].typeTrajStation), "tie in point")
        self.Same([[x.value() for x in (s.md, s.incl, s.azi, s.dispNs, s.dispEw, s.tvd)]
                   for s in trajectory.trajectoryStation])

    def test_witsml_21_by_energyml(self):
        from xsdata.formats.dataclass.parsers import XmlParser
        from xsdata.formats.dataclass.parsers.config import ParserConfig
        from energyml.witsml.v2_1.witsmlv2 import Trajectory
        parser = XmlParser(config=ParserConfig(fail_on_unknown_properties=True,
                                               fail_on_unknown_attributes=True,
                                               fail_on_converter_warnings=True))
        with open(self.Convert("survey.csv", "out21.xml", "--to", "witsml21"), "rb") as file:
            trajectory = parser.from_bytes(file.read(), Trajectory)
        self.assertEqual(trajectory.azi_ref.value, "grid north")
        self.assertEqual(trajectory.schema_version, "2.1")
        second = trajectory.trajectory_station[1]
        self.assertEqual(second.matrix_cov.sigma, 1)
        self.assertAlmostEqual(second.matrix_cov.variance_nn.value, 0.0035, delta=1e-15)
        self.assertEqual(second.tool_error_model.title, "A021Gc GYRO-NS-CT")
        self.assertEqual(second.type_survey_tool.value, "gyroscopic inertial")
        self.Same([[s.md.measured_depth.value, s.incl.value, s.azi.value, s.disp_ns.value,
                    s.disp_ew.value, s.tvd.vertical_depth.value]
                   for s in trajectory.trajectory_station])

    def test_witsml_21_by_its_schema(self):
        """Energistics' licence keeps the schemas out of the tree: the environment names a copy."""
        path = os.environ.get("WELLGYRO_WITSML21_XSD", "")
        if not os.path.exists(path):
            self.skipTest("no WITSML 2.1 schema here: WELLGYRO_WITSML21_XSD names Trajectory.xsd")
        import lxml.etree
        schema = lxml.etree.XMLSchema(lxml.etree.parse(path))
        def Valid(file):
            document = lxml.etree.parse(file)
            self.assertTrue(schema.validate(document), schema.error_log)
        files = 0
        for units in ("metric", "field"):
            for north in ("grid", "true"):
                Valid(self.Convert("survey.csv", "s21.xml", "--to", "witsml21", "--units", units,
                                   "--north", north, "--derived"))
                files += 1
        for source, options, what in self.Heads():
            with self.subTest(what):
                Valid(self.Plain(source, "h21.xml", "--to", "witsml21", *options))
                files += 1
        for element in ("TypeTrajStation", "Md", "Citation"):
            with open(self.Path("s21.xml"), encoding="utf-8") as file:
                text = re.sub(rf"<(\w+:)?{element}>.*?</(\w+:)?{element}>", "", file.read(),
                              count=1, flags=re.S)
            self.assertFalse(schema.validate(lxml.etree.fromstring(text.encode())), element)
        print(f"{files} WITSML 2.1 files valid by the schema")

    def Heads(self):
        """Files with awkward heads: lengths, blanks, letters, dates, missing parts."""
        names = ("\u00d8-1 H", "\u00c6-1 H", "A" * 70, "well " * 30, "6507/7-A-42: 10:15", "a, b; c",
                 "<&>\"'", "\u4e95\u6238 1", "")
        dates = ("", "2026-01-15", "2026-01-15T08:00:00Z", "15 JAN 2026")
        for i, name in enumerate(names):
            for date in dates if i < 2 else dates[i % 4:i % 4 + 1]:
                source = self.Path("head.csv")
                with open(source, "w", encoding="utf-8") as file:
                    for key in ("well", "wellbore", "survey", "contractor", "operator", "field",
                                "datum", "error_model", "job", "uwi", "rig"):
                        if name:
                            file.write(f"# {key}: {name}\n")
                    for key in ("begin", "end", "created"):
                        if date:
                            file.write(f"# {key}: {date}\n")
                    file.write("# datum_elevation_m: 25.3\n# grid_convergence_deg: -1.2\n"
                               "MD[m],INC[deg],AZI_GRID[deg],LAT[deg],LON[deg]\n0,0,0,59,2\n"
                               "30,1.5,350,59.0001,2\n60,3,355.25,59.0002,2\n")
                for units in ("metric", "field"):
                    yield source, ("--units", units), f"{i} {date} {units}"

    def Plain(self, source, target, *options):
        path = self.Path(target)
        done = subprocess.run([PROGRAM, "convert", source, path, *options], capture_output=True,
                              text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return path

    def test_awkward_heads_are_valid_everywhere(self):
        import sqlite3
        from komle.bindings.v1411.write import witsml
        from xsdata.formats.dataclass.parsers import XmlParser
        from xsdata.formats.dataclass.parsers.config import ParserConfig
        from energyml.witsml.v2_1.witsmlv2 import Trajectory
        import lasio
        from osdu_models.workproductcomponent.wellbore_trajectory import v1_4_0
        parser = XmlParser(config=ParserConfig(fail_on_unknown_properties=True,
                                               fail_on_unknown_attributes=True,
                                               fail_on_converter_warnings=True))
        files = 0
        for source, options, what in self.Heads():
            with self.subTest(what):
                with open(self.Plain(source, "h.xml", *options), "rb") as file:
                    trajectory = witsml.CreateFromDocument(file.read()).trajectory[0]
                self.assertTrue(trajectory.validateBinding())
                with open(self.Plain(source, "h21.xml", "--to", "witsml21", *options),
                          "rb") as file:
                    two = parser.from_bytes(file.read(), Trajectory)
                self.assertLessEqual(len(two.citation.title), 256)
                self.assertTrue(all(e.value.value for e in two.extension_name_value))
                las = lasio.read(self.Plain(source, "h.las", *options))
                self.assertEqual(len(las["DEPT"]), 3)
                with open(self.Plain(source, "h.json", *options), encoding="utf-8") as file:
                    v1_4_0.Data(**json.load(file)["data"])
                with open(self.Plain(source, "h.geojson", *options), encoding="utf-8") as file:
                    self.assertEqual(json.load(file)["features"][0]["geometry"]["type"],
                                     "LineString")
                with sqlite3.connect(self.Plain(source, "h.gpkg", *options)) as database:
                    self.assertEqual(database.execute("PRAGMA integrity_check").fetchone()[0], "ok")
                    self.assertEqual(database.execute("SELECT count(*) FROM stations").fetchone()[0],
                                     3)
                for name in ("h.p717", "h.dev", "h.txt", "h.kml"):
                    self.Plain(source, name, *options)
                files += 10
        print(f"{files} files of awkward heads")

    def test_every_format_to_every_other_and_back(self):
        """Angles and positions to the last bit, through any two formats."""
        formats = ("csv", "las", "p717", "witsml", "witsml21", "petrel", "compass")
        def Rows(path):
            with open(path, newline="", encoding="utf-8") as file:
                rows = [r for r in csv.DictReader(line for line in file if line[0] != "#")]
            return [[r[c] for c in ("MD[m]", "INC[deg]", "AZI_GRID[deg]", "TVD[m]", "N[m]", "E[m]")]
                    for r in rows]
        start = self.Convert("survey.csv", "start.csv")
        want = Rows(start)
        for first in formats:
            one = self.Plain(start, "one", "--to", first, "--datum-elevation-m", "25.3",
                             "--azimuth-reference", "grid", "--convergence-deg", "-1.2345")
            for second in formats:
                two = self.Plain(one, "two", "--to", second, "--datum-elevation-m", "25.3")
                self.assertEqual(Rows(self.Plain(two, "three", "--to", "csv")), want,
                                 f"{first} {second}")

    def test_a_workbook_of_openpyxl_is_read(self):
        import openpyxl
        book = openpyxl.Workbook()
        sheet = book.active
        sheet.append(["Survey of A-1"])
        sheet.append([])
        sheet.append(["MD[m]", "INC[deg]", "AZI_GRID[deg]", "Remark"])
        for md, inc, azi in STATIONS:
            sheet.append([md, inc, azi % 360, "a \"quoted\" remark, with commas"])
        book.create_sheet("left empty")
        book.save(self.Path("survey.xlsx"))
        with open(self.Convert("survey.xlsx", "out.csv"), encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.Same([[r[c] for c in ("MD[m]", "INC[deg]", "AZI_GRID[deg]", "N[m]", "E[m]", "TVD[m]")]
                   for r in rows])

    def test_maps_by_gdal(self):
        import shutil
        if not shutil.which("ogrinfo"):
            self.skipTest("no GDAL here: apt-get install gdal-bin")
        for name in ("map.geojson", "map.kml", "map.gpkg"):
            path = self.Convert("survey.csv", name)
            seen = subprocess.run(["ogrinfo", "-ro", "-al", path], capture_output=True, text=True,
                                  check=False)
            self.assertEqual(seen.returncode, 0, seen.stderr)
            self.assertNotIn("ERROR", seen.stderr)
            self.assertEqual(len(re.findall(r"^ *LINESTRING", seen.stdout, re.M)), 1, name)
            self.assertGreater(len(re.findall(r"^ *POLYGON", seen.stdout, re.M)), 1, name)

    def test_osdu_by_its_models(self):
        from osdu_models.workproductcomponent.wellbore_trajectory import v1_4_0
        with open(self.Convert("survey.csv", "out.json"), encoding="utf-8") as file:
            manifest = json.load(file)
        data = v1_4_0.Data(**manifest["data"])
        self.assertEqual(data.BaseDepthMeasuredDepth, 230)
        self.assertEqual(data.VerticalMeasurement.VerticalMeasurement, 25.3)
        self.assertIn("WellboreTrajectory:1.4.0", manifest["kind"])

    def test_p717_is_plain_csv_records(self):
        with open(self.Convert("survey.csv", "out.p717"), newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
        self.assertEqual(rows[0][0], "IOGP")
        self.Same([r[10:16] for r in rows if r[0] == "P7"])
        # Fields of each record as the format task force's own reader counts them.
        fields = {"IOGP": 9, "O7": 14, "P7": 22, "HC130": 12, "H7100": 10, "H7110": 15,
                  "H7120": 18, "H7121": 11, "H7130": 17, "H7140": 13, "H7150": 23, "H7151": 23,
                  "H7152": 9, "H7400": 17}
        seen = set()
        for row in rows:
            key = row[0] if row[0] not in ("HC", "H7") else "".join(row[:4])
            seen.add(key)
            if key in fields:
                self.assertEqual(len(row), fields[key], row)
        self.assertLessEqual(set(fields), seen)


if __name__ == "__main__":
    unittest.main(verbosity=1)
