#!/usr/bin/python3
# Copyright 2026 the allan_lio authors
# SPDX-License-Identifier: BSD-3-Clause
"""The suites of config/suites: reads one, simulates its sequences, runs the filter, keeps the figures (for scripts/bench)."""
import concurrent.futures
import csv
import difflib
import hashlib
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import threading
import time

import yaml

ROOT = pathlib.Path(__file__).resolve().parent.parent
PASSED_ON = ("scene", "imu", "lidar", "imu_errors", "duration")  # to simulate_bag, as options of that name
SEQUENCE_KEYS = PASSED_ON + ("simulate", "config", "params", "axis", "bound", "seed_offset")
SUITE_KEYS = ("defaults", "sequences", "settings")
FREE_DISK = 4e9  # that must be left before a bag is made, per job [bytes]
SERIES_COLUMNS = ("t", "support", "e_along", "s_along", "dof_innovation")  # and nees_*: what averages over seeds need


class BenchError(Exception):
    """A sentence for the user."""


# --- the suite file ------------------------------------------------------------------------------------------------

def check_keys(mapping, known, place):
    if not isinstance(mapping, dict):
        raise BenchError("{}: must be a mapping".format(place))
    for key in mapping:
        if key not in known:
            near = difflib.get_close_matches(str(key), known, 1)
            raise BenchError("{}: unknown key '{}'{}".format(
                place, key, ", did you mean '{}'?".format(near[0]) if near else " (known: {})".format(", ".join(known))))


def check_scalars(mapping, place):
    if not isinstance(mapping, dict):
        raise BenchError("{}: must be a mapping".format(place))
    for key, value in mapping.items():
        if isinstance(value, (dict, type(None))) or not isinstance(key, str):
            raise BenchError("{}: '{}' needs a value".format(place, key))


def check_sequence(name, sequence, place):
    if not re.fullmatch(r"[A-Za-z0-9_.-]+", str(name)):
        raise BenchError("{}: a name holds letters, digits, '_', '-' and '.' only".format(place))
    if not isinstance(sequence.get("scene"), str):
        raise BenchError("{}: needs a scene".format(place))
    duration = sequence.get("duration", 1)
    if not isinstance(duration, (int, float)) or isinstance(duration, bool) or not duration > 0:
        raise BenchError("{}: duration: '{}' is not a positive number of seconds".format(place, duration))
    offset = sequence.get("seed_offset", 0)
    if not isinstance(offset, int) or isinstance(offset, bool) or offset < 0:
        raise BenchError("{}: seed_offset: '{}' is not a whole number from 0".format(place, offset))
    if not isinstance(sequence.get("bound", False), bool):
        raise BenchError("{}: bound: '{}' is not true or false".format(place, sequence["bound"]))
    axis = sequence.get("axis", "path")
    if axis not in ("path", "motion", "weakest") and not (
            isinstance(axis, list) and len(axis) == 3 and all(isinstance(v, (int, float)) for v in axis) and any(axis)):
        raise BenchError("{}: axis: '{}' is not path, motion, weakest or a direction [x, y, z]".format(place, axis))
    for key in ("simulate", "params"):
        check_scalars(sequence.get(key, {}), "{}: {}".format(place, key))


def load_suite(path):
    """Sequences by name, defaults filled in, and settings as (name, [KEY=VALUE]). Mistakes name file and key."""
    try:
        suite = yaml.safe_load(pathlib.Path(path).read_text())
    except (OSError, yaml.YAMLError) as error:
        raise BenchError("{}: {}".format(path, error)) from error
    check_keys(suite, SUITE_KEYS, path)
    defaults = suite.get("defaults") or {}
    check_keys(defaults, SEQUENCE_KEYS, "{}: defaults".format(path))
    if not isinstance(suite.get("sequences"), dict) or not suite["sequences"]:
        raise BenchError("{}: sequences: must be a mapping of at least one sequence".format(path))
    sequences = {}
    for name, own in suite["sequences"].items():
        place = "{}: sequences/{}".format(path, name)
        check_keys(own, SEQUENCE_KEYS, place)
        sequences[name] = dict(defaults, **own)
        check_sequence(name, sequences[name], place)
    settings = suite.get("settings") or {}
    check_scalars(settings, "{}: settings".format(path))
    return sequences, parse_settings(["{}={}".format(name, text) for name, text in settings.items()])


