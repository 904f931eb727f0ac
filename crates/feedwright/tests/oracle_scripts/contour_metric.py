#!/usr/bin/env python3
"""Contour error and uncut path of a trace, from the program and the machine file; needs Python 3.11 and nothing else.

    contour_metric.py MACHINE.toml PROGRAM.ngc TRACE.csv

Prints as JSON the root mean square and the largest of the contour error over the rows that cut, and the uncut path, in um.
Written from the definitions below, not from the program's source, and by search where the program skips.

The program is one of G0 to G3 in millimetres and the XY plane, absolute, with I and J or R; the path is a polyline, arcs in chords
of 1 nm sagitta at most, by arc length. With x the tool of a row, d(s) its distance to the path at s, m its way in the row (at
least 0.1 um), r(t) where the reference is, W = 5 / Kp + delay:

    lo = max(furthest foot - 10 um, r(t - W) - e^-5 rapid / Kp)
    the tool reaches from lo on all s up to the first with d(s) > 1.5 min(d over lo..s) + m, at most r(t + 50 ms);
    its foot is the nearest of these, and the contour error the distance to it.
    Beyond, up to r(t + 50 ms): the first stretch that comes nearer, and what is reached from there, if the tool's way lies
    more along the path there than at the foot, and there no more than 0.99 m.

Uncut: the largest, over the rows whose reference moves on a cutting line, of the distance from the path point of the row to the
polyline of the tool from t - W to t + W. A tool that ends within 10 um of the end of the path has come there.
"""
import bisect
import csv
import json
import math
import pathlib
import re
import sys
import tomllib

from resimulate import machine_of

SETTLED, LEAD_S, HILL_LEAD_S, BACK, HILL, LEAST_WAY = 5.0, 0.05, 0.005, 0.01, 1.5, 1e-4
TIE, ARRIVED, ALONG = 1e-9, 0.01, 0.99
SAGITTA = 1e-6


def motions(text):
    """Ends, centre (none on a line), turn (-1 clockwise), whether it cuts, and the line of each motion."""
    here, mode = (0.0, 0.0), 0
    for number, line in enumerate(text.splitlines(), 1):
        line = re.sub(r"\([^)]*\)|;.*", "", line).upper().replace(" ", "")
        words = [(letter, float(value)) for letter, value in re.findall(r"([A-Z])([-+]?[0-9.]+)", line)]
        for letter, value in words:
            if letter == "G" and value in (0, 1, 2, 3):
                mode = int(value)
            elif letter == "G" and value in (18, 19, 20, 91):
                raise SystemExit(f"line {number}: G{value:g} is not read here")
        of = dict(words)
        if "X" not in of and "Y" not in of and not (mode > 1 and "I" in of):
            continue
        to = (of.get("X", here[0]), of.get("Y", here[1]))
        center = None
        if mode > 1:
            center = (here[0] + of.get("I", 0.0), here[1] + of.get("J", 0.0))
            if "R" in of:
                half, away = math.dist(here, to) / 2, of["R"]
                high = math.copysign(math.sqrt(max(0.0, away * away - half * half)), away) * (1 if mode == 3 else -1)
                along = ((to[0] - here[0]) / (2 * half), (to[1] - here[1]) / (2 * half))
                center = ((here[0] + to[0]) / 2 - high * along[1], (here[1] + to[1]) / 2 + high * along[0])
        yield here, to, center, -1 if mode == 2 else 1, mode > 0, number
        here = to


class Path:
    """A polyline with the arc lengths of its vertices on the exact path."""

    def __init__(self, text):
        self.at, self.s, self.cuts = [], [], {}
        for here, to, center, turn, cuts, number in motions(text):
            self.cuts[number] = cuts
            if not self.at:
                self.at, self.s = [here], [0.0]
            if center is None:
                if math.dist(here, to) > 1e-9:
                    self.add(to, math.dist(here, to))
                continue
            radius = math.dist(here, center)
            start = math.atan2(here[1] - center[1], here[0] - center[0])
            sweep = (math.atan2(to[1] - center[1], to[0] - center[0]) - start) * turn % math.tau or math.tau
            if sweep < 1e-9 and math.dist(here, to) < 1e-9:
                sweep = math.tau
            chords = math.ceil(sweep / (2 * math.sqrt(2 * SAGITTA / radius)))
            for k in range(1, chords + 1):
                angle = start + turn * sweep * k / chords
                point = (center[0] + radius * math.cos(angle), center[1] + radius * math.sin(angle))
                self.add(to if k == chords else point, radius * sweep / chords)

    def add(self, point, length):
        self.at.append(point)
        self.s.append(self.s[-1] + length)

    def segment(self, s):
        return max(0, min(bisect.bisect_right(self.s, s) - 1, len(self.at) - 2))

    def point(self, k, s):
        (ax, ay), (bx, by) = self.at[k], self.at[k + 1]
        part = max(0.0, min(1.0, (s - self.s[k]) / (self.s[k + 1] - self.s[k])))
        return ax + part * (bx - ax), ay + part * (by - ay)

    def tangent(self, s):
        k = self.segment(s)
        (ax, ay), (bx, by) = self.at[k], self.at[k + 1]
        length = math.dist((ax, ay), (bx, by))
        return (bx - ax) / length, (by - ay) / length

    def parts(self, tool, lo, hi):
        """Of each straight part between two arc lengths: where it ends, and its nearest point, as (distance, s)."""
        k = self.segment(lo)
        while True:
            from_s, to_s = max(lo, self.s[k]), min(hi, self.s[k + 1])
            a, b = self.point(k, from_s), self.point(k, to_s)
            share, near = foot(tool, a, b)
            yield (math.dist(tool, b), to_s), (near, from_s + share * (to_s - from_s))
            k += 1
            if to_s >= hi or k > len(self.at) - 2:
                return


