"""Exact paths of programs, and how far a point is from them.

A path is a list of pieces, each a line or an arc with a rise (a helix) in one of the three planes. It is what `feedwright canon` reads, rapids
and all; splines are chords of a thousandth of their length.
"""
import dataclasses
import json
import math
import subprocess
import tempfile

import headless

# Axes of a plane, and that across it.
PLANES = {"xy": (0, 1, 2), "zx": (2, 0, 1), "yz": (1, 2, 0)}
CHORDS = 1000
# Pieces to either side that are always looked at.
NEIGHBOURS = 2


@dataclasses.dataclass
class Line:
    start: tuple
    end: tuple
    cuts: bool = True

    def nearest(self, p):
        d = [e - s for s, e in zip(self.start, self.end)]
        square = sum(x * x for x in d)
        t = 0.0 if square == 0 else sum((q - s) * x for q, s, x in zip(p, self.start, d)) / square
        t = min(max(t, 0.0), 1.0)
        return math.dist(p, [s + t * x for s, x in zip(self.start, d)])

    def length(self):
        return math.dist(self.start, self.end)


@dataclasses.dataclass
class Arc:
    """The centre is in the plane, and radii at both ends may differ by what rounding left."""
    center: tuple
    radii: tuple
    begin: float
    sweep: float
    rise: tuple
    plane: str = "xy"
    cuts: bool = True

    def in_plane(self, t):
        angle, radius = self.begin + t * self.sweep, self.radii[0] + t * (self.radii[1] - self.radii[0])
        x, y = self.center
        return (x + radius * math.cos(angle), y + radius * math.sin(angle), self.rise[0] + t * (self.rise[1] - self.rise[0]))

    def at(self, t):
        point, axes = self.in_plane(t), PLANES[self.plane]
        return tuple(point[axes.index(axis)] for axis in range(3))

    def nearest(self, point):
        """By Newton's method from the angle in the plane; a helix rises slowly."""
        p = [point[axis] for axis in PLANES[self.plane]]
        turn = math.atan2(p[1] - self.center[1], p[0] - self.center[0]) - self.begin
        turn = turn % (2 * math.pi) if self.sweep > 0 else -((-turn) % (2 * math.pi))
        candidates = [turn + k * 2 * math.pi * math.copysign(1, self.sweep) for k in range(-1, 2 + int(abs(self.sweep) / (2 * math.pi)))]
        rise, grows = ((to - at) / self.sweep for at, to in (self.rise, self.radii))
        best = min(math.dist(p, self.in_plane(0.0)), math.dist(p, self.in_plane(1.0)))
        for angle in candidates:
            for _ in range(4):
                x, y, z = self.in_plane(angle / self.sweep)
                a, radius = self.begin + angle, self.radii[0] + grows * angle
                dx, dy = -radius * math.sin(a) + grows * math.cos(a), radius * math.cos(a) + grows * math.sin(a)
                slope = (x - p[0]) * dx + (y - p[1]) * dy + (z - p[2]) * rise
                curve = dx * dx + dy * dy + rise * rise - (x - p[0]) * radius * math.cos(a) - (y - p[1]) * radius * math.sin(a)
                if curve <= 0:
                    break
                angle -= slope / curve
            if 0.0 <= angle / self.sweep <= 1.0:
                best = min(best, math.dist(p, self.in_plane(angle / self.sweep)))
        return best

    def length(self):
        return math.hypot(max(self.radii) * self.sweep, self.rise[1] - self.rise[0])


def arc(start, end, center, turns, plane, cuts):
    """From start to end about a centre, in as many turns, begun ones counted; below zero clockwise."""
    (ax, ay, az), (bx, by, bz) = ([point[axis] for axis in PLANES[plane]] for point in (start, end))
    x, y, _ = [center[axis] for axis in PLANES[plane]]
    begin, to = math.atan2(ay - y, ax - x), math.atan2(by - y, bx - x)
    way = math.copysign(1, turns)
    sweep = (way * (to - begin)) % (2 * math.pi)
    sweep += 2 * math.pi * (abs(turns) - (1 if sweep > 1e-9 else 0))
    return Arc((x, y), (math.hypot(ax - x, ay - y), math.hypot(bx - x, by - y)), begin, way * sweep, (az, bz), plane, cuts)


def chords(spline, cuts):
    """A NURBS as lines, by de Boor's recursion in homogeneous coordinates."""
    degree, knots, weights = spline["degree"], spline["knots"], spline["weights"]
    control = [(*(weight * x for x in point), weight) for point, weight in zip(spline["control_mm"], weights)]
    first, last = knots[degree], knots[len(control)]

    def at(u):
        span = next((i for i in range(degree, len(control)) if u < knots[i + 1]), len(control) - 1)
        points = control[span - degree:span + 1]
        for level in range(1, degree + 1):
            for j in range(degree, level - 1, -1):
                i = span - degree + j
                wide = knots[i + degree + 1 - level] - knots[i]
                part = (u - knots[i]) / wide if wide > 0 else 0.0
                points[j] = tuple((1 - part) * a + part * b for a, b in zip(points[j - 1], points[j]))
        *point, weight = points[degree]
        return tuple(x / weight for x in point)

    points = [at(first + (last - first) * k / CHORDS) for k in range(CHORDS + 1)]
    return [Line(a, b, cuts) for a, b in zip(points, points[1:])]


def pieces(program):
    """The path of a program, as feedwright reads it."""
    with tempfile.NamedTemporaryFile("w", suffix=".ngc") as file:
        file.write(program)
        file.flush()
        told = subprocess.run([headless.FEEDWRIGHT, "--quiet", "canon", "--dialect", "linuxcnc", file.name], capture_output=True, text=True, check=True).stdout
    found = []
    for line in told.splitlines():
        motion = json.loads(line).get("motion")
        if not motion or motion["shape"] == "line" and motion["start_mm"] == motion["end_mm"]:
            continue
        start, end, shape, cuts = tuple(motion["start_mm"]), tuple(motion["end_mm"]), motion["shape"], motion["kind"] != "rapid"
        if shape == "line":
            found.append(Line(start, end, cuts))
        elif "arc" in shape:
            found.append(arc(start, end, shape["arc"]["center_mm"], shape["arc"]["turns"], shape["arc"]["plane"], cuts))
        else:
            found += chords(shape["spline"], cuts)
    return found


class Distance:
    """How far a tool that goes along a path is from it: pieces near the one that was nearest last."""

    def __init__(self, path, reach_mm=4.0):
        self.path, self.reach_mm = path, reach_mm
        self.last = next(i for i, piece in enumerate(path) if piece.cuts)

    def of(self, point):
        best, at = math.inf, self.last
        for step in (1, -1):
            gone, i = 0.0, self.last
            # Where it goes back the way that it came, the piece before is as near.
            while 0 <= i < len(self.path) and (gone <= self.reach_mm or abs(i - self.last) <= NEIGHBOURS):
                distance = self.path[i].nearest(point)
                if distance < best:
                    best, at = distance, i
                gone += self.path[i].length() if i != self.last else 0.0
                i += step
        self.last = at
        return best


def to_commands(commands, tool, now, longest=100):
    """How far a tool is from the commands of the last servo periods, of which `now` is the newest, and which of them is nearest."""
    best = math.inf
    near = min(range(max(now - longest, 0), now + 1), key=lambda i: sum((a - b) ** 2 for a, b in zip(commands[i], tool)))
    for i in range(max(near - 2, 0), min(near + 2, len(commands) - 1)):
        best = min(best, Line(commands[i], commands[i + 1]).nearest(tool))
    return best, near
