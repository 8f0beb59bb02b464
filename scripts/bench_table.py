#!/usr/bin/env python3
# Copyright 2026 the allan_lio authors
# SPDX-License-Identifier: BSD-3-Clause
"""The tables of a suite's results: the paper's (maximum, minimum, average) and one line a setting, as Markdown, CSV and PNG."""
import csv
import json
import math

JUDGED = ("tilt", "velocity", "gyro_bias", "accel_bias", "relative_position", "innovation")
COLOURS = ("#1f5fa8", "#c23b22", "#2e8b57", "#8a5fb0", "#b8860b", "#555555", "#00868b", "#d2691e")


def values(rows, key):
    """The finite figures of completed runs."""
    found = [float(row[key]) for row in rows if row.get("status") == "complete" and row.get(key) not in (None, "")]
    return [v for v in found if math.isfinite(v)]


def mean(numbers):
    return sum(numbers) / len(numbers) if numbers else None


def rms(numbers):
    return math.sqrt(mean([v * v for v in numbers])) if numbers else None


def text(value, decimals):
    return "-" if value is None else "{:.{}f}".format(value, decimals)


def judged_nees(nees):
    """Mean NEES per degree of freedom, with a sign where it leaves its band."""
    if not nees:
        return "-"
    sign = "▲" if nees["mean"] > nees["high"] else "▼" if nees["mean"] < nees["low"] else ""
    return "{:.2f}{}".format(nees["mean"], sign)


class Line:
    """All seeds of one sequence with one setting."""

    def __init__(self, sequence, setting, rows, programs):
        self.sequence, self.setting, self.rows = sequence, setting, rows
        complete = [row for row in rows if row["status"] == "complete"]
        self.failed = len(rows) - len(complete)
        self.ate = values(rows, "ate")
        self.consistency = None
        if complete:
            command = ["--json"] + [w for row in complete for w in ("--over-runs", row["series"])]
            self.consistency = json.loads(programs.run("evaluate_trajectory", *command))

    def figures(self):
        """Flat, for the CSV."""
        row = {"sequence": self.sequence, "setting": self.setting, "runs": len(self.rows), "failed": self.failed,
               "ate_max": max(self.ate, default=None), "ate_min": min(self.ate, default=None),
               "ate_average": mean(self.ate)}
        for key in ("max", "drift_m", "drift_percent", "rpe_10m_percent", "cpu_ms", "map_mb", "blind_seconds",
                    "blind_sigma", "blind_bound", "blind_known_tilt"):
            row[key] = mean(values(self.rows, key))
        row["blind_error_rms"] = rms(values(self.rows, "blind_error"))
        consistency = self.consistency or {"three_sigma_share": None, "nees_per_dof": {}}
        row["three_sigma_share"] = consistency["three_sigma_share"]
        for block, nees in consistency["nees_per_dof"].items():
            for key in ("mean", "low", "high", "inside"):
                row["nees_{}_{}".format(block, key)] = nees[key] if nees else None
        return row


def paper_table(lines):
    """Rows of maximum, minimum and average, one column a setting."""
    settings = list(dict.fromkeys(line.setting for line in lines))
    out = ["| RMSE (ATE, se3) [m] | | " + " | ".join(settings) + " |", "| --- | --- |" + " --- |" * len(settings)]
    for sequence in dict.fromkeys(line.sequence for line in lines):
        by_setting = {line.setting: line for line in lines if line.sequence == sequence}
        for name, figure in (("maximum", max), ("minimum", min), ("average", mean)):
            cells = [text(figure(by_setting[s].ate) if s in by_setting and by_setting[s].ate else None, 4)
                     for s in settings]
            out.append("| {} | {} | {} |".format(sequence if name == "maximum" else "", name, " | ".join(cells)))
    return out


def detail_table(lines, bound):
    heads = ["sequence", "setting", "runs", "ATE average [m]", "end drift [%]", "along 3σ holds [%]"]
    heads += ["NEES {}".format(block.replace("_", " ")) for block in JUDGED] + ["CPU/scan [ms]", "map [MB]"]
    if bound:
        heads += ["blind [s]", "error gained, rms [m]", "filter's σ [m]", "posterior bound [m]",
                  "IMU alone, tilt known [m]"]
    out = ["| " + " | ".join(heads) + " |", "|" + " --- |" * len(heads)]
    for line in lines:
        f = line.figures()
        share = None if f["three_sigma_share"] is None else 100.0 * f["three_sigma_share"]
        nees = line.consistency["nees_per_dof"] if line.consistency else {}
        cells = [line.sequence, line.setting,
                 str(f["runs"]) + (" ({} failed)".format(line.failed) if line.failed else ""),
                 text(f["ate_average"], 4), text(f["drift_percent"], 3), text(share, 1)]
        cells += [judged_nees(nees.get(block)) for block in JUDGED] + [text(f["cpu_ms"], 2), text(f["map_mb"], 1)]
        if bound:
            cells += [text(f["blind_seconds"], 1), text(f["blind_error_rms"], 3), text(f["blind_sigma"], 3),
                      text(f["blind_bound"], 3), text(f["blind_known_tilt"], 3)]
        out.append("| " + " | ".join(cells) + " |")
    return out