def parse_settings(texts):
    """NAME=KEY=VALUE[;KEY=VALUE] as (NAME, [KEY=VALUE])."""
    settings = []
    for text in texts:
        name, _, parameters = text.partition("=")
        parameters = [p.strip() for p in parameters.split(";") if p.strip()]
        if not name.strip() or any("=" not in p for p in parameters):
            raise BenchError("--setting '{}': must be NAME=KEY=VALUE[;KEY=VALUE]".format(text))
        settings.append((name.strip(), parameters))
    names = [name for name, _ in settings]
    for name in names:
        if names.count(name) > 1:
            raise BenchError("two settings have the name '{}' (a name ends at the first '=')".format(name))
    return settings


def parse_seeds(text):
    """"1,2,5" and "101-105"."""
    seeds = []
    for part in text.split(","):
        match = re.fullmatch(r"\s*(\d+)\s*(?:-\s*(\d+)\s*)?", part)
        if not match:
            raise BenchError("--seeds '{}': must be numbers and ranges such as 1,2,101-105".format(text))
        first, last = int(match.group(1)), int(match.group(2) or match.group(1))
        if last < first or last - first > 10000:
            raise BenchError("--seeds: {} is not a range".format(part.strip()))
        seeds += range(first, last + 1)
    return list(dict.fromkeys(seeds))


def chosen(sequences, only, path):
    """The names asked for, parted by commas; all if `only` is empty."""
    names = only.split(",") if only else list(sequences)
    for name in names:
        if name not in sequences:
            raise BenchError("--only: {} has no sequence '{}'".format(path, name))
    return names


# --- running ---------------------------------------------------------------------------------------------------------

def digest(*parts):
    state = hashlib.sha256()
    for part in parts:
        state.update(part if isinstance(part, bytes) else str(part).encode())
        state.update(b"\0")
    return state.hexdigest()[:16]


class Programs:
    """The executables of a build, run with its environment."""

    def __init__(self, directory):
        self.directory = pathlib.Path(directory)
        for name in ("simulate_bag", "lio_offline", "evaluate_trajectory"):
            if not (self.directory / name).exists():
                raise BenchError("{}: has no {}".format(self.directory, name))

    def run(self, name, *arguments):
        """What it prints; BenchError with its message if it fails."""
        setup = self.directory.parent.parent / "setup.bash"
        line = "set +u; [ -r '{0}' ] && source '{0}'; export ROS_PACKAGE_PATH='{1}':$ROS_PACKAGE_PATH; exec \"$@\"".format(
            setup, ROOT)
        environment = dict(os.environ, PATH="/usr/bin:/bin:" + os.environ["PATH"])
        result = subprocess.run(["bash", "-c", line, "bench", str(self.directory / name)] + [str(a) for a in arguments],
                                env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                universal_newlines=True)
        if result.returncode != 0:
            raise BenchError("{} failed: {}".format(name, result.stderr.strip()[-500:] or result.returncode))
        return result.stdout

    def hash(self):
        """Of the executables and the package's libraries that they load."""
        names = [self.directory / name for name in ("simulate_bag", "lio_offline", "evaluate_trajectory")]
        names += sorted(self.directory.parent.glob("liballan_lio_*.so"))
        return digest(*(path.read_bytes() for path in names))


def config_hash():
    files = sorted(p for p in (ROOT / "config").rglob("*.yaml") if p.parent.name != "suites")
    return digest(*(p.read_bytes() for p in files))


def simulate_arguments(sequence):
    options = {key.replace("_", "-"): sequence[key] for key in PASSED_ON if key in sequence}
    options.update(sequence.get("simulate", {}))
    arguments = []
    for key, value in options.items():
        if value is False:
            continue
        arguments.append("--" + key)
        if value is not True:
            arguments += [str(v) for v in (value if isinstance(value, list) else [value])]
    return arguments


