#!/usr/bin/python3
# Copyright 2026 the allan_lio authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a run of scripts/bench --soak shows: its figures against their limits, as a table and a PNG."""
import csv
import math

import numpy as np
import yaml

from bench_suite import BenchError

SLOPE = 1.0  # of the resident memory after the warm-up [MB/h]
SIGMAS = 3.0
# What is resident goes up and down with what is under way and what the allocator gives back, by up to 4 MB within two
# laps (nine runs): in a run so short that looks like a slope of 100 MB/h, now and then by more than its error [MB].
SWING = 5.0
LAG = 1.0  # from a scan's end to its status, by the clock of the data [s]; 0.4 s are under way by design
DRIFT = 0.0002  # of the distance walked, which the largest error of the position may be...
DRIFT_FLOOR = 0.05  # ... or this, if it is more [m]
# Messages of the IMU before the first state has reached the propagation: a second of standstill, a scan of 0.1 s, and
# the 0.4 s that are under way by design, at 200 Hz. Whatever is lost later is counted apart.
IMU_START = 300
PER_SCAN = ("/lidar_odometry/odometry", "/lidar_odometry/state", "/lidar_odometry/status")
# What is for display has a queue of a few messages: a listener that is slower than the run gets the newest.
DISPLAYS = ("/lidar_odometry/path", "/lidar_odometry/points", "/lidar_odometry/map")
DROPS = (("scans", "skipped"), ("scans", "map_restarts"), ("points", "invalid"), ("imu", "dropped_not_newer"),
         ("imu", "dropped_invalid"), ("imu", "gaps"), ("imu", "starts_in_place"))


class Check:
    """One line of the table."""

    def __init__(self, what, value, limit, good):
        self.what, self.value, self.limit, self.good = what, value, limit, bool(good)


def read_csv(path):
    with open(str(path), newline="") as file:
        return list(csv.DictReader(file))


def slope_of(hours, values):
    """Least-squares slope and its standard error."""
    centred = hours - hours.mean()
    spread = float((centred ** 2).sum())
    slope = float((centred * values).sum()) / spread
    residuals = values - values.mean() - slope * centred
    return slope, math.sqrt(float((residuals ** 2).sum()) / (len(values) - 2) / spread)


def memory_checks(rows, warm_up, cap):
    warm = rows["t"] >= warm_up
    if warm.sum() < 3:
        raise BenchError("the run is not longer than its warm-up of {:g} s".format(warm_up))
    after, rss, lag = "after {:g} s".format(warm_up), rows["rss_mb"][warm], rows["lag"][warm]
    hours = rows["t"][warm] / 3600.0
    slope, error = slope_of(hours, rss)
    # A short run can only show that memory grows, not that it does not: said, so that nobody takes it for the other.
    telling = SIGMAS * error < SLOPE
    grows = slope >= SLOPE if telling else slope - SIGMAS * error >= SLOPE and slope * np.ptp(hours) > SWING
    yield Check("RSS {}: slope [MB/h]".format(after), "{:.2f} +- {:.2f}".format(slope, error), "< {:g}{}".format(
        SLOPE, "" if telling else ", too short a run to show it"), not grows)
    yield Check("RSS {}: least, most [MB]".format(after), "{:.1f}, {:.1f}".format(rss.min(), rss.max()), "measured",
                np.isfinite(rows["rss_mb"]).all())
    yield Check("map: most [MB]", "{:.3f}".format(rows["map_mb"].max()), "<= {:g}".format(cap),
                rows["map_mb"].max() <= cap)
    yield Check("lag {}: longest [s]".format(after), "{:.3f}".format(lag.max()), "< {:g}".format(LAG), lag.max() < LAG)


def imu_checks(topics, answers, samples):
    """Every IMU sample after the start got its odometry, or a state that says more."""
    missing = samples - topics["/imu_odometry"]["published"] - answers["superseded"]
    yield Check("of {} IMU messages: superseded by a newer state before the propagation saw them".format(samples),
                answers["superseded"], "measured", True)
    yield Check("of {} IMU messages: without an answer".format(samples), missing, "<= {}, the start".format(IMU_START),
                0 <= missing <= IMU_START and answers["lost"] == 0)


