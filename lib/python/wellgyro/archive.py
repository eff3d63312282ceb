"""Many runs at once: `wellgyro-archive jobs.csv --out runs/` on Dask.

One folder a run, written beside its name and put in place whole, and one Parquet data set for all.
A run is done again only where its job, data or this program changed; one that fails is a row, not
the end. `wellgyro-archive report runs/` sums the fleet up in one page, and `wellgyro-archive model
runs/ --assumed NAME` makes an error model of how runs of one well differ.
"""
from __future__ import annotations

import argparse
import asyncio
import contextlib
import csv
import dataclasses
import hashlib
import io
import json
import os
import re
import sys
import tempfile
import threading
import time
import tomllib
import traceback

import fsspec
import pandas as pd
from fsspec.implementations.local import LocalFileSystem

from . import _wellgyro
from ._fleet import report
from .compare import empirical_model
from .survey import Job, survey

_TABLES = ("stations", "checks", "runs")
_MANY = 2000  # tasks in flight: memory of the scheduler stays flat however many runs there are
_FIRST = 200  # of these, before it is known how long a run takes
_SECONDS = 1.0  # of work in a task, beside some 5 ms that scheduling it takes


@dataclasses.dataclass(frozen=True)
class Run:
    """One row of jobs.csv."""
    name: str
    job: str
    data: tuple[str, ...]
    well: str = ""  #: absent: as the job names it
    tool: str = ""  #: absent: the serial number of the job's tool


