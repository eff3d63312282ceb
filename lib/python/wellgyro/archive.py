"""Many runs at once: `wellgyro-archive jobs.csv --out runs/` on Dask.

One folder a run, written beside its name and put in place whole, and one Parquet data set for all.
A run is done again only where its job, data or this program changed; one that fails is a row, not
the end. `wellgyro-archive report runs/` sums the fleet up in one page.
"""
from __future__ import annotations

import argparse
import csv
import dataclasses
import hashlib
import html
import io
import json
import os
import re
import sys
import tempfile
import tomllib
import traceback

import fsspec
import pandas as pd
from fsspec.implementations.local import LocalFileSystem

from . import _wellgyro
from .survey import Job, survey

_TABLES = ("stations", "checks", "runs")
_MANY = 2000  # runs in flight: memory of the scheduler stays flat however many there are


@dataclasses.dataclass(frozen=True)
class Run:
    """One row of jobs.csv."""
    name: str
    job: str
    data: tuple[str, ...]


def read_jobs(path: str) -> list[Run]:
    """jobs.csv: name, job, data (paths with ';' between); relative to its folder. Names are those of
    folders: letters, digits, '.', '_' and '-'. Raises ValueError with the line."""
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
                        tuple(absolute(p.strip()) for p in row["data"].split(";"))))
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
    """What the numbers depend on besides the inputs: the module's own bytes."""
    digest = hashlib.sha256(_wellgyro.version.encode())
    _digest(digest, _wellgyro.__file__)
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


def _fingerprint(job, data, program):
    digest = hashlib.sha256(program.encode())
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
    row = {"name": run.name, "verdict": "", "causes": "", "error": "", "fingerprint": "",
           "done_again": True}
    with tempfile.TemporaryDirectory() as scratch:
        try:
            job = _local(run.job, scratch)
            data = [_local(p, scratch) for p in run.data]
            row["fingerprint"] = _fingerprint(job, data, program)
        except OSError as error:
            row["fingerprint"] = ""
            return _failed(fs, folder, row, error)
        known = _state(fs, folder)
        if known and known["fingerprint"] == row["fingerprint"]:
            return {**known, "done_again": False}
        try:
            result = survey(Job.load(job), data if len(data) > 1 else data[0])
            if result.unusable:
                raise ValueError(result.unusable)
        except (OSError, ValueError, RuntimeError, MemoryError) as error:
            return _failed(fs, folder, row, error)
    row["verdict"] = result.verdict
    row["causes"] = "; ".join(result.causes)
    row["faults"] = result.fault_count
    files = {name: result.csv(name).encode() for name in ("survey.csv", "passes.csv", "checks.csv")}
    frames = {"stations": result.stations, "checks": result.checks, "runs": result.runs}
    for table, frame in frames.items():
        frame.insert(0, "name", run.name)
        files[f"{table}.parquet"] = _parquet(frame)
    files["done.json"] = json.dumps({k: v for k, v in row.items() if k != "done_again"},
                                    sort_keys=True).encode()
    _put(fs, folder, files)
    return row


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
    frame = pd.DataFrame(rows, columns=["name", "verdict", "causes", "error", "faults",
                                        "fingerprint"])
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


def process(runs: list[Run], out: str, client, *, progress=None) -> list[dict]:
    """Surveys `runs` into `out` on `client`, a dask.distributed.Client; their rows, by name."""
    from distributed import as_completed
    fs, root = fsspec.core.url_to_fs(out)
    fs.makedirs(root, exist_ok=True)
    program = _program()
    waiting = iter(runs)
    rows = []

    def submit(run):
        # A killed worker's run is done by another, however often that happens.
        return client.submit(survey_run, run, out, program, key=f"wellgyro-{run.name}-{program[:8]}",
                             pure=False, retries=3)

    first = [submit(run) for _, run in zip(range(_MANY), waiting)]
    names = {future.key: run for future, run in zip(first, runs)}
    queue = as_completed(first)
    for future in queue:
        run = names.pop(future.key)
        try:
            rows.append(future.result())
        except Exception as error:  # of the cluster, not of the run: nothing is left half
            rows.append({"name": run.name, "verdict": "error", "causes": "", "fingerprint": "",
                         "error": f"{type(error).__name__}: {error}", "done_again": True})
        future.release()
        if progress:
            progress(len(rows), len(runs))
        following = next(waiting, None)
        if following is not None:
            added = submit(following)
            names[added.key] = following
            queue.add(added)
    _gather(out, rows)
    return sorted(rows, key=lambda r: r["name"])


