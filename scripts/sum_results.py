#!/usr/bin/env python3
# Copyright 2026 the allan_lio authors
# SPDX-License-Identifier: BSD-3-Clause
"""Adds up the JUnit files below a folder, names every failure and skip, closes with "N passed, N failed"."""
import argparse
import pathlib
import sys
import xml.etree.ElementTree as ElementTree


def excerpt(text):
    """The first lines of a message, each cut to a line's length."""
    lines = [line[:200] for line in text.strip().splitlines()]
    return lines[:20] + (["..."] if len(lines) > 20 else [])


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--crashed", type=int, default=0, help="test programs that ended without a result file")
    arguments = parser.parse_args()

    passed, failed, skipped = 0, arguments.crashed, 0
    for path in sorted(arguments.folder.rglob("*.xml")):
        for case in ElementTree.parse(path).getroot().iter("testcase"):
            name = "{}.{}".format(case.get("classname"), case.get("name"))
            problems = case.findall("failure") + case.findall("error")
            if problems:
                failed += 1
                print("FAILED {}".format(name))
                for problem in problems:
                    for line in excerpt(problem.get("message") or problem.text or ""):
                        print("    " + line)
            elif case.find("skipped") is not None or case.get("result") == "skipped":
                skipped += 1
                reason = case.find("skipped")
                print("skipped {}: {}".format(name, (reason.get("message") if reason is not None else "") or ""))
            else:
                passed += 1
    tail = ", {} skipped".format(skipped) if skipped else ""
    print("{} passed, {} failed{}".format(passed, failed, tail))
    return 1 if failed or not passed else 0


if __name__ == "__main__":
    sys.exit(main())