def read_jobs(path: str) -> list[Run]:
    """jobs.csv: name, job, data (paths with ';' between); relative to its folder; well and tool where
    the job does not name them. Names are those of folders: letters, digits, '.', '_' and '-'. Raises
    ValueError with the line."""
    with fsspec.open(path, "rt", encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    base = path.rpartition("/")[0]

    def absolute(part):
        known = "://" in part or part.startswith("/")
        return part if known or not base else base + "/" + part

    runs, seen = [], set()
    for line, row in enumerate(rows, 2):
        missing = [c for c in ("name", "job", "data") if not row.get(c)]
        if missing:
            raise ValueError(f"{path}:{line}: {missing[0]} is missing")
        name = row["name"]
        if not re.fullmatch(r"[A-Za-z0-9_-][A-Za-z0-9._-]{0,199}", name):
            raise ValueError(f"{path}:{line}: {name!r} is no name of a folder")
        if name in seen:
            raise ValueError(f"{path}:{line}: {name} stands twice")
        seen.add(name)
        runs.append(Run(name, absolute(row["job"]),
                        tuple(absolute(p.strip()) for p in row["data"].split(";")),
                        row.get("well") or "", row.get("tool") or ""))
    if not runs:
        raise ValueError(f"{path}: no run is listed")
    return runs


def _local(path, folder):
    """The path itself where it is a file of this machine, else of a copy of it in `folder`."""
    if "://" not in path:
        return path
    copy = os.path.join(folder, hashlib.sha256(path.encode()).hexdigest()[:8] + "-"
                        + path.rsplit("/", 1)[-1])
    with fsspec.open(path, "rb") as source, open(copy, "wb") as target:
        while block := source.read(1 << 20):
            target.write(block)
    return copy


def _digest(digest, path):
    with open(path, "rb") as file:
        while block := file.read(1 << 20):
            digest.update(block)
    digest.update(b"\0")


def _program():
    """What the numbers depend on besides the inputs: the module's own bytes, and these."""
    digest = hashlib.sha256(_wellgyro.version.encode())
    _digest(digest, _wellgyro.__file__)
    _digest(digest, __file__)
    return digest.hexdigest()


def _digest_job(digest, path):
    """Of a job with the files that it names."""
    _digest(digest, path)
    with open(path, "rb") as file:
        try:
            tables = tomllib.load(file)
        except (tomllib.TOMLDecodeError, UnicodeDecodeError):
            return
    folder = os.path.dirname(path)

    def texts(value):
        if isinstance(value, str):
            yield value
        for inner in (value.values() if isinstance(value, dict)
                      else value if isinstance(value, list) else ()):
            yield from texts(inner)

    for text in texts(tables):
        named = os.path.join(folder, text)
        if len(text) < 1000 and "\0" not in text and os.path.isfile(named):
            _digest(digest, named)


def _fingerprint(run, job, data, program):
    digest = hashlib.sha256(f"{program}\0{run.well}\0{run.tool}".encode())
    _digest_job(digest, job)
    for path in data:
        _digest(digest, path)
    return digest.hexdigest()


def _put(fs, folder, files):
    """A run's folder: its files first, done.json, which says what they are of, last; each is written
    under another name and renamed where the file system can."""
    fs.makedirs(folder, exist_ok=True)
    done = f"{folder}/done.json"
    if fs.exists(done):
        fs.rm(done)
    for left in fs.ls(folder, detail=False):  # by workers that were killed
        if ".part-" in left.rsplit("/", 1)[-1]:
            fs.rm(left)
    for name, content in files.items():
        part, whole = f"{folder}/.{name}.part-{os.getpid()}", f"{folder}/{name}"
        with fs.open(part, "wb") as file:
            file.write(content)
        _rename(fs, part, whole)


def _rename(fs, part, whole):
    if isinstance(fs, LocalFileSystem):
        os.replace(part, whole)
    else:
        fs.mv(part, whole)


def _parquet(frame):
    out = io.BytesIO()
    frame.to_parquet(out, engine="pyarrow", index=False)
    return out.getvalue()


def _state(fs, folder):
    try:
        with fs.open(f"{folder}/done.json", "rb") as file:
            return json.load(file)
    except (OSError, ValueError):
        return None


def survey_run(run: Run, out: str, program: str) -> dict:
    """One run, on whatever worker: its row of runs.csv. Never raises for what the run is."""
    fs, root = fsspec.core.url_to_fs(out)
    folder = f"{root}/{run.name}"
    row = {"name": run.name, "well": run.well, "tool": run.tool, "begin": "", "verdict": "",
           "causes": "", "error": "", "fingerprint": "", "done_again": True}
    with tempfile.TemporaryDirectory() as scratch:
        try:
            job = _local(run.job, scratch)
            data = [_local(p, scratch) for p in run.data]
            row["fingerprint"] = _fingerprint(run, job, data, program)
        except OSError as error:
            row["fingerprint"] = ""
            return _failed(fs, folder, row, error)
        known = _state(fs, folder)
        if known and known["fingerprint"] == row["fingerprint"]:
            return {**known, "done_again": False}
        try:
            known_job = Job.load(job)
            row["well"] = run.well or known_job.name
            row["tool"] = run.tool or known_job.tool_serial
            row["latitude_deg"] = known_job.latitude_deg
            result = survey(known_job, data if len(data) > 1 else data[0])
            if result.unusable:
                raise ValueError(result.unusable)
        except (OSError, ValueError, RuntimeError, MemoryError) as error:
            return _failed(fs, folder, row, error)
    row["verdict"] = result.verdict
    row["causes"] = "; ".join(result.causes)
    row["faults"] = result.fault_count
    row["begin"] = result.passes["utc"].min().isoformat() if len(result.passes) else ""
    files = {name: result.csv(name).encode() for name in ("survey.csv", "passes.csv", "checks.csv")}
    frames = {"stations": result.stations, "checks": result.checks, "runs": result.runs}
    for table, frame in frames.items():
        frame.insert(0, "name", run.name)
        files[f"{table}.parquet"] = _parquet(frame)
    files["done.json"] = json.dumps({k: v for k, v in row.items() if k != "done_again"},
                                    sort_keys=True).encode()
    _put(fs, folder, files)
    return row


def survey_runs(runs: list[Run], out: str, program: str) -> tuple[list[dict], float]:
    """Several runs in one task: their rows, and the seconds that they took."""
    begin = time.monotonic()
    rows = [survey_run(run, out, program) for run in runs]
    return rows, time.monotonic() - begin


def _failed(fs, folder, row, error):
    text = str(error).strip() or traceback.format_exception_only(error)[-1].strip()
    row.update(verdict="error", error=f"{type(error).__name__}: {text}")
    _put(fs, folder, {"done.json": json.dumps({k: v for k, v in row.items() if k != "done_again"},
                                              sort_keys=True).encode()})
    return row


def _gather(out, rows):
    """The data set of all: runs.csv and for each table one Parquet file, each replaced whole."""
    import pyarrow as pa
    import pyarrow.parquet as pq
    fs, root = fsspec.core.url_to_fs(out)
    rows = sorted(rows, key=lambda r: r["name"])
    frame = pd.DataFrame(rows, columns=["name", "well", "tool", "begin", "latitude_deg", "verdict",
                                        "causes", "error", "faults", "fingerprint"])
    _put_root(fs, root, "runs.csv", frame.to_csv(index=False, lineterminator="\n").encode())
    for table in _TABLES:
        part, writer = f"{root}/.{table}.parquet.part", None
        with fs.open(part, "wb") as file:
            for row in rows:
                if row["verdict"] == "error":
                    continue
                with fs.open(f"{root}/{row['name']}/{table}.parquet", "rb") as one:
                    piece = pq.read_table(pa.BufferReader(one.read()))
                piece = piece.replace_schema_metadata(None)
                if writer is None:
                    schema = pa.schema([pa.field(f.name, pa.string() if pa.types.is_null(f.type)
                                                 else f.type) for f in piece.schema])
                    writer = pq.ParquetWriter(file, schema)
                columns = {c: (piece.column(c).cast(schema.field(c).type) if c in
                               piece.column_names else pa.nulls(len(piece), schema.field(c).type))
                           for c in schema.names}
                writer.write_table(pa.table(columns, schema=schema))
            if writer is not None:
                writer.close()
        if writer is None:
            fs.rm(part)
        else:
            _rename(fs, part, f"{root}/{table}.parquet")


def _put_root(fs, root, name, content):
    part = f"{root}/.{name}.part"
    with fs.open(part, "wb") as file:
        file.write(content)
    _rename(fs, part, f"{root}/{name}")


class _Tasks:
    """Runs as tasks of a cluster, short runs several in one: as many as take a second by how long
    those before took, towards the end fewer, that all workers end together (guided
    self-scheduling; Polychronopoulos and Kuck, IEEE Transactions on Computers 36, 1987)."""

    def __init__(self, runs, out, program, client):
        from distributed import as_completed
        self._runs, self._out, self._program, self._client = runs, out, program, client
        self._next, self._done, self._seconds = 0, 0, 0.0
        self._pending = {}  # key of a future: its runs
        self._queue = as_completed()
        self._submit_more()

    def rows(self):
        """Those of one task after the other."""
        for future in self._queue:
            runs = self._pending.pop(future.key)
            try:
                rows, seconds = future.result()
            except Exception as error:  # of the cluster, not of the run: nothing is left half
                rows, seconds = self._lost(runs, error), 0.0
            future.release()
            self._done += len(rows)
            self._seconds += seconds
            self._submit_more()
            yield rows

    def _lost(self, runs, error):
        """Of many runs it is not known whose the error is: each is done again by itself."""
        if len(runs) > 1:
            for run in runs:
                self._submit([run])
            return []
        return [{"name": run.name, "well": run.well, "tool": run.tool, "verdict": "error",
                 "causes": "", "fingerprint": "", "done_again": True,
                 "error": f"{type(error).__name__}: {error}"} for run in runs]

    def _size(self):
        if self._seconds == 0:
            return 1
        in_time = int(_SECONDS * self._done / self._seconds)
        if in_time < 2:
            return 1
        threads = max(1, sum(self._client.nthreads().values()))
        return max(1, min(in_time, (len(self._runs) - self._next) // (2 * threads)))

    def _submit_more(self):
        size, most = self._size(), min(_MANY, _FIRST + self._done)
        while self._next < len(self._runs) and len(self._pending) < most:
            self._submit(self._runs[self._next:self._next + size])
            self._next += size

    def _submit(self, runs):
        # A killed worker's runs are done by another, however often that happens.
        key = f"wellgyro-{runs[0].name}-{len(runs)}-{self._program[:8]}"
        future = self._client.submit(survey_runs, runs, self._out, self._program, key=key,
                                     pure=False, retries=3)
        self._pending[future.key] = runs
        self._queue.add(future)


def process(runs: list[Run], out: str, client, *, progress=None) -> list[dict]:
    """Surveys `runs` into `out` on `client`, a dask.distributed.Client; their rows, by name."""
    fs, root = fsspec.core.url_to_fs(out)
    fs.makedirs(root, exist_ok=True)
    rows = []
    for some in _Tasks(runs, out, _program(), client).rows():
        rows += some
        if progress:
            progress(len(rows), len(runs))
    _gather(out, rows)
    return sorted(rows, key=lambda r: r["name"])


def model(out: str, assumed: str, *, local_sigma_deg: float = 0.05):
    """An `EmpiricalModel` (compare.py) from the runs of each well that `out` holds, `assumed` before:
    the chosen stations of every run that did not fail, wells by their names."""
    with fsspec.open(f"{out}/runs.csv", "rt", encoding="utf-8") as file:
        runs = pd.read_csv(file, keep_default_na=False)
    runs = runs[runs.verdict.isin(["pass", "warn"])]
    holes = []
    for well, group in runs.groupby("well"):
        if len(group) < 2:
            continue
        surveys = []
        for name in group.name:
            with fsspec.open(f"{out}/{name}/stations.parquet", "rb") as file:
                stations = pd.read_parquet(file)
            measured = stations[["md_m", "inclination_deg", "azimuth_true_deg"]].notna().all(axis=1)
            if measured.sum() > 2:
                surveys.append(stations[measured].reset_index(drop=True))
        if len(surveys) > 1:
            holes.append({"name": well, "surveys": surveys,
                          "latitude_deg": float(group.latitude_deg.iloc[0])})
    if not holes:
        raise ValueError(f"{out}: no well has two runs that passed")
    return empirical_model(holes, assumed, local_sigma_deg=local_sigma_deg)


@contextlib.contextmanager
def local_cluster(workers: int | None = None, **options):
    """A Dask cluster of processes of this machine. Workers that die are replaced as long as it
    stands: Dask itself gives those up that die while they start."""
    import dask
    from distributed import LocalCluster
    # A run whose worker is killed says nothing against the run.
    with dask.config.set({"distributed.scheduler.allowed-failures": 1000}):
        cluster = LocalCluster(n_workers=workers, threads_per_worker=1, host="127.0.0.1", **options)
    over, dead = threading.Event(), set()

    def replace():
        gone = {name for name, nanny in cluster.workers.items() if not nanny.is_alive()}
        for name in gone & dead:  # seen so twice: none that is just being started again
            asyncio.ensure_future(cluster.workers.pop(name).close())
        if gone & dead or set(cluster.worker_spec) - set(cluster.workers):
            cluster.scale(len(cluster.worker_spec))
        dead.clear()
        dead.update(gone)

    def watch():
        while not over.wait(1.0):
            cluster.loop.add_callback(replace)

    watching = threading.Thread(target=watch, daemon=True)
    watching.start()
    try:
        yield cluster
    finally:
        over.set()
        watching.join()
        cluster.close()


def _show(done, total):
    if sys.stderr.isatty():
        print(f"\r{done} of {total} runs", end="" if done < total else "\n", file=sys.stderr)


def _main_report(arguments):
    parser = argparse.ArgumentParser("wellgyro-archive report",
                                     description="One page of the fleet: RUNS/report.html")
    parser.add_argument("runs", help="folder that wellgyro-archive wrote")
    out = parser.parse_args(arguments).runs.rstrip("/")
    try:
        text = report(out)
        fs, root = fsspec.core.url_to_fs(out)
        _put_root(fs, root, "report.html", text.encode())
    except OSError as error:
        print(f"wellgyro-archive: {error}", file=sys.stderr)
        return 2
    print(f"{out}/report.html")
    return 0


def _main_model(arguments):
    parser = argparse.ArgumentParser(
        "wellgyro-archive model", description="Magnitudes of an error model from how the runs of "
        "each well differ, with 95 % intervals; estimates.csv and holes.csv beside it.",
        epilog="Example: wellgyro-archive model runs/ --assumed GYRO-NS-CT --out model.toml")
    parser.add_argument("runs", help="folder that wellgyro-archive wrote")
    parser.add_argument("--assumed", required=True, help="error model, a name or a file")
    parser.add_argument("--out", required=True, help="file for the model")
    parser.add_argument("--local-sigma-deg", type=float, default=0.05,
                        help="where the search for what no term speaks of begins")
    options = parser.parse_args(arguments)
    try:
        made = model(options.runs.rstrip("/"), options.assumed,
                     local_sigma_deg=options.local_sigma_deg)
        folder = os.path.dirname(os.path.abspath(options.out))
        fs = LocalFileSystem()
        for name, text in made.files.items():
            name = os.path.basename(options.out) if name == "model.toml" else name
            _put_root(fs, folder, name, text.encode())
    except (OSError, ValueError) as error:
        print(f"wellgyro-archive: {error}", file=sys.stderr)
        return 2
    for note in made.notes:
        print(f"note: {note}", file=sys.stderr)
    found = made.terms[made.terms.kept == ""]
    print(found.drop(columns=["weight", "kept"]).to_string(index=False))
    print(f"{options.out}: {len(found) - 1} of {len(made.terms) - 1} terms estimated from "
          f"{made.holes.surveys.sum()} runs in {len(made.holes)} wells")
    return 0


def main(arguments=None) -> int:
    """The command wellgyro-archive; its exit code: 0 every run usable, 3 some are not, 1 the command
    line, 2 nothing could be done."""
    arguments = sys.argv[1:] if arguments is None else list(arguments)
    if arguments[:1] == ["report"]:
        return _main_report(arguments[1:])
    if arguments[:1] == ["model"]:
        return _main_model(arguments[1:])
    parser = argparse.ArgumentParser(
        "wellgyro-archive", description="Surveys every run of a list, again only where its inputs "
        "or this program changed. 'wellgyro-archive report RUNS' makes a page of what came, 'wellgyro-archive "
        "model RUNS' an error model.",
        epilog="Example: wellgyro-archive jobs.csv --out runs/ --workers 8")
    parser.add_argument("jobs", help="CSV with the columns name, job, data; paths by fsspec")
    parser.add_argument("--out", required=True, help="folder for the results, by fsspec")
    parser.add_argument("--scheduler", help="of a Dask cluster that is there, tcp://...; else one is "
                        "started on this machine")
    parser.add_argument("--workers", type=int, help="processes of a cluster of this machine")
    options = parser.parse_args(arguments)
    try:
        runs = read_jobs(options.jobs)
    except (OSError, ValueError) as error:
        print(f"wellgyro-archive: {error}", file=sys.stderr)
        return 2
    from distributed import Client
    with contextlib.ExitStack() as stack:
        cluster = options.scheduler or stack.enter_context(
            local_cluster(options.workers, dashboard_address="127.0.0.1:0"))
        client = stack.enter_context(Client(cluster))
        if client.dashboard_link:
            print(f"dashboard: {client.dashboard_link}", file=sys.stderr)
        rows = process(runs, options.out.rstrip("/"), client, progress=_show)
    again = sum(r["done_again"] for r in rows)
    counts = pd.Series([r["verdict"] for r in rows]).value_counts()
    print(f"{len(rows)} runs, {again} done now: "
          + ", ".join(f"{n} {verdict}" for verdict, n in counts.items()))
    for row in rows:
        if row["verdict"] == "error":
            print(f"{row['name']}: {row['error']}", file=sys.stderr)
    return 3 if "error" in counts else 0


if __name__ == "__main__":
    sys.exit(main())