def message_checks(topics, answers, summary):
    topics = {row["topic"]: {k: int(v) for k, v in row.items() if k != "topic"} for row in topics}
    scans = summary["scans"]
    dropped = {"{}/{}".format(*key): summary[key[0]][key[1]] for key in DROPS if summary[key[0]][key[1]]}
    yield Check("scans used of read", "{} of {}".format(scans["used"], scans["read"]), "all, nothing dropped {}".format(
        dropped or ""), scans["used"] == scans["read"] > 0 and not dropped)
    for topic in PER_SCAN:
        yield Check("messages on {}".format(topic), topics[topic]["published"], "one a scan",
                    topics[topic]["published"] == scans["used"])
    yield from imu_checks(topics, {k: int(v) for k, v in answers.items()}, summary["imu"]["samples"])
    count = sum(row["received"] for row in topics.values())
    lost = {topic: row["lost"] for topic, row in topics.items() if row["lost"]}
    estimates = {topic: n for topic, n in lost.items() if topic not in DISPLAYS}
    yield Check("messages lost of {} to a listener".format(count), lost or 0, "none but of what is for display",
                not estimates)
    silent = [topic for topic, row in topics.items() if row["received"] == 0]
    yield Check("topics of {} that were silent".format(len(topics)), ", ".join(silent) or 0, "none", not silent)
    senseless = {topic: row["not_finite"] for topic, row in topics.items() if row["not_finite"]}
    yield Check("messages with NaN or inf", senseless or 0, "none", not senseless)


def read_tum(path):
    return np.loadtxt(str(path), ndmin=2)[:, :4]


def alignment(estimate, truth):
    """The rigid motion that lays the estimate on the truth (least squares, Umeyama), as a function of points."""
    u, _, vt = np.linalg.svd((truth - truth.mean(0)).T @ (estimate - estimate.mean(0)))
    rotation = u @ np.diag([1, 1, np.linalg.det(u @ vt)]) @ vt
    return lambda points: (points - estimate.mean(0)) @ rotation.T + truth.mean(0)


def trajectory_checks(out, run):
    """Against the truth of the lap, walked over and over."""
    lap, estimate = read_tum(out / "lap.tum"), read_tum(out / "run" / "trajectory.tum")
    within = (estimate[:, 0] - lap[0, 0]) % run["period"] + lap[0, 0]
    truth = np.stack([np.interp(within, lap[:, 0], lap[:, k]) for k in (1, 2, 3)], 1)
    first = estimate[:, 0] < lap[0, 0] + run["period"]
    length = float(np.linalg.norm(np.diff(lap[:, 1:], axis=0), axis=1).sum())
    distance = length * (estimate[-1, 0] - estimate[0, 0]) / run["period"]
    limit = max(DRIFT_FLOOR, DRIFT * distance)
    # Aligned on the first lap alone: what drifts away later counts in full.
    errors = np.linalg.norm(alignment(estimate[first, 1:], truth[first])(estimate[:, 1:]) - truth, axis=1)
    finite = np.isfinite(estimate).all() and (np.diff(estimate[:, 0]) > 0).all()
    yield Check("position after {:.1f} km: largest error [m]".format(distance / 1000), "{:.3f}".format(errors.max()),
                "< {:.2f}".format(limit), finite and errors.max() < limit)


def judge(out, warm_up):
    """Every Check of a finished run. BenchError if it is not one."""
    try:
        run = yaml.safe_load((out / "run.yaml").read_text())
        summary = yaml.safe_load((out / "run" / "summary.yaml").read_text())
        table = read_csv(out / "soak.csv")
        rows = {key: np.array([float(row[key]) for row in table]) for key in table[0]}
        checks = [Check("simulated [h] in wall time [min]", "{:.2f} in {:.1f}, {:.0f} times real time".format(
            run["hours"], run["wall_seconds"] / 60, 3600 * run["hours"] / run["wall_seconds"]), "complete",
                        summary["status"] == "complete")]
        checks += memory_checks(rows, warm_up, run["map_cap_mb"])
        checks += message_checks(read_csv(out / "topics.csv"), read_csv(out / "imu_answers.csv")[0], summary)
        checks += trajectory_checks(out, run)
    except (OSError, KeyError, IndexError, ValueError) as error:
        raise BenchError("{}: not a whole run of --soak: {!r}".format(out, error)) from error
    return checks, rows


def draw(rows, out):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    figure, axes = pyplot.subplots(3, 1, sharex=True, figsize=(9, 7))
    for axis, key, label in zip(axes, ("rss_mb", "map_mb", "lag"), ("RSS [MB]", "map [MB]", "longest lag [s]")):
        axis.plot(rows["t"] / 3600.0, rows[key], lw=1, color="#1f5fa8")
        axis.set_ylabel(label)
        axis.grid(alpha=0.3)
    axes[-1].set_xlabel("simulated time [h]")
    figure.tight_layout()
    figure.savefig(str(out / "soak.png"), dpi=110)


def report(out, warm_up):
    """Prints the table, draws, and gives the exit status."""
    checks, rows = judge(out, warm_up)
    draw(rows, out)
    print("| what | measured | limit | |\n| --- | --- | --- | --- |")
    for check in checks:
        print("| {} | {} | {} | {} |".format(check.what, check.value, check.limit, "ok" if check.good else "BROKEN"))
    return 0 if all(check.good for check in checks) else 1


if __name__ == "__main__":
    raise SystemExit("bench_soak_judge.py belongs to scripts/bench, which is what to run")
