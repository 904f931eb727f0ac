"""Exact paths of simple programs, and how far a point is from them.

A program is read as far as the parts of this repository and programs() need it: G0 to G3 with X, Y, Z, I, J in the XY plane and in mm.
A path is a list of pieces, each a line or an arc with a rise (a helix).
"""
import dataclasses
import math
import re


@dataclasses.dataclass
class Line:
    start: tuple
    end: tuple

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
    center: tuple
    radius: float
    begin: float
    sweep: float
    z: tuple

    def at(self, t):
        angle = self.begin + t * self.sweep
        x, y = self.center
        return (x + self.radius * math.cos(angle), y + self.radius * math.sin(angle), self.z[0] + t * (self.z[1] - self.z[0]))

    def nearest(self, p):
        """By Newton's method from the angle in the plane; a helix rises slowly."""
        turn = math.atan2(p[1] - self.center[1], p[0] - self.center[0]) - self.begin
        turn = turn % (2 * math.pi) if self.sweep > 0 else -((-turn) % (2 * math.pi))
        candidates = [turn + k * 2 * math.pi * math.copysign(1, self.sweep) for k in range(-1, 2 + int(abs(self.sweep) / (2 * math.pi)))]
        rise = (self.z[1] - self.z[0]) / self.sweep
        best = min(math.dist(p, self.at(0.0)), math.dist(p, self.at(1.0)))
        for angle in candidates:
            for _ in range(4):
                x, y, z = self.at(angle / self.sweep)
                a = self.begin + angle
                dx, dy = -self.radius * math.sin(a), self.radius * math.cos(a)
                slope = (x - p[0]) * dx + (y - p[1]) * dy + (z - p[2]) * rise
                curve = dx * dx + dy * dy + rise * rise - (x - p[0]) * self.radius * math.cos(a) - (y - p[1]) * self.radius * math.sin(a)
                if curve <= 0:
                    break
                angle -= slope / curve
            if 0.0 <= angle / self.sweep <= 1.0:
                best = min(best, math.dist(p, self.at(angle / self.sweep)))
        return best

    def length(self):
        return math.hypot(self.radius * self.sweep, self.z[1] - self.z[0])


WORD = re.compile(r"([A-Z])\s*([-+]?[\d.]+)")


def is_read(program):
    """Whether all of a program is of the few words that are read here."""
    code = re.sub(r"\(.*?\)|;.*", "", program)
    return not re.search(r"R\s*[-\d.]|G\s*(5|91|18|19)\b", code)


def pieces(program):
    """What a program cuts: motions at feedrate."""
    at, code, found = [0.0, 0.0, 0.0], None, []
    for line in program.splitlines():
        line = re.sub(r"\(.*?\)|;.*", "", line)
        words = [(letter, float(number)) for letter, number in WORD.findall(line)]
        codes = [number for letter, number in words if letter == "G"]
        code = next((number for number in codes if number in (0, 1, 2, 3)), code)
        values = {letter: number for letter, number in words if letter in "XYZIJ"}
        if 4.0 in codes or not set("XYZIJ") & set(values):
            continue
        to = [values.get(axis, here) for axis, here in zip("XYZ", at)]
        if code == 1 and to != at:
            found.append(Line(tuple(at), tuple(to)))
        if code in (2, 3):
            center = (at[0] + values.get("I", 0.0), at[1] + values.get("J", 0.0))
            begin, end = (math.atan2(p[1] - center[1], p[0] - center[0]) for p in (at, to))
            sweep = (end - begin) % (2 * math.pi) if code == 3 else -((begin - end) % (2 * math.pi))
            if abs(sweep) < 1e-12:
                sweep = 2 * math.pi if code == 3 else -2 * math.pi
            found.append(Arc(center, math.dist(center, at[:2]), begin, sweep, (at[2], to[2])))
        at = to
    return found


def start(path):
    """Where a path begins."""
    return path[0].start if isinstance(path[0], Line) else path[0].at(0.0)


class Distance:
    """How far a tool that goes along a path is from it: pieces near the one that was nearest last."""

    def __init__(self, path, reach_mm=4.0):
        self.path, self.reach_mm, self.last = path, reach_mm, 0

    def of(self, point):
        best, at = math.inf, self.last
        for step in (1, -1):
            gone, i = 0.0, self.last
            while 0 <= i < len(self.path) and gone <= self.reach_mm:
                distance = self.path[i].nearest(point)
                if distance < best:
                    best, at = distance, i
                gone += self.path[i].length() if i != self.last else 0.0
                i += step
        self.last = at
        return best


def to_commands(commands, tool, now, longest=100):
    """How far a tool is from the commands of the last servo periods; `now` is the newest that there is."""
    best = math.inf
    near = min(range(max(now - longest, 0), now + 1), key=lambda i: sum((a - b) ** 2 for a, b in zip(commands[i], tool)))
    for i in range(max(near - 2, 0), min(near + 2, len(commands) - 1)):
        best = min(best, Line(commands[i], commands[i + 1]).nearest(tool))
    return best
