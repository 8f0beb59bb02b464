# Copyright 2026 the allan_lio authors
# SPDX-License-Identifier: BSD-3-Clause
"""The report's pictures, as SVG that is the same for the same data."""
import base64
import io
import math

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (the backend must be chosen first)
import numpy as np  # noqa: E402
from matplotlib.colors import LogNorm  # noqa: E402

BLUE, BLACK, ORANGE, BAND, GREY = "#1f5fa8", "#222222", "#c8641e", "#d4e3f3", "#8a8a8a"
SERIES = [m * 10.0**e for e in range(-4, 7) for m in (1, 2, 5)]  # where a log axis is marked
STYLE = {"before": {"color": ORANGE, "linewidth": 1.2}, "after": {"color": BLUE, "linewidth": 1.6}}

plt.rcParams.update({
    "font.size": 10, "axes.grid": True, "grid.color": "#e4e4e4", "axes.axisbelow": True, "axes.spines.top": False,
    "axes.spines.right": False, "legend.frameon": False, "axes.formatter.useoffset": False, "svg.hashsalt": "allan_lio",
})


def picture(figure):
    """The figure as the address of an image."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None})
    plt.close(figure)
    return "data:image/svg+xml;base64," + base64.b64encode(buffer.getvalue()).decode()


def short(value, digits=3):
    return f"{value:.{digits}g}" if math.isfinite(value) else "-"


def heat_map(grid, names, best, shown, title):
    """`shown` gives a setting's figure, NaN for a diverged one."""
    xs, ys, plane = grid
    values = np.array([[shown(plane[x, y]) if (x, y) in plane else math.nan for x in xs] for y in ys])
    figure, axes = plt.subplots(figsize=(6.6, 5.2), constrained_layout=True)
    finite = values[np.isfinite(values)]
    norm = LogNorm() if finite.size and finite.min() > 0 and finite.max() > 10 * finite.min() else None
    mesh = axes.pcolormesh(cell_edges(xs), cell_edges(ys), np.ma.masked_invalid(values), cmap="viridis_r", norm=norm,
                           rasterized=False)
    for x, y in [key for key in plane if not math.isfinite(shown(plane[key]))]:
        i, j = xs.index(x), ys.index(y)
        left, right = cell_edges(xs)[i:i + 2]
        low, high = cell_edges(ys)[j:j + 2]
        axes.fill_between([left, right], low, high, facecolor="#f2f2f2", edgecolor=GREY, hatch="///", linewidth=0)
    axes.set(xscale="log", yscale="log", xlabel=f"{names[0]} [1]", ylabel=f"{names[1]} [1]")
    axes.grid(False)
    for axis, ticks in ((axes.xaxis, xs), (axes.yaxis, ys)):
        axis.set_ticks(ticks)
        axis.set_ticklabels([short(t) for t in ticks])
        axis.set_minor_locator(matplotlib.ticker.NullLocator())
    axes.plot(*best, marker="*", markersize=17, color="white", markeredgecolor=BLACK, markeredgewidth=1.2)
    bar = figure.colorbar(mesh, ax=axes, label=title)
    if norm is not None:
        bar.set_ticks([t for t in SERIES if finite.min() <= t <= finite.max()])
        bar.ax.yaxis.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda value, _: short(value)))
        bar.ax.yaxis.set_minor_locator(matplotlib.ticker.NullLocator())
    return picture(figure)


def cell_edges(values):
    """Borders halfway between the values on the log axis."""
    logs = np.log(values)
    middle = 0.5 * (logs[1:] + logs[:-1])
    return np.exp(np.concatenate([[logs[0] - (middle[0] - logs[0])], middle, [logs[-1] + (logs[-1] - middle[-1])]]))


def mark_log_axis(axes):
    """The x axis's marks as plain numbers, at most ten of them."""
    low, high = axes.get_xlim()
    ticks = [t for t in SERIES if low <= t <= high]
    axes.set_xticks(ticks if len(ticks) <= 10 else [t for t in ticks if f"{t:e}".startswith("1.")])
    axes.set_xticklabels([short(t) for t in axes.get_xticks()])
    axes.xaxis.set_minor_locator(matplotlib.ticker.NullLocator())


