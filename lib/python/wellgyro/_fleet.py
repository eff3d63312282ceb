"""One page of a fleet of runs: verdicts, causes, checks, tools out of family, tool errors in time."""
from __future__ import annotations

import html

import fsspec
import numpy as np
import pandas as pd

# What a run estimates of its tool; value over sigma is standard normal where the prior holds.
TOOL_ERRORS = ("gyro_bias_x", "gyro_bias_y", "gyro_bias_z", "mass_unbalance", "quadrature",
               "gyro_scale_x", "gyro_scale_y", "gyro_scale_z", "gyro_misalignment_x",
               "gyro_misalignment_y", "accel_bias_x", "accel_bias_y", "accel_bias_z",
               "accel_scale_x", "accel_scale_y", "accel_scale_z", "toolface_offset", "time_skew")
_OUT = 3.5  # modified z-score (Iglewicz and Hoaglin, How to Detect and Handle Outliers, 1993)
_STYLE = ("body{font:15px/1.5 sans-serif;margin:2em auto;max-width:72em;padding:0 1em;color:#222}"
          "table{border-collapse:collapse;width:100%}th,td{text-align:left;padding:.2em .8em .2em 0;"
          "border-bottom:1px solid #ddd;vertical-align:top}td{overflow-wrap:anywhere}"
          "svg{display:block;margin:.3em 0 1.2em}figcaption{font-size:90%}figure{margin:0}")


def table(head, rows, none="none"):
    """Rows of anything as HTML; `none` where there are none."""
    rows = list(rows)
    if not rows:
        return f"<p>{html.escape(none)}</p>"
    cells = "".join(f"<th>{html.escape(h)}</th>" for h in head)
    body = "".join("<tr>" + "".join(f"<td>{html.escape(str(c))}</td>" for c in r) + "</tr>"
                   for r in rows)
    return f"<table><thead><tr>{cells}</tr></thead><tbody>{body}</tbody></table>"


def out_of_family(errors: pd.DataFrame) -> pd.DataFrame:
    """Tools whose mean of value over sigma stands apart from those of the other tools.

    errors: tool, code, ratio. The spread of the family is 1.4826 times the median of the means'
    distances from their median, and at least what chance makes of a mean of so many runs; fewer than
    three tools are no family. Rows: tool, code, runs, mean, family, score."""
    rows = []
    for code, group in errors.groupby("code"):
        means = group.groupby("tool").ratio.agg(["mean", "count"])
        if len(means) < 3:
            continue
        middle = means["mean"].median()
        spread = 1.4826 * (means["mean"] - middle).abs().median()
        score = (means["mean"] - middle) / np.maximum(spread, 1 / np.sqrt(means["count"]))
        for tool in means.index[score.abs() > _OUT]:
            rows.append((tool, code, int(means["count"][tool]), means["mean"][tool], middle,
                         score[tool]))
    found = pd.DataFrame(rows, columns=["tool", "code", "runs", "mean", "family", "score"])
    return found.reindex(found.score.abs().sort_values(ascending=False).index)


def _in_time(errors, colours):
    """Value over sigma against time, a dot a run, with the lines of three sigmas."""
    width, height, most = 900, 110, max(4.0, float(errors.ratio.abs().max()) * 1.05)
    begin, end = errors.time.min(), errors.time.max()
    span = max((end - begin).total_seconds(), 1.0)

    def y(ratio):
        return height / 2 * (1 - ratio / most)

    lines = "".join(f"<line x1='0' x2='{width}' y1='{y(r):.1f}' y2='{y(r):.1f}' stroke='{c}'/>"
                    for r, c in ((0, "#999"), (3, "#d99"), (-3, "#d99")))
    def dot(e):
        text = (f"{e.name_}, {e.tool}, {e.time:%Y-%m-%d}: {e.value:.4g} {e.unit}, "
                f"{e.ratio:.2f} sigma")
        x = 10 + (width - 20) * (e.time - begin).total_seconds() / span
        return (f"<circle cx='{x:.1f}' cy='{y(e.ratio):.1f}' r='3' "
                f"fill='{colours.get(e.tool, '#666')}'><title>{html.escape(text)}</title></circle>")

    dots = "".join(map(dot, errors.itertuples()))
    return (f"<svg viewBox='0 0 {width} {height}' width='100%' role='img'>{lines}{dots}</svg>"
            f"<small>{begin:%Y-%m-%d} to {end:%Y-%m-%d}</small>")


def _tool_errors(checks, runs):
    """Checks of tool errors with their run's tool and time."""
    found = checks[checks.code.isin(TOOL_ERRORS) & (checks.sigma > 0) & checks.value.notna()]
    joined = found.merge(runs[["name", "tool", "begin"]], on="name")
    joined["ratio"] = joined.value / joined.sigma
    joined["time"] = pd.to_datetime(joined.begin, utc=True, format="ISO8601", errors="coerce")
    joined["tool"] = joined.tool.where(joined.tool != "", "not named")
    return joined.dropna(subset=["time"]).sort_values("time")