LEGEND = ("NEES per degree of freedom, averaged over seeds and time: 1 is honest; ▲ above the 95 % χ² band of that many runs "
          "(too sure), ▼ below it (too cautious). The errors behind it are taken with the first poses coinciding; the RMSE "
          "after the best rotation and translation.")
BOUND_LEGEND = ("Blind: the run's longest stretch without LiDAR support, up to where the filter is least sure. Posterior bound: "
                "1 σ of what an ideal filter gains there along the true path if the scans tell nothing at all of the axis (axis "
                "weakest: of both horizontal positions and the heading), biases and tilt known as its own measurements leave "
                "them; what little the scans tell can bring a filter below it. IMU alone, tilt known: dead reckoning from the "
                "bias and velocity that a steady filter holds at the entry, 1 σ.")


def draw(lines, path):
    """Every run a dot, the average a bar, one panel row a sequence; a logarithmic scale."""
    import matplotlib  # here, so that the tables do without it
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    sequences = list(dict.fromkeys(line.sequence for line in lines))
    settings = list(dict.fromkeys(line.setting for line in lines))
    figure, axes = plt.subplots(figsize=(max(6.0, 1.2 + 0.35 * len(sequences) * (len(settings) + 1)), 4.8),
                                constrained_layout=True, dpi=130)
    for line in lines:
        k = settings.index(line.setting)
        x = sequences.index(line.sequence) + (k - (len(settings) - 1) / 2) * 0.8 / len(settings)
        colour = COLOURS[k % len(COLOURS)]
        if not line.ate:
            axes.annotate("failed", (x, 0.02), xycoords=("data", "axes fraction"), rotation=90, fontsize=7,
                          color=colour, ha="center")
            continue
        axes.plot([x] * len(line.ate), line.ate, "o", color=colour, markersize=3.5, alpha=0.55, markeredgewidth=0)
        half = 0.3 / len(settings)
        axes.plot([x - half, x + half], [mean(line.ate)] * 2, color=colour, linewidth=2.4)
    for k, setting in enumerate(settings):
        axes.plot([], [], color=COLOURS[k % len(COLOURS)], linewidth=2.4, label=setting)
    every = [v for line in lines for v in line.ate if v > 0]
    decades = [10.0 ** math.floor(math.log10(min(every))), 10.0 ** math.ceil(math.log10(1.0001 * max(every)))]
    axes.set(yscale="log", ylim=decades, ylabel="ATE (se3) RMSE [m]", xticks=range(len(sequences)), xlim=(-0.6, len(sequences) - 0.4))
    axes.set_xticklabels(sequences, rotation=20 if len(sequences) > 4 else 0)
    axes.set_title("Every seed a dot, the average a bar", loc="left", fontsize=10)
    axes.grid(True, axis="y", which="both", color="#e8e8e8")
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    axes.legend(frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize=8)
    figure.savefig(str(path))
    plt.close(figure)


def write_tables(rows, programs, out, bound):
    """DIR/table.md, table.csv and table.png; the Markdown is returned."""
    groups = {}
    for row in rows:
        groups.setdefault((row["sequence"], row["setting"]), []).append(row)
    lines = [Line(sequence, setting, group, programs) for (sequence, setting), group in groups.items()]
    failures = sorted({"{}: {}".format(row["sequence"], row["status"]) for row in rows if row["status"] != "complete"})
    markdown = paper_table(lines) + [""] + detail_table(lines, bound) + ["", LEGEND]
    markdown += [BOUND_LEGEND] if bound else []
    markdown += ["", "Not run to the end:"] + ["- " + failure for failure in failures] if failures else []
    document = "\n".join(markdown) + "\n"
    (out / "table.md").write_text(document)
    with open(str(out / "table.csv"), "w", newline="") as file:
        figures = [line.figures() for line in lines]
        columns = list(dict.fromkeys(key for row in figures for key in row))
        writer = csv.DictWriter(file, columns, restval="")
        writer.writeheader()
        writer.writerows({k: "" if v is None else v for k, v in row.items()} for row in figures)
    if any(v > 0 for line in lines for v in line.ate):
        draw(lines, out / "table.png")
    return document


if __name__ == "__main__":
    raise SystemExit("bench_table.py belongs to scripts/bench, which is what to run")
