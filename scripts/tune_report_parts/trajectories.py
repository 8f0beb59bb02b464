# Copyright 2026 the allan_lio authors
# SPDX-License-Identifier: BSD-3-Clause
"""Trajectories in TUM files, and their position errors against the truth after SE(3) alignment."""
import os
import warnings

import numpy as np

from .tuning_data import BadInput, a_map


def read_tum(path):
    """Stamps [s] and positions [m]."""
    if not os.path.exists(path):
        raise BadInput(f"{path}: is not there")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # an empty file, which is told below
            rows = np.loadtxt(path, ndmin=2)
    except ValueError as error:
        raise BadInput(f"{path}: {error}") from error
    if rows.shape[0] == 0 or rows.shape[1] != 8 or not np.all(np.isfinite(rows)):
        raise BadInput(f"{path}: holds no poses of 8 numbers")
    return rows[:, 0], rows[:, 1:4]


def aligned(stamps, positions, reference):
    """The positions laid over the truth where there is truth (least squares, Umeyama without scale)."""
    inside = (stamps >= reference[0][0]) & (stamps <= reference[0][-1])
    if np.count_nonzero(inside) < 3:
        raise BadInput("a trajectory and its reference have no time in common")
    stamps, positions = stamps[inside], positions[inside]
    truth = np.column_stack([np.interp(stamps, reference[0], axis) for axis in reference[1].T])
    centred = positions - positions.mean(axis=0)
    u, _, vt = np.linalg.svd((truth - truth.mean(axis=0)).T @ centred)
    rotation = u @ np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ vt))]) @ vt
    laid = centred @ rotation.T + truth.mean(axis=0)
    return stamps, laid, np.linalg.norm(laid - truth, axis=1)


def compare(tuning, comparison):
    """The truth's positions or None, and per "before" and "after" stamps, positions and errors (None: no truth)."""
    reference = comparison.get("reference")
    reference = read_tum(tuning.file(reference)) if reference else None
    paths = {}
    for name in ("before", "after"):
        path = a_map(comparison.get(name)).get("trajectory")
        if not path:
            continue
        stamps, positions = read_tum(tuning.file(path))
        paths[name] = aligned(stamps, positions, reference) if reference else (stamps, positions, None)
    return (reference[1] if reference else None), paths
