#!/usr/bin/env python3
"""Every error model that welleng ships, JSON and YAML, on ten wells: run by wellgyro from the file as
it is, and the covariances held against welleng's own.
    welleng_test.py PROGRAM [--every N]
Figures: how many files ran, agree to 1e-6 of the covariance's trace, and which differ and why."""
import contextlib
import csv
import glob
import io
import math
import os
import subprocess
import sys
import tempfile
import time
import warnings

warnings.simplefilter("ignore")
import numpy as np  # noqa: E402
import welleng  # noqa: E402
from welleng.survey import Survey, SurveyHeader  # noqa: E402

PROGRAM = os.path.abspath(sys.argv[1])
ERRORS = os.path.join(os.path.dirname(welleng.__file__), "errors")
LATITUDE, DIP, FIELD, DECLINATION, GRAVITY = 60.0, 70.0, 50000.0, -3.0, 9.80665

# Where welleng 0.30.0 is not right, with the equation.
EXCEPTIONS = {
    "GYRO-NS-CT": "welleng goes on weighing the stationary terms above the end of the stationary "
                  "range, 15 deg; SPE 90408 App. C, box 9: they are carried from there",
    "CB_Film_GMS": "welleng refuses: the running speed of the z gyro is not in the JSON file "
                   "(SPE 90408 table 8 needs it); ours takes it from the published sheet",
    "CB_Film_GSS": "the same",
}


def Rows(points):
    """Stations (MD, inclination, azimuth) every 30 m through points (MD, inc, azi)."""
    md = np.arange(0.0, points[-1][0] + 0.1, 30.0)
    p = np.array(points, dtype=float)
    inc, azi = np.interp(md, p[:, 0], p[:, 1]), np.interp(md, p[:, 0], p[:, 2]) % 360
    return np.c_[md, inc, np.where(inc < 1e-4, 0.0, azi)]  # vertical: azimuth 0, in both programs


def Wells():
    yield "slant", Rows([(0, 0, 40), (300, 0, 40), (1200, 45, 40), (2400, 45, 40)])
    yield "slant south", Rows([(0, 0, 200), (300, 0, 200), (900, 25, 200), (2400, 27, 215)])
    yield "turn", Rows([(0, 1, 10), (600, 20, 60), (1500, 50, 160), (2400, 60, 220)])
    yield "horizontal north", Rows([(0, 0, 5), (600, 0, 5), (1800, 88, 10), (2700, 88, 10)])
    yield "near east", Rows([(0, 0, 70), (600, 5, 70), (1500, 60, 72), (2400, 70, 74)])
    yield "drop", Rows([(0, 0, 310), (300, 0, 310), (1200, 40, 310), (2100, 3, 310), (2400, 3, 310)])
    yield "low angle", Rows([(0, 2, 20), (900, 3, 80), (1800, 2.5, 140), (2400, 4, 190)])
    yield "build", Rows([(0, 3, 350), (2400, 83, 350)])
    yield "west", Rows([(0, 1, 250), (900, 30, 255), (2400, 55, 262)])
    yield "vertical", Rows([(0, 0, 0), (1500, 0, 0)])


def Ours(model, path, out):
    command = [PROGRAM, "uncertainty", "--survey", path, "--model", model, "--out", out,
               "--latitude-deg", str(LATITUDE), "--dip-deg", str(DIP), "--field-nt", str(FIELD),
               "--declination-deg", str(DECLINATION), "--gravity-mps2", str(GRAVITY)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode not in (0, 3):
        return None, done.stderr.strip().splitlines()[-1]
    with open(os.path.join(out, "covariance.csv"), encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    keys = ["VAR_NN[m2]", "COV_NE[m2]", "COV_NV[m2]", "VAR_EE[m2]", "COV_EV[m2]", "VAR_VV[m2]"]
    return np.array([[float(r[k]) for k in keys] for r in rows]), done.stderr


def Theirs(name, well):
    header = SurveyHeader(latitude=LATITUDE, longitude=2.0, b_total=FIELD, dip=DIP,
                          declination=DECLINATION, convergence=0.0, G=GRAVITY,
                          azi_reference="true", deg=True, vertical_inc_limit=0.0001)
    with contextlib.redirect_stdout(io.StringIO()), np.errstate(all="ignore"):
        survey = Survey(md=well[:, 0], inc=well[:, 1], azi=well[:, 2], header=header, deg=True,
                        error_model=name)
    c = np.asarray(survey.cov_nev)
    return np.stack([c[:, 0, 0], c[:, 0, 1], c[:, 0, 2], c[:, 1, 1], c[:, 1, 2], c[:, 2, 2]], 1)


def Compare(ours, theirs):
    n = min(len(ours), len(theirs))
    trace = theirs[:n, 0] + theirs[:n, 3] + theirs[:n, 5]
    gap = np.abs(ours[:n] - theirs[:n]).max(axis=1)
    # Nine digits are written.
    return float(np.max(gap / np.maximum(trace, 1e-3))) if n else math.nan


def main():
    step = int(sys.argv[3]) if sys.argv[2:3] == ["--every"] else 1
    files = sorted(glob.glob(f"{ERRORS}/iscwsa_json/*/*.json"))[::step]
    ran = agree = compared = failed = 0
    named, worst, ours_s, theirs_s = {}, 0.0, 0.0, 0.0
    wells = list(Wells())
    with tempfile.TemporaryDirectory() as folder:
        for index, (_, well) in enumerate(wells):
            with open(f"{folder}/{index}.csv", "w", encoding="utf-8") as file:
                file.write("MD[m],INC[deg],AZI_TRUE[deg]\n")
                file.writelines(f"{m:.2f},{i:.6f},{a:.6f}\n" for m, i, a in well)
            wells[index] = (wells[index][0], np.round(well, 6))
        for path in files:
            name = os.path.basename(path)[:-5]
            gaps, whys = [], []
            for index, (title, well) in enumerate(wells):
                begin = time.monotonic()
                ours, why = Ours(path, f"{folder}/{index}.csv", f"{folder}/out")
                ours_s += time.monotonic() - begin
                if ours is None:
                    whys.append(f"{title}: {why}")
                    continue
                begin = time.monotonic()
                try:
                    theirs = Theirs(name, well)
                except Exception as error:  # noqa: BLE001: whatever it says is reported
                    whys.append(f"welleng: {error}")
                    continue
                theirs_s += time.monotonic() - begin
                gaps.append((Compare(ours, theirs), title))
            ran += not any("welleng" not in w for w in whys)
            for gap, _ in gaps:
                compared += 1
                agree += gap <= 1e-6
            gap, title = max(gaps, default=(math.nan, ""))
            reason = EXCEPTIONS.get(name.removesuffix("_Fl"))
            if whys or not gap <= 1e-6:
                named[name] = reason
                print(f"{name}: {gap:.2g} on {title or 'none'}; {'; '.join(sorted(set(whys)))[:200]}"
                      f"{' -- ' + reason if reason else ''}")
                failed += reason is None
            else:
                worst = max(worst, gap)
    print(f"{ran} of {len(files)} files run on all {len(wells)} wells; {agree} of {compared} cases "
          f"equal to 1e-6, the worst of the models that agree {worst:.2g}; {len(named)} models "
          f"differ, {failed} without a named reason; {ours_s:.1f} s against {theirs_s:.1f} s")
    sys.exit(1 if failed else 0)


main()
