# Copyright 2026 the allan_lio authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads what tune_noise leaves in its output directory.

tuning.yaml (SETTING is a map of k_g, k_a, k_gb, k_ab, k_r; one that is absent is 1; paths are relative to DIR):

    problem:                      # required
      bags: [{name: TEXT, hash: TEXT}, ...]      # tuned on
      hold_out: [{name: TEXT, hash: TEXT}, ...]  # scored only; numbered on from the bags
      config: PATH
      parameters: [k_gb, k_ab]    # tuned
      search: grid | sequential | likelihood | bayes
      objective: ate | nll | scan_nll
      runs: N                     # per setting and bag
      seed: N
      start: SETTING
      command: TEXT               # that repeats it
      versions: {NAME: TEXT, ...}
      hashes: {NAME: TEXT, ...}
    best: {setting: SETTING, objective: X, end: TEXT}          # required
    evaluations: [{setting: SETTING, objective: X}, ...]       # in the order of the search
    rounds:                       # likelihood on linear runs: runs of the filter and what was found on them; else []
      - {at: SETTING, found: SETTING, lidar_errors: {white: X, view: X, drift_rotation: X, drift_position: X},
         objective: X, runs: N, diverged: N}                    # objective: of the runs themselves
    profiles:
      - parameter: k_gb
        points: [[K, OBJECTIVE], ...]
        interval: [LOW, HIGH]     # of the level set; null where it is open; absent for ate
        curvature_interval: [LOW, HIGH]
        scan_interval: [LOW, HIGH]  # by the innovations from scan to scan; only of linear runs
        verdict: TEXT
    before_after:
      before: SETTING             # k = 1, or where the search began
      bags:
        - bag: NUMBER
          reference: F.tum        # absent without ground truth
          before: {trajectory: F.tum, ate: X, nll: X, nis: X, dof: N,    # each may be absent
                   horizon_nll: X, horizon_nis: X, horizon_dof: X}
          after: {...}            # the same with the best setting

trials.csv, a line per run of the filter: bag,run,k_g,k_a,k_gb,k_ab,k_r,ate,end_error,nll,nis,nis_dof,
horizon_nll,horizon_nis,horizon_dof,horizon_share,scans,diverged
"""
import csv
import math
import os

import yaml

COEFFICIENTS = ("k_g", "k_a", "k_gb", "k_ab", "k_r")
TRIAL_COLUMNS = ("bag", "run", *COEFFICIENTS, "ate", "diverged")


class BadInput(Exception):
    """A file that cannot be used; the text names it."""


def number(value):
    """A float; NaN for what is none (absent, null, empty)."""
    try:
        return float(value)
    except (TypeError, ValueError):
        return math.nan


def a_map(value):
    return value if isinstance(value, dict) else {}


def setting_key(setting):
    return tuple(1.0 if setting.get(name) is None else number(setting[name]) for name in COEFFICIENTS)


class Setting:
    """A tried setting with the runs that it was tried by."""

    def __init__(self, key, objective):
        self.key, self.objective = key, objective
        self.ate, self.runs, self.diverged = [], 0, 0

    def add(self, ate, diverged):
        self.runs += 1
        self.diverged += diverged
        if math.isfinite(ate) and not diverged:
            self.ate.append(ate)


class Tuning:
    def __init__(self, directory):
        self.directory = directory
        self.path = os.path.join(directory, "tuning.yaml")
        document = self.read_document()
        self.problem, self.best = self.part(document, "problem"), self.part(document, "best")
        self.best_key = setting_key(self.part(self.best, "setting"))
        if not all(value > 0 and math.isfinite(value) for value in self.best_key):
            raise BadInput(f"{self.path}: the best setting holds a coefficient that is no positive number")
        self.parameters = [name for name in self.entries(self.problem, "parameters", str) if name in COEFFICIENTS]
        self.bags = self.entries(self.problem, "bags") + self.entries(self.problem, "hold_out")
        self.tuned_bags = len(self.entries(self.problem, "bags"))
        self.rounds = self.entries(document, "rounds")
        self.profiles = self.entries(document, "profiles")
        before_after = a_map(document.get("before_after"))
        self.before_key = setting_key(a_map(before_after.get("before")))
        self.comparisons = self.entries(before_after, "bags")
        self.settings = self.read_settings(document)
        self.read_trials()

    def read_document(self):
        with open(self.path, encoding="utf-8") as file:
            try:
                document = yaml.load(file, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))
            except yaml.YAMLError as error:
                raise BadInput(f"{self.path}: {error}") from error
        if not isinstance(document, dict):
            raise BadInput(f"{self.path}: holds no map")
        return document

    def part(self, parent, name):
        if not isinstance(parent.get(name), dict):
            raise BadInput(f"{self.path}: has no map '{name}'")
        return parent[name]

    def entries(self, parent, name, kind=dict):
        found = parent.get(name) or []
        if not isinstance(found, list) or not all(isinstance(entry, kind) for entry in found):
            raise BadInput(f"{self.path}: '{name}' is no list of {kind.__name__}s")
        return found

    def read_settings(self, document):
        """By their coefficients; of a setting evaluated twice the last objective."""
        settings = {}
        for entry in self.entries(document, "evaluations"):
            key = setting_key(self.part(entry, "setting"))
            settings[key] = Setting(key, number(entry.get("objective")))
        return settings

    def read_trials(self):
        path = os.path.join(self.directory, "trials.csv")
        if not os.path.exists(path):
            return
        with open(path, encoding="utf-8", newline="") as file:
            rows = csv.DictReader(file)
            missing = [name for name in TRIAL_COLUMNS if name not in (rows.fieldnames or [])]
            if missing:
                raise BadInput(f"{path}: has no column {missing[0]}")
            for row in rows:
                if None in row.values() or None in row:
                    raise BadInput(f"{path}:{rows.line_num}: has another number of cells than the columns")
                if number(row["bag"]) < self.tuned_bags:  # the others are no part of the objective
                    self.add_trial(row)

    def add_trial(self, row):
        key = setting_key(row)
        self.settings.setdefault(key, Setting(key, math.nan))
        self.settings[key].add(number(row["ate"]), row["diverged"] == "1")

    def bag_name(self, index):
        known = isinstance(index, int) and 0 <= index < len(self.bags)
        return str(self.bags[index].get("name", index)) if known else f"bag {index}"

    def held_out(self, comparison):
        return number(comparison.get("bag")) >= self.tuned_bags

    def file(self, path):
        return os.path.join(self.directory, str(path))

    def grid(self, first, second):
        """The two coefficients' values and a table of settings, if the trials form such a grid, else None."""
        i, j = COEFFICIENTS.index(first), COEFFICIENTS.index(second)
        others = [n for n in range(len(COEFFICIENTS)) if n not in (i, j)]
        plane = {(k[i], k[j]): s for k, s in self.settings.items() if
                 all(k[n] == self.best_key[n] for n in others) and k[i] > 0 and k[j] > 0}
        # Profiles and a search's path leave values that few settings have: without them a grid shows.
        while plane:
            xs, ys = sorted({k[0] for k in plane}), sorted({k[1] for k in plane})
            if len(plane) >= 0.8 * len(xs) * len(ys):
                break
            shares = [(sum(k[axis] == v for k in plane) / len(values), axis, v)
                      for axis, values, v in [(0, ys, v) for v in xs] + [(1, xs, v) for v in ys]]
            _, axis, value = min(shares)
            plane = {k: s for k, s in plane.items() if k[axis] != value}
        if not plane or len(xs) < 2 or len(ys) < 2:
            return None
        return xs, ys, plane