def figures(error, summary):
    """One run's figures, flat."""
    consistency = error["consistency"]
    row = {"ate": error["ate"]["rmse"], "max": error["ate"]["max"], "drift_m": error["end_drift_m"],
           "drift_percent": error["end_drift_percent"], "rpe_10m_percent": error["rpe_10m"]["translation_percent"],
           "path": error["path_length"], "three_sigma_share": consistency["three_sigma_share"],
           "scans_used": summary["scans"]["used"], "scans_read": summary["scans"]["read"],
           "cpu_ms": summary["time_per_scan_ms"]["mean"], "map_mb": summary["map"]["megabytes"]}
    for block, nees in consistency["nees_per_dof"].items():
        row["nees_" + block] = nees["mean"] if nees else None
    longest = max(consistency["blind"], key=lambda b: b["seconds"], default=None)
    for key in ("seconds", "error", "sigma", "bound", "known_tilt"):
        row["blind_" + key] = longest[key] if longest else None
    return row


class Results:
    """DIR/results.csv: one line a run, looked up by what made it."""

    IDENTITY = ("sequence", "seed", "setting", "parameters_hash", "binary_hash")

    def __init__(self, directory):
        self.path = pathlib.Path(directory) / "results.csv"
        self.lock = threading.Lock()
        self.rows = {}
        if self.path.exists():
            with open(self.path, newline="") as file:
                for row in csv.DictReader(file):
                    if not all(row.get(key) for key in self.IDENTITY):
                        continue  # a line that was cut off
                    self.rows[self.identity(row)] = row

    def identity(self, row):
        return tuple(str(row[key]) for key in self.IDENTITY)

    def get(self, **identity):
        row = self.rows.get(self.identity(identity))
        return row if row and row["status"] == "complete" else None

    def put(self, row):
        with self.lock:
            self.rows[self.identity(row)] = {k: "" if v is None else str(v) for k, v in row.items()}
            columns = list(self.IDENTITY) + ["status"]
            columns += [k for r in self.rows.values() for k in r if k not in columns]
            columns = list(dict.fromkeys(columns))
            part = self.path.with_suffix(".part")
            with open(part, "w", newline="") as file:
                writer = csv.DictWriter(file, columns, restval="")
                writer.writeheader()
                writer.writerows(self.rows.values())
            part.replace(self.path)


