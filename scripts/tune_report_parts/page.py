# Copyright 2026 the allan_lio authors
# SPDX-License-Identifier: BSD-3-Clause
"""The page itself: one function a section, each well-formed and with every text of a file escaped."""
import math
import os
from html import escape

from . import drawing, trajectories
from .tables import settings_table, table
from .tuning_data import COEFFICIENTS, BadInput, a_map, number

OBJECTIVES = {"ate": "position error (ATE)", "nll": "negative log-likelihood of what the IMU predicts over 3 to 30 s",
              "scan_nll": "negative log-likelihood of the innovations from scan to scan"}
NIS = (("horizon_nis_per_dof", "over 3 to 30 s"), ("nis_per_dof", "from scan to scan"))


def render(tuning):
    """The whole page."""
    with open(os.path.join(os.path.dirname(__file__), "style.css"), encoding="utf-8") as file:
        style = file.read()
    sections = (best_setting, rounds, settings, heat_map, profiles, nis, paths, hold_out, repeat)
    body = "\n".join(section(tuning) for section in sections)
    return (f'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8" />\n'
            f'<meta name="viewport" content="width=device-width, initial-scale=1" />\n<title>Noise tuning</title>\n'
            f"<style>\n{style}</style>\n</head>\n<body>\n{head(tuning)}\n<main>\n{body}\n</main>\n</body>\n</html>\n")


def section(name, title, *parts):
    return f'<section id="{name}">\n<h2>{escape(title)}</h2>\n' + "\n".join(parts) + "\n</section>"


def missing(text):
    return f'<p class="missing">{escape(text)}</p>'


def figure(source, alt, caption=""):
    caption = f"<figcaption>{escape(caption)}</figcaption>" if caption else ""
    return f'<figure><img src="{source}" alt="{escape(alt)}" />{caption}</figure>'


def head(tuning):
    problem, count = tuning.problem, len(tuning.settings)
    search, objective = str(problem.get("search", "-")), str(problem.get("objective", "-"))
    names = ", ".join(tuning.parameters) or "nothing"
    return (f'<header>\n<h1>Noise tuning</h1>\n<p class="lead">{escape(names)} by a {escape(search)} search over {count} '
            f"settings, judged by the {escape(OBJECTIVES.get(objective, objective))}, on "
            f'{tuning.tuned_bags} bag{"s" if tuning.tuned_bags != 1 else ""}, '
            f'{escape(str(problem.get("runs", 1)))} run(s) each.</p>\n</header>')


def best_setting(tuning):
    imu = "".join(f"  {name}: {value!r}\n" for name, value in zip(COEFFICIENTS[:4], tuning.best_key))
    block = f"imu:\n{imu}lidar:\n  k_r: {tuning.best_key[4]!r}\n"
    parts = ["<p>For your configuration:</p>", f"<pre>{escape(block)}</pre>", facts(tuning)]
    if tuning.best.get("end"):
        parts.append(f'<p class="note">The search ended: {escape(str(tuning.best["end"]))}.</p>')
    return section("best", "Best setting", *parts)


def facts(tuning):
    """Means over the bags tuned on, before and after."""
    items = []
    wanted = [("ate", "ATE, mean over the bags", " m")]
    wanted += [(name, f"NIS per degree of freedom {when}, mean over the bags", "") for name, when in NIS]
    for name, label, unit in wanted:
        found = [(figure_of(c, "before", name), figure_of(c, "after", name)) for c in tuning.comparisons
                 if not tuning.held_out(c)]
        found = [pair for pair in found if all(math.isfinite(v) for v in pair)]
        if found:
            before, after = (sum(pair[i] for pair in found) / len(found) for i in (0, 1))
            items.append(f"<li><b>{drawing.short(before)} → {drawing.short(after)}{unit}</b><span>{label}</span></li>")
    return f'<ul class="facts">{"".join(items)}</ul>' if items else ""


