# Copyright 2026 the allan_lio authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tables of the report."""
import math
from html import escape

from .drawing import short
from .tuning_data import COEFFICIENTS

FIRST, SHOWN = 12, 100  # settings seen at once and in the page; all are in trials.csv


def table(names, rows, texts=1, best=None):
    """The first `texts` columns hold texts, the others figures; row `best` is marked."""
    def line(tag, cells):
        return "".join(f'<{tag}{" class=" + chr(34) + "text" + chr(34) if i < texts else ""}>{escape(cell)}</{tag}>'
                       for i, cell in enumerate(cells))

    body = "\n".join(f'<tr{" class=" + chr(34) + "best" + chr(34) if i == best else ""}>{line("td", row)}</tr>'
                     for i, row in enumerate(rows))
    return (f'<div class="scroll"><table>\n<thead><tr>{line("th", names)}</tr></thead>\n<tbody>\n{body}\n</tbody>\n'
            "</table></div>")


def objective_order(setting):
    return (not math.isfinite(setting.objective), setting.objective, setting.key)


def settings_table(tuning):
    """Maximum, minimum and average RMSE of each setting over bags and runs, as the paper prints them; on linear runs, which
    have none, the objective alone."""
    names = tuning.parameters or list(COEFFICIENTS)
    ordered = sorted(tuning.settings.values(), key=objective_order)
    rows, best = [], None
    for setting in ordered[:SHOWN]:
        if setting.key == tuning.best_key:
            best = len(rows)
        ate = setting.ate
        rmse = (max(ate), min(ate), sum(ate) / len(ate)) if ate else (math.nan,) * 3
        runs = [short(value, 4) for value in rmse] + [f"{setting.diverged} of {setting.runs}" if setting.diverged else "-"]
        rows.append([short(setting.key[COEFFICIENTS.index(name)], 4) for name in names] +
                    ([] if tuning.rounds else runs) + [short(setting.objective, 7)])
    columns = names + ([] if tuning.rounds else ["RMSE max [m]", "min", "average", "diverged"]) + ["objective"]
    note, file = "<p>RMSE of the position over bags and runs; diverged runs are counted, not averaged.", "trials.csv"
    if tuning.rounds:
        note, file = "<p>Judged by the last round's linear filter, without runs of their own.", "tuning.yaml"
    note += " The best setting is marked."
    note += f" The best {SHOWN} of {len(ordered)} settings; all are in {file}." if len(ordered) > SHOWN else ""
    shown = table(columns, rows[:FIRST], texts=0, best=best)
    if len(rows) > FIRST:
        rest = table(columns, rows[FIRST:], texts=0, best=None if best is None else best - FIRST)
        shown += f"\n<details><summary>{len(rows) - FIRST} more settings</summary>\n{rest}</details>"
    return note + "</p>\n" + shown