def profile(name, points, interval, best, objective):
    """`interval`: two ends, NaN where it is open, or None."""
    k, values = np.array(points).reshape(-1, 2).T
    figure, axes = plt.subplots(figsize=(5.2, 3.3), constrained_layout=True)
    if interval is not None:
        closed = all(math.isfinite(end) for end in interval)
        low, high = (end if math.isfinite(end) else edge for end, edge in zip(interval, (k[0], k[-1])))
        axes.axvspan(low, high, color=BAND, linewidth=0, label="95 % interval" + ("" if closed else ", open"))
    by_ate = objective == "ate"
    base = 0.0 if by_ate else values.min()
    axes.plot(k, values - base, color=BLUE, marker="o", markersize=3.5, label="profile")
    axes.axvline(best, color=BLACK, linewidth=1, linestyle="--", label=f"best {short(best)}")
    label = "ATE [m]" if by_ate else "objective above its least [nats]"
    axes.set(xscale="log", xlabel=f"{name} [1]", ylabel=label)
    if not by_ate:
        # What lies a hundred times above the interval's level tells nothing and flattens what does.
        axes.set_ylim(-0.2, min(max(4.0, 1.05 * (values.max() - base)), 40.0))
        axes.axhline(1.92, color=GREY, linewidth=0.9, linestyle=":", label="1.92 (95 %)")
    else:
        axes.set_ylim(0, None)
    mark_log_axis(axes)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, 1.2), ncol=2, fontsize=8.5)
    return picture(figure)


def paths(reference, compared):
    """Top view, and the error over time if there is truth."""
    with_error = reference is not None
    figure, panels = plt.subplots(1 + with_error, 1, figsize=(7.2, 5.8 if with_error else 3.6), constrained_layout=True,
                                  squeeze=False)
    top = panels[0, 0]
    start = min(stamps[0] for stamps, _, _ in compared.values())
    for name, (stamps, positions, errors) in compared.items():
        top.plot(*positions[:, :2].T, label=name, **STYLE[name])
        if errors is not None:
            panels[1, 0].plot(stamps - start, errors, label=f"{name}, rms {short(rms(errors))} m", **STYLE[name])
    if with_error:
        top.plot(*reference[:, :2].T, color=BLACK, linestyle="--", linewidth=0.9, label="truth")
        panels[1, 0].set(xlabel="time [s]", ylabel="position error [m]", ylim=(0, None))
        panels[1, 0].legend(loc="best")
    top.set(xlabel="x [m]", ylabel="y [m]")
    top.set_aspect("equal", adjustable="datalim")
    top.legend(loc="best")
    return picture(figure)


def rms(errors):
    return math.sqrt(float(np.mean(np.square(errors))))


def consistency(rows):
    """`rows`: label, NIS per degree of freedom before and after (NaN: not known)."""
    figure, axes = plt.subplots(figsize=(6.6, 1.3 + 0.42 * len(rows)), constrained_layout=True)
    for y, (_, before, after) in enumerate(rows):
        axes.plot([before, after], [y, y], color=GREY, linewidth=1, zorder=1)
    for values, name, marker in (([r[1] for r in rows], "before", "o"), ([r[2] for r in rows], "after", "D")):
        axes.scatter(values, range(len(rows)), color=STYLE[name]["color"], marker=marker, s=46, label=name, zorder=2)
    axes.axvline(1.0, color=BLACK, linewidth=1, linestyle="--", label="honest: 1")
    axes.set(xscale="log", xlabel="NIS per degree of freedom [1]", yticks=range(len(rows)),
             yticklabels=[r[0].replace("$", r"\$") for r in rows], ylim=(len(rows) - 0.5, -0.5))
    known = [v for r in rows for v in r[1:] if math.isfinite(v) and v > 0]
    axes.set_xlim(min([0.5] + [0.8 * v for v in known]), max([2.0] + [1.25 * v for v in known]))
    mark_log_axis(axes)
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=3)
    return picture(figure)