def figure_of(comparison, when, name):
    entry = a_map(comparison.get(when))
    if not name.endswith("nis_per_dof"):
        return number(entry.get(name))
    kind = name[:-len("nis_per_dof")]
    dof = number(entry.get(kind + "dof"))
    return number(entry.get(kind + "nis")) / dof if dof > 0 else math.nan


def rounds(tuning):
    """Empty where every setting had runs of its own."""
    if not tuning.rounds:
        return ""
    errors = (("white", "points"), ("view", "planes"), ("drift_rotation", "drift [rad/√s]"), ("drift_position", "[m/√s]"))
    rows = []
    for entry in tuning.rounds:
        at, found, lidar = (a_map(entry.get(key)) for key in ("at", "found", "lidar_errors"))
        cells = [f"{drawing.short(number(at.get(name)))} → {drawing.short(number(found.get(name)))}"
                 for name in tuning.parameters]
        runs = str(entry.get("runs", "-")) + (f', {entry["diverged"]} diverged' if entry.get("diverged") else "")
        rows.append(cells + [drawing.short(number(lidar.get(key))) for key, _ in errors] +
                    [drawing.short(number(entry.get("objective")), 6), runs])
    head = [*tuning.parameters, *(label for _, label in errors), "objective", "runs"]
    return section("rounds", "Rounds", "<p>Each round ran the filter with one setting and judged all others on the linear "
                   "filter of those runs; the best is the next round's. Fitted along: the noise of the LiDAR's points and of the "
                   "planes in view, as multiples of what the filter reckons with, and a drift of the map. The objective is that of the "
                   "runs themselves; there is none where only the bags whose runs were lost were run.</p>", table(head, rows))


def settings(tuning):
    if not tuning.settings:
        return section("settings", "Settings tried", missing("No setting is recorded."))
    return section("settings", "Settings tried", settings_table(tuning))


def heat_map(tuning):
    title = "k_gb against k_ab"
    grid = tuning.grid("k_gb", "k_ab")
    if grid is None:
        return section("heat-map", title, missing("The settings tried form no grid of k_gb and k_ab."))
    by_ate = tuning.problem.get("objective") == "ate"
    kept = [s for s in grid[2].values() if not (s.runs and s.diverged == s.runs) and math.isfinite(s.objective)]
    least = min((s.objective for s in kept), default=0.0)

    def shown(setting):
        if setting not in kept or (by_ate and not setting.ate):
            return math.nan
        return sum(setting.ate) / len(setting.ate) if by_ate else setting.objective - least

    label = "ATE, average [m]" if by_ate else "objective above its least [nats]"
    source = drawing.heat_map(grid, ("k_gb", "k_ab"), (tuning.best_key[2], tuning.best_key[3]), shown, label)
    return section("heat-map", title, figure(source, f"Heat map of {label} over k_gb and k_ab",
                                             "Star: the best setting. Hatched: all runs diverged."))


def profiles(tuning):
    title = "What the data tell about each coefficient"
    parts = []
    objective = tuning.problem.get("objective")
    for entry in tuning.profiles:
        name = str(entry.get("parameter"))
        points = profile_points(entry)
        if name not in COEFFICIENTS or not points:
            parts.append(missing(f"The profile of {name} holds no points."))
            continue
        verdict, interval = str(entry.get("verdict", "")), interval_text(entry)
        source = drawing.profile(name, points, ends_of(entry, "interval"), tuning.best_key[COEFFICIENTS.index(name)], objective)
        parts.append(f"<div><h3>{name}: {escape(verdict)}</h3><p>{escape(interval)}</p>"
                     f'{figure(source, f"Profile of the objective along {name}: {verdict}. {interval}")}</div>')
    return section("profiles", title, f'<div class="pair">{"".join(parts)}</div>' if parts else
                   missing("No profiles were computed."))


def profile_points(entry):
    """Sorted pairs; what diverged is left out."""
    points = [tuple(map(number, p)) for p in entry.get("points") or [] if isinstance(p, list) and len(p) == 2]
    return sorted((k, value) for k, value in points if k > 0 and math.isfinite(value))


