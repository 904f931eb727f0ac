#!/usr/bin/env python3
"""Writes the test parts that are curves or many blocks: `lab/make_parts.py parts`.

A curve becomes pairs of arcs that meet the curve and its tangent at their ends, and each other smoothly. Between points p0, p1
with unit tangents t0, t1 the joint of the pair with equal tangent lengths d lies midway between p0 + d t0 and p1 - d t1, where
|p1 - p0 - d (t0 + t1)| = 2 d. Source: Bolton, "Biarc curves", Computer-Aided Design 7(2), 1975, doi:10.1016/0010-4485(75)90086-X.

The pocket has rounded corners, as a CAM system would cut it: helix entries, contour-parallel passes at several depths, a raster
over the floor and a finishing pass along the wall. crates/plan/tests/oracle_parts.rs holds the files to the closed forms, and
shares no code with this program.
"""

import math
import pathlib
import sys

# Largest distance of an arc from the curve, mm: the files promise 0.5 um. A tenth of it remains for rounding and sampling.
TOLERANCE_MM = 0.45e-3
# Points on each pair of arcs where the distance is taken. The error has a few humps only.
SAMPLES = 64


def word(letter, value_mm):
    """A coordinate as G-code writes it: at most six decimals (1 nm), no trailing zeros, no negative zero."""
    trimmed = f"{value_mm:.6f}".rstrip("0").rstrip(".")
    return letter + ("0" if trimmed == "-0" else trimmed)


def sub(a, b):
    return a[0] - b[0], a[1] - b[1]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1]


def unit(a):
    return a[0] / math.hypot(*a), a[1] / math.hypot(*a)


def arc(start, tangent, end):
    """The arc that leaves `start` along `tangent`: end, center (none for a line), and whether it turns clockwise."""
    v, normal = sub(end, start), (-tangent[1], tangent[0])
    twice_height = 2 * dot(v, normal)
    if abs(twice_height) / 8 < 1e-6:  # A sagitta below the printed nanometer.
        return end, None, False
    radius = dot(v, v) / twice_height
    return end, (start[0] + radius * normal[0], start[1] + radius * normal[1]), radius < 0


def pair(point, derivative, begin, end):
    (p0, p1), (t0, t1) = (point(begin), point(end)), (unit(derivative(begin)), unit(derivative(end)))
    v, t = sub(p1, p0), (t0[0] + t1[0], t0[1] + t1[1])
    a, b, c = dot(t, t) - 4, -2 * dot(v, t), dot(v, v)  # |v - d t|^2 = 4 d^2, the positive root.
    d = -c / b if abs(a) < 1e-12 else (-b - math.sqrt(b * b - 4 * a * c)) / (2 * a)
    joint = tuple(0.5 * (p0[k] + d * t0[k] + p1[k] - d * t1[k]) for k in (0, 1))
    _, center, clockwise = arc(p1, (-t1[0], -t1[1]), joint)
    return arc(p0, t0, joint), (p1, center, not clockwise)


def distance(p, start, move):
    end, center, _ = move
    if center is None:
        along, v = unit(sub(end, start)), sub(p, start)
        return abs(along[0] * v[1] - along[1] * v[0])
    return abs(math.hypot(*sub(p, center)) - math.hypot(*sub(end, center)))


def error(point, derivative, begin, end):
    """Largest distance of the curve from its pair of arcs, from points of the curve."""
    start = point(begin)
    first, second = pair(point, derivative, begin, end)
    along = sub(second[0], start)
    joint = dot(sub(first[0], start), along)  # The curve changes from the first arc to the second where it passes the joint.
    points = (point(begin + (end - begin) * i / SAMPLES) for i in range(1, SAMPLES))
    near = (
        distance(p, start, first) if dot(sub(p, start), along) < joint else distance(p, first[0], second) for p in points
    )
    return max(near)


def approximate(point, derivative, begin, end):
    """The curve in as few pairs of arcs as a greedy choice needs."""
    at = begin
    while at < end:
        step = end - at
        if error(point, derivative, at, end) > TOLERANCE_MM:
            good, bad = 0.0, step
            while bad - good > 1e-3 * bad:
                middle = 0.5 * (good + bad)
                if error(point, derivative, at, at + middle) <= TOLERANCE_MM:
                    good = middle
                else:
                    bad = middle
            step = good
        following = end if at + step >= end else at + step
        yield from pair(point, derivative, at, following)
        at = following


