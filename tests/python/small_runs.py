"""Runs of a few minutes for the tests of the package and of the archive, clusters for them and
what they left."""
import os

SIMULATION = """format = "wellgyro.simulation/1"
seed = {seed}
[well]
name = "slant"
inclination_deg = {inclination}
azimuth_true_deg = {azimuth}
end_md_m = 80.0
[earth]
latitude_deg = 61.0
[run]
[[run.step]]
stop_s = 150.0
[[run.step]]
to_md_m = 80.0
speed_mps = 1.0
roll_rpm = 1.0
[[run.step]]
stop_s = 60.0
[tool]
angle_random_walk_deg_per_sqrt_h = 0.005
accel_noise_mps2_per_sqrt_hz = 2e-4
[streams]
imu_hz = {hz}
"""

JOB = """format = "wellgyro.job/1"
[well]
name = "Slant"
latitude_deg = {latitude}
longitude_deg = 3.0
[noise]
angle_random_walk_deg_per_sqrt_h = 0.005
[stations]
every_m = 20.0
"""


def Cluster(workers):
    from wellgyro import archive  # not where the package is installed without its archive

    return archive.local_cluster(workers, dashboard_address=None, silence_logs=50)


def Files(out):
    """Every file of the archive with its bytes."""
    found = {}
    for where, _, names in os.walk(out):
        for name in names:
            path = os.path.join(where, name)
            with open(path, "rb") as file:
                found[os.path.relpath(path, out)] = file.read()
    return found
