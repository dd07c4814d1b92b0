#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Simulates the schedule of pcl_semantic_fleet from the log of a run.

    doc/fleet_schedule.py city/log.csv [--drives 1000] [--ranks 8 64 512]

Tasks of the log are repeated for as many drives as are asked for; each goes to the rank
that is free first, submaps before tiles, with a wait for all in between. Beside the
tasks: opening every drive and cutting it, which rank 0 does alone, and the answers of
rank 0, one after the other.
"""
import argparse
import csv
import heapq

ANSWER = 0.002  # s, of the thread that hands out tasks: it looks so often
CUT = 0.02  # s a drive: opening it, reading its poses


def makespan(costs, ranks):
    """When the last of the tasks ends, and how long the ranks worked."""
    free = [0.0] * ranks
    counter = 0.0  # when rank 0 can answer again
    for cost in costs:
        start = max(heapq.heappop(free), counter)
        counter = start + ANSWER / 50.0  # it answers all that have asked
        heapq.heappush(free, start + ANSWER / 2.0 + cost)
    return max(free)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("log")
    parser.add_argument("--drives", type=int, default=1000)
    parser.add_argument("--ranks", type=int, nargs="+", default=[8, 64, 512])
    arguments = parser.parse_args()
    with open(arguments.log, newline="") as file:
        rows = list(csv.DictReader(file))
    submaps = [float(r["seconds"]) for r in rows if "/submaps/" in r["task"]]
    tiles = [float(r["seconds"]) for r in rows if "/submaps/" not in r["task"]]
    drives = len({r["task"].split("/submaps/")[1].split("/")[0]
                  for r in rows if "/submaps/" in r["task"]})
    times = max(1, round(arguments.drives / drives))
    submaps, tiles = submaps * times, tiles * times
    work = sum(submaps) + sum(tiles)
    cut = CUT * drives * times
    print(f"{drives * times} drives: {len(submaps)} submaps of {sum(submaps) / len(submaps):.2f} s, "
          f"{len(tiles)} tiles of {sum(tiles) / len(tiles):.2f} s, {work / 3600.0:.1f} hours of one rank")
    print("ranks  hours  efficiency")
    for ranks in arguments.ranks:
        span = cut + makespan(submaps, ranks) + makespan(tiles, ranks)
        print(f"{ranks:5d}  {span / 3600.0:5.2f}  {(work + cut) / (ranks * span):.3f}")


if __name__ == "__main__":
    main()
