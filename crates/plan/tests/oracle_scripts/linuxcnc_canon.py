#!/usr/bin/python3
"""Runs LinuxCNC's own interpreter over G-code files and writes what moves, in full precision, as JSON.

usage: linuxcnc_canon.py OUTPUT_FOLDER FILE...

File number n gives OUTPUT_FOLDER/n.json: one list a line,
  ["rapid" | "feed" | "probe" | "tap", line, end]                            end: nine machine coordinates, mm and degrees
  ["arc", line, end, plane, centre of the plane's two axes, turns]           plane: 0 XY, 1 ZX, 2 YZ
  ["error", line, message]                                                   last line of a program that is refused, or the next
Coordinates are those of the machine: programmed + G92, rotated, + coordinate system + tool.
The module of LinuxCNC 2.9 crashes at T, M6, M61 Q and G43.2 H when no LinuxCNC runs, so these words and G43 H are taken out first;
with tool lengths of zero they move nothing. So it does at G41 D and G42 D, which become G41.1 and G42.1 with the diameter of all tools.
A crash of the interpreter (it happens) leaves a file without a last line ["end"].
"""
import json
import math
import os
import re
import resource
import signal
import sys
import tempfile

import gcode

INCH = 25.4
# Some programs loop forever. A limit of processor time ends them after the same work on an idle and on a busy machine; the longest program of the
# corpus takes 1 s.
PROCESSOR_S = 10
# The interpreter sometimes waits forever without using the processor.
SECONDS = 300
AXES = range(9)
ROTARY = (3, 4, 5)
PLANES = {1: (0, (0, 1, 2)), 3: (1, (2, 0, 1)), 2: (2, (1, 2, 0))}


def to_mm(values):
    return [v if n in ROTARY else v * INCH for n, v in enumerate(values)]


class Recorder:
    """Takes the calls of the interpreter; every call not named here means nothing to a path."""

    def __init__(self, output, variables):
        self.parameter_file = variables
        self.output = output
        self.line = 0
        self.system = [0.0] * 9
        self.shift = [0.0] * 9
        self.tool = [0.0] * 9
        self.angle = 0.0
        self.plane = 1
        self.refused = None

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return lambda *arguments: None

    def write(self, *items):
        self.output.write(json.dumps(items) + "\n")

    def machine(self, point):
        point = [p + s for p, s in zip(point, self.shift)]
        sin, cos = math.sin(self.angle), math.cos(self.angle)
        x, y = point[0], point[1]
        if self.angle:
            point[0], point[1] = x * cos - y * sin, x * sin + y * cos
        return [p + o + t for p, o, t in zip(point, self.system, self.tool)]

    def next_line(self, state):
        self.line = state.sequence_number

    def set_g5x_offset(self, _index, *values):
        self.system = to_mm(values)

    def set_g92_offset(self, *values):
        self.shift = to_mm(values)

    def set_xy_rotation(self, degrees):
        self.angle = math.radians(degrees)

    def tool_offset(self, *values):
        self.tool = to_mm(values)

    def set_plane(self, plane):
        self.plane = plane

    def straight_traverse(self, *point):
        self.write("rapid", self.line, self.machine(to_mm(point)))

    def straight_feed(self, *point):
        self.write("feed", self.line, self.machine(to_mm(point)))

    def straight_probe(self, *point):
        self.write("probe", self.line, self.machine(to_mm(point)))

    def rigid_tap(self, x, y, z):
        self.write("tap", self.line, self.machine(to_mm([x, y, z] + [0.0] * 6)))

    def arc_feed(self, first_end, second_end, first_center, second_center, turns, normal_end, *others):
        number, (first, second, normal) = PLANES[self.plane]
        end, center = [0.0] * 3, [0.0] * 3
        end[first], end[second], end[normal] = first_end, second_end, normal_end
        center[first], center[second], center[normal] = first_center, second_center, normal_end
        end = self.machine(to_mm(end + list(others)))
        center = self.machine(to_mm(center + list(others)))
        self.write("arc", self.line, end, number, [center[first], center[second]], turns)

    def check_abort(self):
        return False

    def get_external_angular_units(self):
        return 1.0

    def get_external_length_units(self):
        return 1.0 / INCH

    def get_axis_mask(self):
        return 511

    def get_block_delete(self):
        return False

    def get_tool(self, number):
        return (number,) + (0.0,) * 9 + (0.125, 0.0, 0.0, 0)


TOOL_WORDS = re.compile(rb"(?i)\bT\s*\d+|\bM\s*0?6(?!\d)|G\s*43(?![.\d])")
ADDED_WORDS = re.compile(rb"(?i)\bG\s*43\.2\s*H\s*\d+(?![.\d])|\bM\s*61\s*Q\s*\d+(?![.\d])")
LENGTH_WORD = re.compile(rb"(?i)H\s*\d+")
RADIUS_WORD = re.compile(rb"(?i)G\s*4([12])(?![.\d])(.*?)D\s*\d+(?![.\d])")
RADIUS_OF_TOOL = re.compile(rb"(?i)G\s*4([12])(?![.\d])()")
TOOL_CHANGE = re.compile(rb"(?im)^[^(;\n]*M\s*(0?6|61)(?!\d)")
# All tools are an eighth of an inch thick, in the unit of the program.
RADIUS_GIVEN = rb"G4\1.1 D[0.125*[1+24.4*#<_metric>]]\2"


def without_tools(line, has_tool):
    """The line without tool words; comments stay as they are. `has_tool`: the program puts one into the spindle."""
    code = re.split(rb"[(;]", line, maxsplit=1)[0]
    comment = line[len(code):]
    code = ADDED_WORDS.sub(b"", code)
    stripped = TOOL_WORDS.sub(b"", code)
    if stripped != code:
        stripped = LENGTH_WORD.sub(b"", stripped)
    stripped = RADIUS_WORD.sub(RADIUS_GIVEN, stripped)
    if has_tool:
        stripped = RADIUS_OF_TOOL.sub(RADIUS_GIVEN, stripped)
    return stripped + comment


def run(path, output):
    with tempfile.TemporaryDirectory() as folder:
        with open(path, "rb") as original:
            text = original.read()
        has_tool = TOOL_CHANGE.search(text) is not None
        lines = [without_tools(line, has_tool) for line in text.splitlines(keepends=True)]
        path = os.path.join(folder, "program.ngc")
        with open(path, "wb") as stripped:
            stripped.writelines(lines)
            stripped.write(b"\nM2\n")  # Both readers take a program without an end; here it would be an error.
        variables = os.path.join(folder, "variables")
        open(variables, "w").close()
        recorder = Recorder(output, variables)
        result, line = gcode.parse(path, recorder, "G21", "")
        if result > gcode.MIN_ERROR:
            recorder.write("error", line, gcode.strerror(result))
        recorder.write("end")


def main():
    folder, *files = [os.path.abspath(path) for path in sys.argv[1:]]
    for number, path in enumerate(files):
        child = os.fork()
        if child == 0:
            signal.alarm(SECONDS)
            resource.setrlimit(resource.RLIMIT_CPU, (PROCESSOR_S, PROCESSOR_S))
            os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
            os.chdir(os.path.dirname(os.path.abspath(path)))
            with open(os.path.join(folder, "%d.json" % number), "w") as output:
                run(path, output)
            os._exit(0)
        os.waitpid(child, 0)


main()