class Suite:
    """Runs settings on sequences over seeds; every finished run is kept at once."""

    def __init__(self, programs, sequences, settings, seeds, out, keep=False, bound=False, jobs=1, report=print):
        self.programs, self.sequences, self.settings, self.seeds = programs, sequences, settings, seeds
        self.out, self.keep, self.bound, self.jobs, self.report = pathlib.Path(out), keep, bound, jobs, report
        self.work = ROOT / ".demo" / "bench"
        (self.out / "series").mkdir(parents=True, exist_ok=True)
        self.work.mkdir(parents=True, exist_ok=True)
        self.results = Results(self.out)
        self.binary_hash, self.configurations = programs.hash(), config_hash()
        self.done = 0
        self.stopped = threading.Event()

    def identity(self, name, seed, setting):
        sequence = self.sequences[name]
        judged = {k: v for k, v in sequence.items() if k != "bound"}
        parameters = digest(json.dumps(judged, sort_keys=True), setting[1], self.configurations,
                            self.bound and sequence.get("bound", False))
        return {"sequence": name, "seed": seed, "setting": setting[0], "parameters_hash": parameters,
                "binary_hash": self.binary_hash}

    def series_path(self, identity):
        return self.out / "series" / "{}_{}_{}.csv".format(identity["sequence"], identity["seed"],
                                                           digest(*identity.values()))

    def missing(self, name, seed):
        return [s for s in self.settings if not (self.results.get(**self.identity(name, seed, s)) and
                                                 self.series_path(self.identity(name, seed, s)).exists())]

    def run(self):
        """Everything that is not in results.csv yet; the rows of all that was asked for."""
        tasks = [(name, seed, self.missing(name, seed)) for name in self.sequences for seed in self.seeds]
        tasks = [task for task in tasks if task[2]]
        self.total = sum(len(task[2]) for task in tasks)
        self.started = time.monotonic()
        with concurrent.futures.ThreadPoolExecutor(max_workers=self.jobs) as pool:
            futures = [pool.submit(self.run_bag, *task) for task in tasks]
            try:
                for future in futures:
                    future.result()
            except BaseException:  # interrupted: the bags at work are removed, what is not begun is left
                self.stopped.set()
                raise
        identities = [self.identity(n, seed, s) for n in self.sequences for s in self.settings for seed in self.seeds]
        rows = [(i, self.results.rows.get(self.results.identity(i))) for i in identities]
        return [dict(row, series=str(self.series_path(i))) for i, row in rows if row]

    def progress(self, name, seed, text):
        elapsed = time.monotonic() - self.started
        left = "" if self.done == 0 else ", about {:.0f} min left".format(
            elapsed / self.done * (self.total - self.done) / 60)
        self.report("[{}/{}] {} {}: {}{}".format(self.done, self.total, name, seed, text, left))

    def run_bag(self, name, seed, settings):
        """Makes the bag, runs the settings on it, removes it."""
        if self.stopped.is_set():
            return
        arguments = simulate_arguments(self.sequences[name])
        stem = "{}_{}_{}".format(name, seed, digest(arguments, self.binary_hash, self.configurations)[:8])
        bag = self.work / (stem + ".bag")
        failure = None
        try:
            if not bag.exists():
                if shutil.disk_usage(str(self.work)).free < FREE_DISK * self.jobs:
                    raise BenchError("{}: less than {:.0f} GB free".format(self.work, FREE_DISK * self.jobs / 1e9))
                self.progress(name, seed, "simulating")
                actual = seed + self.sequences[name].get("seed_offset", 0)
                try:
                    self.programs.run("simulate_bag", *arguments, "--seed", actual, "--out", bag)
                except BenchError as error:
                    failure = str(error)
            for setting in settings:
                if not self.stopped.is_set():
                    self.run_setting(name, seed, setting, bag, failure)
        finally:
            if not self.keep:
                for leftover in self.work.glob(stem + "*"):
                    leftover.unlink()

    def run_setting(self, name, seed, setting, bag, failure):
        identity = self.identity(name, seed, setting)
        row = dict(identity, status=failure)
        if failure is None:
            with tempfile.TemporaryDirectory(prefix="run_", dir=str(self.work)) as directory:
                try:
                    row.update(self.measure(name, setting, bag, pathlib.Path(directory), identity), status="complete")
                except (BenchError, KeyError, TypeError, OSError, ValueError) as error:
                    row["status"] = "failed: {}".format(error)
        if self.stopped.is_set():
            return
        self.results.put(row)
        self.done += 1
        told = "{:.4f} m".format(row["ate"]) if row["status"] == "complete" else row["status"]
        self.progress(name, seed, "{}: {}".format(setting[0], told))

    def measure(self, name, setting, bag, directory, identity):
        sequence = self.sequences[name]
        parameters = ["{}={}".format(k, v) for k, v in sequence.get("params", {}).items()] + setting[1]
        self.programs.run("lio_offline", "--bag", bag, "--config", sequence.get("config", "simulated"), "--out",
                          directory, *(word for p in parameters for word in ("--param", p)))
        axis = sequence.get("axis", "path")
        command = ["--reference", bag.with_suffix(".tum"), "--estimate", directory / "trajectory.tum", "--states",
                   directory / "states.csv", "--json", "--series", directory / "series.csv", "--axis",
                   axis if isinstance(axis, str) else ",".join(str(v) for v in axis)]
        biases = bag.parent / (bag.stem + "_truth.csv")
        if biases.exists():
            command += ["--truth-biases", biases]
        if self.bound and sequence.get("bound", False):
            command += ["--bound", sequence.get("imu", "mti600")]
        error = json.loads(self.programs.run("evaluate_trajectory", *command))
        keep_series(directory / "series.csv", self.series_path(identity))
        row = figures(error, yaml.safe_load((directory / "summary.yaml").read_text()))
        if not math.isfinite(row["ate"]):
            raise BenchError("the trajectory is not finite")
        return row


def keep_series(source, target):
    """The columns that averages over seeds need, with fewer digits."""
    with open(source, newline="") as file:
        rows = list(csv.reader(file))
    kept = [i for i, c in enumerate(rows[0]) if c in SERIES_COLUMNS or c.startswith("nees_")]
    with open(target, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([rows[0][i] for i in kept])
        for row in rows[1:]:
            writer.writerow([row[i] if rows[0][i] == "t" else "{:.4g}".format(float(row[i])) for i in kept])


if __name__ == "__main__":
    raise SystemExit("bench_suite.py belongs to scripts/bench, which is what to run")
