#!/usr/bin/python3
# Copyright 2026 the allan_lio authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs scripts/plot_states with the arguments given and prints what its figures show instead of writing them: a line
for each file and panel, and below it one for each curve: its label, its number of points and its last value."""
import importlib.machinery
import importlib.util
import os
import sys

SCRIPT = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", "scripts", "plot_states")


def show(figure, _, name):
    for panel in figure.axes:
        print(f"{name}: {panel.get_title(loc='left')} | {panel.get_ylabel()}")
        for line in panel.get_lines():
            print(f"  {line.get_label()}: {len(line.get_ydata())} points, the last {line.get_ydata()[-1]:.6e}")


def main():
    sys.stdout.reconfigure(encoding="utf-8")
    sys.dont_write_bytecode = True
    loader = importlib.machinery.SourceFileLoader("plot_states", os.path.realpath(SCRIPT))
    plot_states = importlib.util.module_from_spec(importlib.util.spec_from_loader("plot_states", loader))
    loader.exec_module(plot_states)
    plot_states.plot_run.save = show
    plot_states.main()


if __name__ == "__main__":
    main()
