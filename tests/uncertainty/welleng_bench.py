#!/usr/bin/env python3
"""How fast welleng works through GYRO-NS-CT, for comparison with bench-uncertainty: the same well,
all terms. Says so and does nothing more where welleng is not installed."""
import sys
import time
import warnings

try:
    import numpy as np
    import welleng as we
    from welleng.survey import Survey, SurveyHeader
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(0)


def rate(n):
    md = np.arange(n, dtype=float)
    u = md / n
    inc = 80 * np.clip(2 * (u - 0.1), 0, 1)
    azi = np.degrees(2.5 * u)
    header = SurveyHeader(latitude=60.0, azi_reference="true", b_total=50000.0, dip=72.0,
                          declination=0.0, convergence=0.0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        survey = Survey(md=md, inc=inc, azi=azi, header=header)
        begin = time.perf_counter()
        we.error.ErrorModel(survey, error_model="GYRO-NS-CT")
        return n / (time.perf_counter() - begin)


print(f"welleng {we.__version__}")
for n in (1000, 10000, 100000):
    print(f"{n} stations: {rate(n):.0f} stations/s")
