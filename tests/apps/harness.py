"""What the tests that run the program share: the program, given as the first argument, a folder
for its files, and simulations and jobs of a slant hole."""
import csv
import difflib
import filecmp
import os
import shutil
import subprocess
import sys
import tempfile
import tomllib
import unittest

PROGRAM = os.path.abspath(sys.argv.pop(1))
TOP = os.path.realpath(os.path.join(os.path.dirname(__file__), "..", ".."))
sys.path.insert(0, os.path.join(TOP, "tests", "support"))
from demonstration import DEMO
RESULT = ("survey.csv", "passes.csv", "checks.csv", "diagnosis.csv", "reliability.csv",
          "stretches.csv", "run.toml")


def Limit(idle, shared):
    """What a time or a load may reach: the first on an idle machine (WELLGYRO_TIMED=1), the second on
    one that has other work, where it only tells a wait or a loop without an end."""
    return idle if os.environ.get("WELLGYRO_TIMED") else shared


def Stop(seconds):
    return f"[[run.step]]\nstop_s = {seconds:.1f}\n"


def Move(to_md_m):
    return f"[[run.step]]\nto_md_m = {to_md_m:.1f}\nspeed_mps = 1.0\nroll_rpm = 1.0\n"


def Simulation(run, streams, *, seed=3, end_md_m=400.0, walk=0.005, tool=""):
    """The text of a simulation file; [streams] is its last table."""
    return f"""format = "wellgyro.simulation/1"
seed = {seed}
[well]
name = "slant"
inclination_deg = 25.0
azimuth_true_deg = 300.0
end_md_m = {end_md_m}
[earth]
latitude_deg = 61.0
[run]
{run}[tool]
{tool}angle_random_walk_deg_per_sqrt_h = {walk}
[streams]
{streams}"""


# A tool that is perfect but for its noise: what a job does not state is not zero.
PERFECT = """[errors]
gyro_bias_sigma_deg_per_h = 0
mass_unbalance_sigma_deg_per_h_per_g = 0
gyro_scale_sigma = 0
gyro_misalignment_sigma_rad = 0
accel_bias_sigma_mps2 = 0
accel_noise_mps2_per_sqrt_hz = 0
time_skew_sigma_s = 0
depth_sigma_m = 0
depth_scale_sigma = 0
"""


def Job(every_m, *, walk=0.005):
    """The text of a job file of a perfect tool but for its noise; [stations] is its last table."""
    return f"""format = "wellgyro.job/1"
[well]
name = "Slant"
latitude_deg = 61.0
longitude_deg = 3.0
[noise]
angle_random_walk_deg_per_sqrt_h = {walk}
{PERFECT}[stations]
every_m = {every_m}
"""


def Run(*arguments, timeout=120, **options):
    return subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, check=False,
                          timeout=timeout, **options)


def Start(*arguments):
    return subprocess.Popen([PROGRAM, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                            text=True)


def Listening(process):
    """The lines of a live command until it says that it listens, or all where it never does."""
    heard = []
    while line := process.stderr.readline():
        heard.append(line)
        if line.startswith("listening"):
            return True, heard
    return False, heard


class ProgramTest(unittest.TestCase):
    """Tests in a folder that all of the class share; names of files are of that folder."""

    @classmethod
    def NewFolder(cls):
        cls.folder = tempfile.mkdtemp()
        return cls.folder

    @classmethod
    def setUpClass(cls):
        cls.addClassCleanup(shutil.rmtree, cls.NewFolder())

    @classmethod
    def Path(cls, *names):
        return os.path.join(cls.folder, *names)

    @classmethod
    def Write(cls, name, content):
        with open(cls.Path(name), "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
        return cls.Path(name)

    @classmethod
    def Read(cls, *names):
        with open(cls.Path(*names), encoding="utf-8") as file:
            return file.read()

    @classmethod
    def Bytes(cls, *names):
        with open(cls.Path(*names), "rb") as file:
            return file.read()

    @classmethod
    def Toml(cls, *names):
        return tomllib.loads(cls.Read(*names))

    @classmethod
    def Rows(cls, *names):
        with open(cls.Path(*names), newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    @classmethod
    def Make(cls, *arguments, **options):
        """Runs what must succeed, and say nothing of trouble in its exit code."""
        done = Run(*arguments, **options)
        assert done.returncode == 0, done.stdout + done.stderr
        return done

    def SameAs(self, one, other):
        """The result files of two surveys are the same to the byte."""
        for name in RESULT:
            a, b = self.Path(one, name), self.Path(other, name)
            if not filecmp.cmp(a, b, shallow=False):
                told = difflib.unified_diff(self.Read(a).splitlines(), self.Read(b).splitlines(),
                                            lineterm="", n=0)
                self.fail("\n".join([name, *list(told)[:20]]))


class FreshProgramTest(ProgramTest):
    """Tests in a folder that is a new one for each."""

    @classmethod
    def setUpClass(cls):
        pass

    def setUp(self):
        self.addCleanup(shutil.rmtree, self.NewFolder())
