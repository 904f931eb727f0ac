#!/usr/bin/env python3
"""The page of `feedwright open --hal` beside a real LinuxCNC: what it gets while a circle is cut.

    live.py --machine MACHINE.fwmodel

Exit code 1 where path, errors or state are not those of the machine, or where a pin was written.
"""
import argparse
import math
import pathlib
import sys

import headless

CIRCLE = "G21 G17 G90 G94 G64 P0.01\nG0 X0 Y0\nG4 P0.3\nG2 X0 Y0 I10 J0 F3000\nG2 X0 Y0 I10 J0 F3000\nG4 P0.2\nM2\n"
RADIUS_MM = 10
# The page reads 25 times a second, and a process waits for its turn.
LEAST_PER_S = 12
CORRECTING = 4


def expect(what, is_so):
    print(f"{what:90} {'yes' if is_so else 'NO'}", flush=True)
    return is_so


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--machine", required=True)
    machine = str(pathlib.Path(parser.parse_args().machine).resolve())
    run = headless.run("live", {"program": CIRCLE, "command": headless.FEEDWRIGHT}, {"FEEDWRIGHT": {"MACHINE": machine, "MODEL": machine}})
    rows, pins = run.result["rows"], run.result["pins"]
    cut = [row for row in rows if row[6] == CORRECTING]
    feedbacks = [row.feedback for row in run.rows]
    apart_mm = max((min(math.dist(row[1:4], feedback) for feedback in feedbacks[::4]) for row in cut), default=math.inf)
    reach_mm = max((math.dist(a[1:3], b[1:3]) for a in cut for b in cut[::7]), default=0)
    largest_um = max((row[4] for row in cut), default=math.inf)
    recorded_um = max(1e3 * row.contour_error for row in run.rows)
    without_um = max((row[5] for row in cut), default=0)
    seconds = rows[-1][0] - rows[0][0] if rows else math.inf
    fine = [
        expect(f"the page gets {len(rows) / seconds:.1f} readings a second", len(rows) > LEAST_PER_S * seconds),
        expect(f"it sees the circle: {reach_mm:.2f} mm across", abs(reach_mm - 2 * RADIUS_MM) < 0.5),
        expect(f"where the axes are, within {1e3 * apart_mm:.0f} um between two samples", apart_mm < 0.2),
        expect(f"with its errors: {largest_um:.2f} um of {recorded_um:.2f} um", 0 < largest_um <= recorded_um * 1.001),
        expect(f"and those without the correction: {without_um:.1f} um", without_um > 5 * largest_um),
        expect("no pin was written", pins[0] == pins[1]),
    ]
    return 0 if all(fine) else 1


if __name__ == "__main__":
    sys.exit(main())