def report(out: str) -> str:
    """One HTML page of the fleet, from runs.csv and checks.parquet."""
    with fsspec.open(f"{out}/runs.csv", "rt", encoding="utf-8") as file:
        runs = pd.read_csv(file, keep_default_na=False)
    counts = runs.verdict.value_counts()
    causes = pd.Series([c.split(" (")[0] for row in runs.causes for c in row.split("; ") if c],
                       dtype=object).value_counts()

    def table(head, rows):
        cells = "".join(f"<th>{html.escape(h)}</th>" for h in head)
        body = "".join("<tr>" + "".join(f"<td>{html.escape(str(c))}</td>" for c in r) + "</tr>"
                       for r in rows)
        return f"<table><thead><tr>{cells}</tr></thead><tbody>{body}</tbody></table>"

    checks = ""
    fs, root = fsspec.core.url_to_fs(out)
    if fs.exists(f"{root}/checks.parquet"):
        with fs.open(f"{root}/checks.parquet", "rb") as file:
            frame = pd.read_parquet(file, columns=["name", "code", "value", "sigma", "limit",
                                                   "unit", "verdict"])
        made = frame[frame.verdict != "not_done"]
        rows = []
        for code, group in made.groupby("code"):
            share = (group.value.abs() / group.limit).where(group.limit > 0)
            judged = share.notna().any()
            rows.append((code, group.unit.iloc[0], len(group), f"{group.value.median():.4g}",
                         f"{share.median():.3f}" if judged else "",
                         f"{share.max():.3f}" if judged else "",
                         group.name[share.idxmax()] if judged else "",
                         int((group.verdict == "warn").sum()),
                         int((group.verdict == "fail").sum())))
        rows.sort(key=lambda r: (-r[-1], -r[-2], r[0]))
        checks = "<h2>Checks</h2>" + table(
            ("check", "unit", "made", "median", "median of limit", "most of limit", "by", "warn",
             "fail"), rows)
    bad = runs[runs.verdict.isin(["fail", "error"])]
    style = ("body{font:15px/1.5 sans-serif;margin:2em auto;max-width:72em;padding:0 1em;"
             "color:#222}table{border-collapse:collapse;width:100%}th,td{text-align:left;"
             "padding:.2em .8em .2em 0;border-bottom:1px solid #ddd;vertical-align:top}"
             "td{overflow-wrap:anywhere}")
    return (f"<!doctype html><html lang='en'><meta charset='utf-8'><title>Archive of {len(runs)} "
            f"runs</title><style>{style}</style><h1>Archive of {len(runs)} runs</h1>"
            + table(("verdict", "runs"), counts.items()) + "<h2>Causes</h2>"
            + table(("cause", "runs"), causes.items()) + checks
            + "<h2>Failed and unusable runs</h2>"
            + table(("run", "verdict", "why"),
                    [(r.name_, r.verdict, r.error or r.causes) for r in
                     bad.rename(columns={"name": "name_"}).itertuples()]) + "</html>\n")


def _show(done, total):
    if sys.stderr.isatty():
        print(f"\r{done} of {total} runs", end="" if done < total else "\n", file=sys.stderr)


def main(arguments=None) -> int:
    """The command wellgyro-archive; its exit code: 0 every run usable, 3 some are not, 1 the command
    line, 2 nothing could be done."""
    arguments = sys.argv[1:] if arguments is None else list(arguments)
    if arguments[:1] == ["report"]:
        parser = argparse.ArgumentParser("wellgyro-archive report",
                                         description="One page of the fleet: RUNS/report.html")
        parser.add_argument("runs", help="folder that wellgyro-archive wrote")
        options = parser.parse_args(arguments[1:])
        try:
            text = report(options.runs.rstrip("/"))
            fs, root = fsspec.core.url_to_fs(options.runs.rstrip("/"))
            _put_root(fs, root, "report.html", text.encode())
        except OSError as error:
            print(f"wellgyro-archive: {error}", file=sys.stderr)
            return 2
        print(f"{options.runs.rstrip('/')}/report.html")
        return 0
    parser = argparse.ArgumentParser(
        "wellgyro-archive", description="Surveys every run of a list, again only where its inputs "
        "or this program changed. 'wellgyro-archive report RUNS' makes a page of what came.",
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
    import dask
    from distributed import Client, LocalCluster
    # A run whose worker is killed says nothing against the run.
    dask.config.set({"distributed.scheduler.allowed-failures": 50})
    if options.scheduler:
        client, cluster = Client(options.scheduler), None
    else:
        cluster = LocalCluster(n_workers=options.workers, threads_per_worker=1,
                               dashboard_address="127.0.0.1:0", host="127.0.0.1")
        client = Client(cluster)
    try:
        if client.dashboard_link:
            print(f"dashboard: {client.dashboard_link}", file=sys.stderr)
        rows = process(runs, options.out.rstrip("/"), client, progress=_show)
    finally:
        client.close()
        if cluster is not None:
            cluster.close()
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
