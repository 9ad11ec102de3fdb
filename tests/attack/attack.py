#!/usr/bin/env python3
"""Attacks the program for a given time and prints what that did to it. Called by scripts/attack."""
import argparse
import pathlib
import shutil
import sys
import time
from random import Random

import disks
import files
import fuzz
import kills
import memory
import packets
import races
from findings import Findings
from stage import Stage

# With their shares of the time.
ATTACKS = ((kills, 0.2), (races, 0.15), (disks, 0.15), (memory, 0.1), (files, 0.1), (packets, 0.05), (fuzz, 0.25))


class Clock:
    def __init__(self, seconds):
        self._end = time.monotonic() + seconds

    def left(self):
        return max(0.0, self._end - time.monotonic())

    def over(self):
        return self.left() == 0


def arguments():
    names = [module.NAME for module, _ in ATTACKS]
    parser = argparse.ArgumentParser(prog="scripts/attack", description=__doc__)
    parser.add_argument("--minutes", type=float, default=10, help="how long, without building (default: 10)")
    parser.add_argument("--seed", type=int, default=1, help="of everything random (default: 1)")
    parser.add_argument("--only", choices=names, action="append", help="this attack alone; may be given several times")
    parser.add_argument("--out", type=pathlib.Path, required=True, help="folder for what is found; it is emptied")
    parser.add_argument("--program", required=True)
    parser.add_argument("--stage-writer", required=True)
    parser.add_argument("--fuzzer", required=True)
    return parser.parse_args()


def main():
    tools = arguments()
    out = tools.out.resolve()
    shutil.rmtree(out, ignore_errors=True)
    findings = Findings(out / "found")
    stage = Stage(tools.program, tools.stage_writer, out / "stage")
    chosen = [(module, share) for module, share in ATTACKS if not tools.only or module.NAME in tools.only]
    whole = sum(share for _, share in chosen)
    for module, share in chosen:
        findings.attempt(module.NAME, 0)
        seconds = tools.minutes * 60 * share / whole
        print(f"attack: {module.NAME} for {seconds:.0f} s", file=sys.stderr, flush=True)
        module.attack(stage, findings, Random(f"{tools.seed} {module.NAME}"), Clock(seconds), tools)
    table = f"Seed {tools.seed}, {tools.minutes:g} minutes\n\n{findings.table()}\n"
    (out / "table.md").write_text(table)
    print(table)
    if findings.kept:
        print(f"What reproduces each finding is kept in {findings.folder}.")
    shutil.rmtree(out / "stage")
    return 1 if findings.kept else 0


if __name__ == "__main__":
    sys.exit(main())
