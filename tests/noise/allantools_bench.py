#!/usr/bin/env python3
"""Times allantools' oadev at octaves on 1e7 samples, beside bench-noise; says so when it is absent."""
import sys
import time

SAMPLES = 10_000_000

try:
    import allantools
    import numpy
except ImportError as error:
    print(f"left out: {error}; pip install allantools")
    sys.exit(0)

rate = numpy.random.default_rng(1).standard_normal(SAMPLES) + 1e3
start = time.perf_counter()
total = rate.sum()
read = time.perf_counter() - start
best = float("inf")
for _ in range(3):
    start = time.perf_counter()
    allantools.oadev(rate, rate=100.0, data_type="freq", taus="octave")
    best = min(best, time.perf_counter() - start)
print(f"allantools {allantools.__version__} oadev, octaves, {SAMPLES} samples: {best:.3f} s, "
      f"{1e9 * best / SAMPLES:.1f} ns a sample (numpy's sum of the array: "
      f"{1e9 * read / SAMPLES:.2f} ns)")
