#!/usr/bin/python3
# Copyright 2026 the allan_lio authors
# SPDX-License-Identifier: BSD-3-Clause
"""The endurance run of scripts/bench --soak: lio.launch as it ships, on a closed way that is walked lap after lap."""
import math
import os
import pathlib
import signal
import socket
import subprocess
import time

import yaml

from bench_suite import ROOT, BenchError

WAY = ROOT / "config" / "ways" / "soak.csv"
SIMULATE = ("--scene", "rooms", "--path", WAY, "--imu", "mti600", "--lidar", "velodyne16", "--seed", "1")
MAP_CAP = 1  # [MB]: less than the rooms fill, so that the map forgets all the time
TOLD_EVERY = 3600.0  # [s] of simulated time
START_TAKES = 30.0  # [s]


def lap_period(truth):
    """What play_bag makes of the IMU's stamps, which the truth has too [s]."""
    stamps = [float(line.split()[0]) for line in truth.read_text().splitlines() if not line.startswith("#")]
    return (stamps[-1] - stamps[0]) * len(stamps) / (len(stamps) - 1)


class Nodes:
    """A ROS master of its own and what runs on it; all of it is ended on leaving."""

    def __init__(self, binaries, out):
        with socket.socket() as free:
            free.bind(("", 0))
            self.port = str(free.getsockname()[1])
        self.setup = pathlib.Path(binaries).parent.parent / "setup.bash"
        self.out = out
        self.environment = dict(os.environ, ROS_MASTER_URI="http://localhost:" + self.port, ROS_HOME=str(out / "ros"),
                                ROS_LOG_DIR=str(out / "ros" / "log"), PATH="/usr/bin:/bin:" + os.environ["PATH"])
        self.processes = []

    def __enter__(self):
        return self

    def start(self, name, *command):
        line = "set +u; source '{}'; exec \"$@\"".format(self.setup)
        with open(self.out / (name + ".log"), "w") as log:
            process = subprocess.Popen(["bash", "-c", line, "bench"] + [str(word) for word in command],
                                       env=self.environment, stdout=log, stderr=subprocess.STDOUT)
        self.processes.append(process)
        return process

    def end(self, process):
        """As Ctrl-C does; its exit status."""
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
        return process.wait(60)

    def __exit__(self, *_):
        for process in reversed(self.processes):
            self.end(process)


def wait_for(what, happened):
    until = time.monotonic() + START_TAKES
    while not happened():
        if time.monotonic() > until:
            raise BenchError("{} does not come up".format(what))
        time.sleep(0.05)


def listening(port):
    with socket.socket() as probe:
        return probe.connect_ex(("localhost", int(port))) == 0


def simulated_time(rows):
    """How far the run has come by the last row that is whole [s]."""
    lines = rows.read_text().splitlines() if rows.exists() else []
    return float(lines[-1].split(",")[0]) if len(lines) > 2 and lines[-1].count(",") == lines[0].count(",") else 0.0


def follow(play, rows, hours, report):
    """Until the player ends, with a line every so often."""
    begin, told = time.monotonic(), 0.0
    while play.poll() is None:
        time.sleep(0.5)
        now = simulated_time(rows)
        if now >= told + TOLD_EVERY:
            told += TOLD_EVERY
            elapsed = time.monotonic() - begin
            report("{:.0f} of {:g} h in {:.0f} s, {:.0f} times real time".format(told / 3600, hours, elapsed,
                                                                                 now / elapsed))


def simulate(programs, work):
    """The bag of one lap, and what a lap takes [s]."""
    bag = work / "soak.bag"
    programs.run("simulate_bag", *SIMULATE, "--out", bag)
    return bag, lap_period(bag.with_suffix(".tum"))


def drive(programs, hours, out, work, report):
    """Runs it: soak.csv, topics.csv, run/ and run.yaml in `out` are what bench_soak_judge reads."""
    bag, period = simulate(programs, work)
    laps = math.ceil(hours * 3600.0 / period)
    out.mkdir(parents=True, exist_ok=True)
    for old in ("soak.csv", "topics.csv", "listening"):
        (out / old).unlink(missing_ok=True)
    config = out / "soak.yaml"
    config.write_text("include: [robots/simulated]\nmap: {{max_mb: {}}}\n".format(MAP_CAP))
    report("{} laps of {:.3f} s".format(laps, period))
    begin = time.monotonic()
    with Nodes(programs.directory, out) as nodes:
        nodes.start("roscore", "roscore", "-p", nodes.port)
        wait_for("roscore", lambda: listening(nodes.port))
        if nodes.start("rosparam", "rosparam", "set", "/use_sim_time", "true").wait(START_TAKES) != 0:
            raise BenchError("rosparam failed")
        watch = nodes.start("soak_watch", programs.directory / "soak_watch", "--out", out)
        launch = nodes.start("roslaunch", "roslaunch", "--wait", "allan_lio", "lio.launch", "config:={}".format(config),
                             "out:={}".format(out / "run"))
        wait_for("lio.launch", (out / "listening").exists)
        play = nodes.start("play_bag", programs.directory / "play_bag", bag, "--laps", laps)
        follow(play, out / "soak.csv", hours, report)
        if nodes.end(watch) != 0 or not (out / "topics.csv").exists():
            raise BenchError("soak_watch failed: {}".format((out / "soak_watch.log").read_text().strip()[-300:]))
        nodes.end(launch)
    if play.returncode != 0:
        logs = [(out / name).read_text().strip()[-400:] for name in ("play_bag.log", "roslaunch.log")]
        raise BenchError("the run did not end well: {}".format("\n".join(logs)))
    seconds = time.monotonic() - begin
    (out / "run.yaml").write_text(yaml.safe_dump({"hours": laps * period / 3600.0, "laps": laps, "period": period,
                                                  "wall_seconds": round(seconds, 1), "map_cap_mb": MAP_CAP,
                                                  "truth": str(out / "lap.tum")}))
    (out / "lap.tum").write_bytes(bag.with_suffix(".tum").read_bytes())


if __name__ == "__main__":
    raise SystemExit("bench_soak.py belongs to scripts/bench, which is what to run")