def _errors_in_time(errors):
    text = "<h2>Tool errors against their priors over time</h2>"
    if errors.empty:
        return text + "<p>no run estimated one</p>"
    tools = errors.tool.value_counts().index
    palette = ("#06c", "#c60", "#090", "#909", "#a00", "#077", "#850", "#444")
    colours = dict(zip(tools, palette))
    text += "<p>In sigmas of the prior, a dot a run; lines at 3. " + " ".join(
        f"<span style='color:{c}'>&#9679; {html.escape(t)}</span>" for t, c in colours.items()) + "</p>"
    for code, group in errors.groupby("code"):
        ratio = group.ratio
        rms = float(np.sqrt((ratio**2).mean()))
        text += (f"<figure><figcaption>{html.escape(code)} [{html.escape(group.unit.iloc[0])}]: "
                 f"{len(group)} runs, mean {ratio.mean():+.2f}, root mean square {rms:.2f} of the "
                 f"prior's sigma, last {ratio.iloc[-1]:+.2f}</figcaption>"
                 f"{_in_time(group.rename(columns={'name': 'name_'}), colours)}</figure>")
    return text


def _tools(runs, errors):
    verdicts = ("pass", "warn", "fail", "error")
    by_tool = runs.assign(tool=runs.tool.where(runs.tool != "", "not named")).groupby("tool")
    text = "<h2>Tools</h2>" + table(("tool", "runs", *verdicts), (
        (tool, len(g), *(int((g.verdict == v).sum()) for v in verdicts)) for tool, g in by_tool))
    named = errors[errors.tool != "not named"]
    text += "<h2>Tools out of family</h2>"
    if named.tool.nunique() < 3:
        return text + "<p>not judged: fewer than three tools are named</p>"
    return text + table(("tool", "error", "runs", "mean [sigma]", "family", "score"), (
        (r.tool, r.code, r.runs, f"{r.mean:+.2f}", f"{r.family:+.2f}", f"{r.score:+.1f}")
        for r in out_of_family(named)[["tool", "code", "runs", "mean", "family", "score"]]
        .itertuples(index=False)), f"none of {named.tool.nunique()}")


def _checks(frame):
    made = frame[frame.verdict != "not_done"]
    rows = []
    for code, group in made.groupby("code"):
        share = (group.value.abs() / group.limit).where(group.limit > 0)
        judged = share.notna().any()
        rows.append((code, group.unit.iloc[0], len(group), f"{group.value.median():.4g}",
                     f"{share.median():.3f}" if judged else "",
                     f"{share.max():.3f}" if judged else "",
                     group.name[share.idxmax()] if judged else "",
                     int((group.verdict == "warn").sum()), int((group.verdict == "fail").sum())))
    rows.sort(key=lambda r: (-r[-1], -r[-2], r[0]))
    return "<h2>Checks</h2>" + table(("check", "unit", "made", "median", "median of limit",
                                      "most of limit", "by", "warn", "fail"), rows)


def report(out: str) -> str:
    """One HTML page of the fleet, from runs.csv and checks.parquet."""
    with fsspec.open(f"{out}/runs.csv", "rt", encoding="utf-8") as file:
        runs = pd.read_csv(file, keep_default_na=False, dtype={"tool": str, "well": str})
    causes = pd.Series([c.split(" (")[0] for row in runs.causes for c in row.split("; ") if c],
                       dtype=object).value_counts()
    fs, root = fsspec.core.url_to_fs(out)
    checks = pd.DataFrame(columns=["name", "code", "value", "sigma", "limit", "unit", "verdict"])
    if fs.exists(f"{root}/checks.parquet"):
        with fs.open(f"{root}/checks.parquet", "rb") as file:
            checks = pd.read_parquet(file, columns=list(checks.columns))
    errors = _tool_errors(checks, runs)
    bad = runs[runs.verdict.isin(["fail", "error"])]
    return (f"<!doctype html><html lang='en'><meta charset='utf-8'><title>Archive of {len(runs)} "
            f"runs</title><style>{_STYLE}</style><h1>Archive of {len(runs)} runs</h1>"
            + table(("verdict", "runs"), runs.verdict.value_counts().items()) + "<h2>Causes</h2>"
            + table(("cause", "runs"), causes.items()) + _tools(runs, errors)
            + _errors_in_time(errors) + _checks(checks)
            + "<h2>Failed and unusable runs</h2>"
            + table(("run", "verdict", "why"),
                    [(r.name_, r.verdict, r.error or r.causes) for r in
                     bad.rename(columns={"name": "name_"}).itertuples()]) + "</html>\n")