def curve(title, point, derivative, sections):
    """A closed curve over 0..2 pi, in equal parts of the parameter so that its symmetry shows in the arcs."""
    ends = [2 * math.pi * i / sections for i in range(sections + 1)]
    moves = [move for begin, end in zip(ends, ends[1:]) for move in approximate(point, derivative, begin, end)]
    at = point(0.0)
    lines = [
        f"({title}, a from 0 to 360 degrees, mm)",
        f"({len(moves)} arcs, tangent to each other, within 0.5 um of the curve; 50 mm/s)",
        "G21 G17 G90 G94 G64",
        f"G0 {word('X', at[0])} {word('Y', at[1])}",
        "F3000",
    ]
    for end, center, clockwise in moves:
        line = f"{word('X', end[0])} {word('Y', end[1])}"
        if center is None:
            lines.append(f"G1 {line}")
        else:  # The center is counted from the start as it was printed.
            i, j = (round(center[k], 6) - round(at[k], 6) for k in (0, 1))
            lines.append(f"{'G2' if clockwise else 'G3'} {line} {word('I', i)} {word('J', j)}")
        at = end
    return "\n".join([*lines, "M2", ""])


def star(a):
    r = 12 + 4 * math.cos(5 * a)
    return r * math.cos(a), r * math.sin(a)


def star_derivative(a):
    r, dr = 12 + 4 * math.cos(5 * a), -20 * math.sin(5 * a)
    return dr * math.cos(a) - r * math.sin(a), dr * math.sin(a) + r * math.cos(a)


HALF_MM, CORNER_MM, DEPTH_MM = (40.0, 25.0), 8.0, 6.0
# Depth of a roughing level: 1.5 mm in aluminum is a plain cut for a 10 mm end mill.
LEVEL_MM, CUTTER_RADIUS_MM = 1.5, 5.0
# Distance of neighboring passes: 40 % of the cutter's diameter.
STEPOVER_MM = 4.0
# What roughing leaves for finishing.
WALL_STOCK_MM, FLOOR_STOCK_MM = 0.3, 0.2
# Helix of the entries: radius, and descent per turn (2.3 degrees).
HELIX_MM = (2.0, 0.5)
# Heights above the part for rapids across it, and for the start of an entry.
CLEAR_MM, NEAR_MM = 5.0, 0.5
# Feeds, mm/min.
ROUGH, ENTRY, FINISH = 1800, 600, 1200


