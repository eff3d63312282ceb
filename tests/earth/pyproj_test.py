#!/usr/bin/env python3
"""Map systems of the EPSG registry and datum shifts, by 'wellgyro north' and by pyproj.
    pyproj_test.py PROGRAM
Easting and northing to 1 mm, convergence to 1e-6 deg, the way back to 1e-8 deg. Where the best
operation needs a grid file that is not here both must refuse."""
import math
import os
import re
import subprocess
import sys

import pyproj
from pyproj.aoi import AreaOfInterest
from pyproj.transformer import Transformer, TransformerGroup

PROGRAM = os.path.abspath(sys.argv[1])
pyproj.network.set_network_enabled(False)

# Code, latitude, longitude: in every part of the world that drills.
SYSTEMS = [
    (32631, 58.44, 1.93), (32632, 60.5, 4.9), (32633, 66.0, 14.0), (32637, 25.3, 38.0),
    (32639, 29.3, 48.1), (32640, 24.0, 54.0), (32643, 19.0, 72.0), (32648, 3.0, 105.0),
    (32650, 5.0, 115.5), (32712, -40.0, -110.0), (32718, -5.0, -76.5), (32733, -6.0, 12.5),
    (32736, -18.0, 35.5), (25831, 53.5, 4.0), (25832, 55.2, 8.5), (25833, 54.0, 14.1),
    (26915, 29.5, -93.0), (26914, 31.9, -102.0), (26912, 40.1, -109.5), (28350, -20.5, 116.2),
    (28355, -38.3, 148.0), (7850, -20.5, 116.2), (2193, -39.3, 173.6), (31981, -3.0, -57.0),
    (31984, -22.5, -40.0), (31983, -23.5, -44.0), (2154, 47.0, 2.5), (3035, 52.0, 10.0),
    (3006, 60.0, 15.0), (3034, 50.0, 8.0), (23031, 56.5, 3.2), (23032, 57.0, 7.5),
    (23030, 53.6, -1.2), (28191, 31.5, 35.0), (2326, 22.3, 114.1), (3414, 1.3, 103.8),
    (3857, 20.0, 30.0), (5361, -53.0, -70.0), (22234, -34.5, 20.0), (3067, 62.0, 26.0),
    (2953, 46.5, -66.5), (3978, 60.0, -100.0), (6372, 20.0, -98.0), (3395, 20.0, 30.0),
    (5880, -10.0, -50.0), (26917, 40.5, -80.5),
    (2276, 32.7, -97.0), (2278, 29.4, -95.2), (3359, 35.5, -78.0), (2225, 41.0, -122.0)]

# Datums whose shift to WGS 84 the test asks for, by a projected system on each.
DATUMS = [(23031, 56.5, 3.2), (23032, 57.0, 7.5), (28350, -20.5, 116.2), (2193, -39.3, 173.6),
          (31984, -22.5, -40.0), (28191, 31.5, 35.0), (2326, 22.3, 114.1), (22234, -34.5, 20.0),
          (26331, 6.0, 4.0), (24820, 10.0, -64.5), (20499, 25.6, 50.6), (29873, 4.6, 114.0),
          (22033, -7.0, 12.5), (27700, 53.0, -1.5), (26741, 40.0, -122.0)]


def Best(source, target, lon, lat):
    group = TransformerGroup(source, target, always_xy=True, allow_ballpark=False,
                             area_of_interest=AreaOfInterest(lon, lat, lon, lat))
    if not group.best_available or not group.transformers:
        return None
    return group.transformers[0]


def Run(*arguments):
    done = subprocess.run([PROGRAM, "north", *map(str, arguments)], capture_output=True, text=True,
                          check=False)
    return done.stdout, done.stderr, done.returncode


def Forward(code, latitude, longitude):
    out, err, _ = Run("--latitude-deg", latitude, "--longitude-deg", longitude, "--crs",
                      f"EPSG:{code}")
    found = re.search(r"easting (\S+) m, northing (\S+) m", out)
    turn = re.search(r"convergence (\S+) deg", out)
    return (tuple(map(float, found.groups())), float(turn.group(1))) if found else (None, err)


def Back(code, easting, northing):
    out, err, _ = Run("--crs", f"EPSG:{code}", "--easting", repr(easting), "--northing",
                      repr(northing))
    found = re.search(r"latitude (\S+) deg, longitude (\S+) deg", out)
    return tuple(map(float, found.groups())) if found else err


def main():
    bad, exact, refused, shifts = [], 0, 0, 0
    for code, latitude, longitude in SYSTEMS:
        crs = pyproj.CRS.from_epsg(code)
        best = Best("EPSG:4326", crs, longitude, latitude)
        ours, turn = Forward(code, latitude, longitude)
        if best is None or ours is None:
            refused += 1
            if (best is None) != (ours is None):
                bad.append(f"EPSG:{code}: ours {ours or turn.strip()}, pyproj {best}")
            continue
        unit = crs.axis_info[0].unit_conversion_factor
        x, y = (v * unit for v in best.transform(longitude, latitude))
        own = Transformer.from_crs(crs, crs.geodetic_crs, always_xy=True)
        lon, lat = own.transform(x / unit, y / unit)
        factors = pyproj.Proj(crs).get_factors(lon, lat)
        gap = math.hypot(ours[0] - x, ours[1] - y)
        if gap > 1e-3 or abs(turn - factors.meridian_convergence) > 1.0e-6:
            bad.append(f"EPSG:{code}: {gap:.4f} m, {turn - factors.meridian_convergence:.2g} deg")
        else:
            exact += 1
    for code, latitude, longitude in DATUMS:
        crs = pyproj.CRS.from_epsg(code)
        own = Transformer.from_crs(crs.geodetic_crs, crs, always_xy=True)
        x, y = own.transform(longitude, latitude)
        best = Best(crs, "EPSG:4326", longitude, latitude)
        ours = Back(code, x, y)
        if best is None or isinstance(ours, str):
            refused += 1
            print(f"EPSG:{code} refused: {ours.strip() if isinstance(ours, str) else ours}")
            if (best is None) != isinstance(ours, str):
                bad.append(f"EPSG:{code} to WGS 84: ours {ours}, pyproj {best}")
            continue
        lon, lat = best.transform(x, y)
        gap = max(abs(ours[0] - lat), abs(ours[1] - lon))
        if gap > 1e-8:
            bad.append(f"EPSG:{code} to WGS 84: {gap:.2g} deg, {best.description}")
        else:
            shifts += 1
    for line in bad:
        print(line)
    print(f"{exact} map systems to 1 mm and 1e-6 deg, {shifts} datum shifts to 1e-8 deg (1 mm), "
          f"{refused} refused, {len(bad)} differ")
    sys.exit(1 if bad else 0)


main()