def ends_of(entry, key):
    """An interval's two ends, NaN where it is open; None if there is no interval."""
    ends = entry.get(key)
    return tuple(map(number, ends)) if isinstance(ends, list) and len(ends) == 2 else None


def interval_text(entry):
    texts = []
    for key, name in (("interval", "95 % interval"), ("curvature_interval", "by the curvature"),
                      ("scan_interval", "from scan to scan")):
        ends = ends_of(entry, key)
        if ends:
            texts.append(f"{name} {' to '.join(drawing.short(v) if math.isfinite(v) else 'open' for v in ends)}")
    return "; ".join(texts)


def label_of(tuning, comparison):
    return tuning.bag_name(comparison.get("bag")) + (" (held out)" if tuning.held_out(comparison) else "")


def nis(tuning):
    rows = [(f"{label_of(tuning, c)}, {when}", figure_of(c, "before", name), figure_of(c, "after", name))
            for c in tuning.comparisons for name, when in NIS]
    rows = [row for row in rows if any(math.isfinite(v) and v > 0 for v in row[1:])]
    if not rows:
        return section("nis", "NIS before and after", missing("No NIS is recorded before and after the tuning."))
    alt = "; ".join(f"{name}: {drawing.short(before)} before, {drawing.short(after)} after" for name, before, after in rows)
    return section("nis", "NIS before and after", figure(
        drawing.consistency(rows), f"NIS per degree of freedom. {alt}",
        "1: the filter's covariance tells its error. Above 1 it is overconfident, below 1 too cautious."))


def paths(tuning):
    parts = []
    for comparison in tuning.comparisons:
        name = label_of(tuning, comparison)
        try:
            reference, compared = trajectories.compare(tuning, comparison)
        except BadInput as error:
            parts.append(f"<h3>{escape(name)}</h3>" + missing(f"Left out: {error}."))
            continue
        if compared:
            alt = f"Top view of the trajectory of {name} before and after" + (", and its error over time" if
                                                                             reference is not None else "")
            parts.append(f"<h3>{escape(name)}</h3>" + figure(drawing.paths(reference, compared), alt))
    return section("trajectories", "Trajectories and errors before and after",
                   *(parts or [missing("No trajectories are recorded.")]))


def hold_out(tuning):
    rows = []
    for c in filter(tuning.held_out, tuning.comparisons):
        row = [tuning.bag_name(c.get("bag"))]
        for name in ("ate", "horizon_nll", *(name for name, when in NIS)):
            row += [drawing.short(figure_of(c, when, name), 4) for when in ("before", "after")]
        rows.append(row)
    if not rows:
        return section("hold-out", "Bags held out", missing("No bag was held out: nothing here tells over-fitting."))
    names = ["bag", "ATE before [m]", "after", "NLL before", "after"]
    names += [word for name, when in NIS for word in (f"NIS/dof {when} before", "after")]
    return section("hold-out", "Bags held out", "<p>Scored with the best setting, not tuned on.</p>", table(names, rows))


def repeat(tuning):
    problem = tuning.problem
    rows = [[bag_kind, str(bag.get("name", "-")), str(bag.get("hash", "-"))] for bag_kind, bag in
            [("bag" if i < tuning.tuned_bags else "bag held out", b) for i, b in enumerate(tuning.bags)]]
    rows += [["configuration", str(problem.get("config", "-")), ""], ["seed", str(problem.get("seed", "-")), ""]]
    for key, label in (("versions", "version"), ("hashes", "hash")):
        found = problem.get(key)
        rows += [[label, str(name), str(value)] for name, value in (found.items() if isinstance(found, dict) else ())]
    before = ", ".join(f"{name} {value:g}" for name, value in zip(COEFFICIENTS, tuning.before_key))
    rows.append(["before", "what stands under “before”", before])
    command = problem.get("command")
    return section("repeat", "How to repeat it", f'<pre class="command">{escape(str(command))}</pre>' if command else
                   missing("The command is not recorded."), table(["what", "name", "value"], rows, texts=3))