class Pocket:
    def __init__(self):
        self.lines, self.number = [], 10

    def comment(self, text):
        self.lines.append(f"({text})")

    def block(self, code, **words):
        texts = [word(letter, value) if isinstance(value, float) else f"{letter}{value}" for letter, value in words.items()]
        self.lines.append(" ".join([f"N{self.number}", code, *texts]))
        self.number += 5

    def rough(self):
        """Levels from the top down; on each, passes from the inside out."""
        deepest_mm, wall = DEPTH_MM - FLOOR_STOCK_MM, CUTTER_RADIUS_MM + WALL_STOCK_MM
        levels = math.ceil(deepest_mm / LEVEL_MM)
        passes = math.ceil((HALF_MM[1] - wall - HELIX_MM[0]) / STEPOVER_MM)
        for level in range(1, levels + 1):
            z = max(-LEVEL_MM * level, -deepest_mm)
            self.comment(f"roughing level {level} of {levels}, {word('Z', z)}")
            self.entry(-LEVEL_MM * (level - 1) + NEAR_MM, z)
            for number in range(passes, -1, -1):
                half = [half - wall - STEPOVER_MM * number for half in HALF_MM]
                if half[1] >= HELIX_MM[0]:  # The innermost pass is not thinner than its corners.
                    self.contour(half, min(CORNER_MM - wall, half[1]), ROUGH)
            self.block("G0", Z=CLEAR_MM)

    def entry(self, from_z, z):
        """Helix down to `z` about the origin, and one flat turn."""
        radius, descent = HELIX_MM
        self.block("G0", X=radius, Y=0)
        self.block("G0", Z=from_z)
        turns = math.ceil((from_z - z) / descent)
        for turn in range(1, turns + 1):
            self.block("G3", X=radius, Y=0, Z=from_z + (z - from_z) * turn / turns, I=-radius, J=0, F=ENTRY)
        self.block("G3", X=radius, Y=0, I=-radius, J=0, F=ROUGH)

    def contour(self, half, corner, feed):
        """A closed rectangle with rounded corners, counterclockwise (climb milling) from the middle of its lower side."""
        (x, y), (sx, sy) = half, (half[0] - corner, half[1] - corner)
        if feed != FINISH:  # The lead-in of the finishing pass ends here.
            self.block("G1", X=0, Y=-y, F=feed)
        else:
            self.number += 5
        # Of each corner: where its arc starts, where it ends, its center from the start.
        for start, end, center in [
            ((sx, -y), (x, -sy), (0.0, corner)),
            ((x, sy), (sx, y), (-corner, 0.0)),
            ((-sx, y), (-x, sy), (0.0, -corner)),
            ((-x, -sy), (-sx, -y), (corner, 0.0)),
        ]:
            self.block("G1", X=start[0], Y=start[1])
            self.block("G3", X=end[0], Y=end[1], I=center[0], J=center[1])
        self.block("G1", X=0, Y=-y)

    def floor(self):
        """Rows along X with half-circle turns, entered by a ramp along the first row."""
        self.comment("floor raster")
        wall = CUTTER_RADIUS_MM + WALL_STOCK_MM
        height = 2 * (HALF_MM[1] - wall)
        rows = math.ceil(height / STEPOVER_MM)
        step = height / rows
        reach = HALF_MM[0] - wall - step / 2  # The turns stay within the stock of the wall.
        self.block("G0", X=-reach, Y=-height / 2)
        self.block("G0", Z=NEAR_MM - DEPTH_MM + FLOOR_STOCK_MM)
        self.block("G1", X=reach, Z=-DEPTH_MM, F=ENTRY)
        self.block("G1", X=-reach, F=ROUGH)
        side = -1.0
        for row in range(1, rows + 1):
            self.block("G2" if side < 0 else "G3", X=side * reach, Y=-height / 2 + row * step, I=0, J=step / 2)
            side = -side
            self.block("G1", X=side * reach)
        self.block("G0", Z=CLEAR_MM)

    def wall(self):
        """Along the finished wall at full depth, on and off by quarter turns."""
        self.comment("wall finish")
        half, lead = [half - CUTTER_RADIUS_MM for half in HALF_MM], 4.0
        self.block("G0", X=-lead, Y=lead - half[1])
        self.block("G0", Z=NEAR_MM - DEPTH_MM)
        self.block("G1", Z=-DEPTH_MM, F=ENTRY)
        self.block("G3", X=0, Y=-half[1], I=lead, J=0, F=FINISH)
        self.contour(half, CORNER_MM - CUTTER_RADIUS_MM, FINISH)
        self.block("G3", X=lead, Y=lead - half[1], I=0, J=lead)
        self.block("G0", Z=CLEAR_MM)

    def program(self):
        self.comment("Pocket 80 x 50 x 6 mm with corners of R = 8 mm, aluminium; origin: centre of the pocket, top of the part")
        self.comment("T1: end mill of 10 mm, 3 flutes, 8000 rev/min")
        self.comment(
            "4 roughing levels of 1.5 mm with helix entries, floor raster, wall finish; 0.3 mm stock on the wall, 0.2 mm on the floor"
        )
        for code in ["G21 G17 G90 G94 G64 P0.01", "T1 M6", "S8000 M3", "M8", "G4 P1.5"]:
            self.block(code)
        self.block("G0", Z=CLEAR_MM)
        self.rough()
        self.floor()
        self.wall()
        for code in ["M9", "M5", "G0 Z50", "M30"]:
            self.block(code)
        return "\n".join([*self.lines, ""])


def main(folder):
    cos, sin = math.cos, math.sin
    parts = {
        "ellipse.ngc": curve(
            "Ellipse: x = 20 cos a, y = 10 sin a",
            lambda a: (20 * cos(a), 10 * sin(a)),
            lambda a: (-20 * sin(a), 10 * cos(a)),
            4,
        ),
        "eight.ngc": curve(
            "Figure eight: x = 15 sin a, y = 10 sin 2a",
            lambda a: (15 * sin(a), 10 * sin(2 * a)),
            lambda a: (15 * cos(a), 20 * cos(2 * a)),
            4,
        ),
        "star.ngc": curve("Rounded five-pointed star: 12 + 4 cos 5a times cos a, sin a", star, star_derivative, 10),
        "pocket.ngc": Pocket().program(),
    }
    for name, text in parts.items():
        (pathlib.Path(folder) / name).write_text(text)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: make_parts.py FOLDER")
    main(sys.argv[1])