def foot(point, a, b):
    dx, dy = b[0] - a[0], b[1] - a[1]
    square = dx * dx + dy * dy
    share = max(0.0, min(1.0, ((point[0] - a[0]) * dx + (point[1] - a[1]) * dy) / square)) if square > 0 else 0.0
    return share, math.dist(point, (a[0] + share * dx, a[1] + share * dy))


def reach(path, tool, way, lo, hi):
    """The foot as (distance, s), and where the path leaves the tool."""
    best = (math.dist(tool, path.point(path.segment(lo), lo)), lo)
    for end, near in path.parts(tool, lo, hi):
        if near[0] < best[0] - TIE:
            best = near
        if end[0] > HILL * best[0] + way:
            # On a straight part the distance grows from its nearest point to its end, so that no foot is lost.
            return best, end[1]
    return best, hi


def contour_errors(path, machine, rows):
    """Of each row, mm."""
    kp, window = settled(machine)
    left = math.exp(-SETTLED) * machine["limits"]["rapid_mm_s"] / kp
    servo = machine["period"]["servo_s"]
    passed = [row["s_mm"] for row in rows]
    lead, hill_lead = round(LEAD_S / servo), round(HILL_LEAD_S / servo)
    furthest, last = 0.0, path.at[0]
    for n, row in enumerate(rows):
        tool = (row["act_x_mm"], row["act_y_mm"])
        way = max(math.dist(tool, last), LEAST_WAY)
        lo = max(0.0, furthest - BACK, (passed[n - window] if n >= window else 0.0) - left)
        hi = max(lo, passed[min(n + lead, len(passed) - 1)])
        hill = max(lo, passed[min(n + hill_lead, len(passed) - 1)])
        best, end = reach(path, tool, way, lo, hi)
        if end < hill:
            for _, near in path.parts(tool, end, hill):
                if near[0] < best[0] - TIE:
                    beyond, _ = reach(path, tool, way, near[1], hill)
                    moved = (tool[0] - last[0], tool[1] - last[1])
                    along = [sum(m * t for m, t in zip(moved, path.tangent(s))) for s in (best[1], beyond[1])]
                    if along[1] > along[0] and along[0] <= ALONG * way:
                        best = beyond
                    break
        furthest, last = max(furthest, best[1]), tool
        yield best[0]


def settled(machine):
    """Kp of the slowest axis, and the servo periods in which a loop has followed."""
    axes = machine["axis"].values()
    kp = min(axis["kp_1_s"] for axis in axes)
    seconds = SETTLED / kp + max(axis.get("command_delay_s", 0) + axis.get("drive_delay_s", 0) for axis in axes)
    return kp, math.ceil(seconds / machine["period"]["servo_s"])


def uncut(path, machine, rows):
    """The largest distance, mm, by its definition."""
    _, window = settled(machine)
    trace = [path.at[0]] + [(row["act_x_mm"], row["act_y_mm"]) for row in rows]
    end = (rows[-1]["path_x_mm"], rows[-1]["path_y_mm"])
    if math.dist(end, trace[-1]) <= ARRIVED:
        trace.append(end)
    largest, last = 0.0, None
    for n, row in enumerate(rows):
        point = (row["path_x_mm"], row["path_y_mm"])
        ends = range(max(n + 1 - window, 1), min(n + window, len(trace) - 1) + 1)
        if point != last and path.cuts.get(int(row["line"])) and row["feed_plan_mm_s"] > 0:
            # Backwards, since a tool that lags comes near late; enough as soon as it is no further than the largest.
            nearest = math.inf
            for k in reversed(ends):
                nearest = min(nearest, foot(point, trace[k - 1], trace[k])[1])
                if nearest <= largest:
                    break
            largest = max(largest, nearest)
        last = point
    return largest


def main(machine_file, program_file, trace_file):
    machine = machine_of(pathlib.Path(machine_file))
    path = Path(pathlib.Path(program_file).read_text(encoding="utf-8"))
    with open(trace_file, newline="", encoding="utf-8") as file:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
    errors = [error for error, row in zip(contour_errors(path, machine, rows), rows) if row["cutting"]]
    print(json.dumps({
        "rms_um": math.sqrt(sum(error * error for error in errors) / len(errors)) * 1e3,
        "max_um": max(errors) * 1e3,
        "uncut_um": uncut(path, machine, rows) * 1e3,
    }))


if __name__ == "__main__":
    main(*sys.argv[1:4])
