"""From a gyro survey tool's sensor stream to a wellbore survey with an honest covariance.

The library of the `wellgyro` program, not a second one: what it gives is the program's to the bit.
Units stand in the names; arrays are numpy's, in SI: rad/s, m/s2, T, m, ns. Tables are pandas'.

    job = wg.Job.load("job.toml")
    survey = wg.Survey(job)
    survey.push_imu(t_ns, gyro, accel)       # (n,), (n, 2 or 3), (n, 3)
    survey.push_depth(utc_ns, md)            # (n,), (n,)
    result = survey.finish()
    result.stations, result.cov, result.verdict
"""
from ._wellgyro import FileError
from ._wellgyro import version as __version__
from .bench import Calibration, calibrate
from .compare import (Comparison, EmpiricalModel, Merged, Uncertainty, compare, empirical_model, merge,
                      models, uncertainty)
from .files import read, write
from .noise import Allan, allan
from .survey import Job, Result, Survey, survey

__all__ = ["Allan", "Calibration", "Comparison", "EmpiricalModel", "FileError", "Job", "Merged",
           "Result", "Survey", "Uncertainty", "__version__", "allan", "calibrate", "compare",
           "empirical_model", "merge", "models", "read", "survey", "uncertainty", "write"]
