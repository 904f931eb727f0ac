"""Programs that are cut: the parts of this repository, some that need three axes or many segments, and, where they are, programs of others."""
import math
import pathlib
import re
import sys

PARTS = pathlib.Path(__file__).resolve().parents[2] / "parts"
# Foreign programs are no part of this repository: file, and lines that are cut, some 20 s.
FOREIGN = PARTS.parent.parent / "shared" / "corpus" / "gcode"
OTHERS = {"meander": ("linuxcnc-tp/51MeanderAve.ngc", 200), "ball": ("cncjs/tball.gcode", 600), "spiral": ("linuxcnc-tp/spiral_lines.ngc", 500)}
CORNERS = ("square", "slot", "pocket")
MODES = ("G61", "G64 P0.01", "G64 P0.001 Q0")


def with_rests(text):
    """Rests before and behind the cut."""
    lines = []
    for line in text.splitlines():
        lines += (["G4 P0.2"] if line.startswith("M2") else []) + [line] + (["G4 P0.3"] if line.startswith("G0") else [])
    return "\n".join(lines) + "\n"


def part(name, mode):
    """A part of the repository in a path mode, with rests before and behind the cut."""
    lines = (PARTS / f"{name}.ngc").read_text().splitlines()
    return with_rests("\n".join(f"G21 G17 G90 G94 {mode}" if re.match(r"(N\d+ )?G21\b", line) else line for line in lines))


def helix(mode):
    # The first motion shows whether the model is of this machine: it is a rapid here, as in the other programs.
    return f"G21 G17 G90 G94 {mode}\nG0 X-10 Y0 Z0\nG0 X0\nG4 P0.3\n" + "".join(
        f"G3 X0 Y0 Z{-2 * (k + 1)} I-10 J0 F3000\n" for k in range(2)) + "G4 P0.2\nM2\n"


def segments(mode, count=500):
    """The star of parts/star.ngc as straight segments."""
    def point(k):
        a = 2 * math.pi * k / count
        r = 12 + 4 * math.cos(5 * a)
        return f"X{r * math.cos(a):.6f} Y{r * math.sin(a):.6f}"
    lines = [f"G21 G17 G90 G94 {mode}", "G0 X16 Y0", "G4 P0.3", "F3000"]
    return "\n".join(lines + [f"G1 {point(k)}" for k in range(1, count + 1)] + ["G4 P0.2", "M2"]) + "\n"


def spline(mode):
    """Cubic splines that meet smoothly, as LinuxCNC reads G5, behind a rapid in which the model of the axes is checked."""
    return (f"G21 G17 G90 G94 {mode}\nG0 X-5 Y-5\nG0 X0 Y0\nG4 P0.3\nF3000\nG5 I10 J15 P-10 Q15 X40 Y0\nG5 I10 J-15 P-10 Q-15 X80 Y0\n"
            "G5 I10 J15 P0 Q15 X100 Y-20\nG4 P0.2\nM2\n")


def foreign(name, mode):
    """The beginning of a foreign program, in a path mode of ours."""
    file, count = OTHERS[name]
    lines = (FOREIGN / file).read_text().splitlines()[:count]
    lines = [re.sub(r"(?i)G6[14](\.1)?|(?<![A-Z])[PQ]0[\d.]*(?![\d.])", "", line) if re.match(r"(?i)\s*G6[14]", line) else line for line in lines]
    return "\n".join([f"G21 G17 G90 G94 {mode}", "G4 P0.3", *(line for line in lines if not re.match(r"(?i)\s*M(2|30)\b", line)), "G4 P0.2", "M2"]) + "\n"


def programs(quick=False):
    """Name, text, and whether it has corners."""
    found = [("circle G64", part("circle", "G64"), False), ("star G64 P0.01", part("star", "G64 P0.01"), False),
             ("square G61", part("square", "G61"), True), ("helix G64", helix("G64"), False)]
    if quick:
        return found
    if not FOREIGN.is_dir():
        print(f"no foreign programs at {FOREIGN}: they are not cut", file=sys.stderr)
    for mode in MODES:
        # With stops at corners, or with the corners of chords, no path is smooth.
        smooth = mode != "G61"
        found += [(f"{name} {mode}", part(name, mode), name in CORNERS or not smooth)
                  for name in ("circle", "star", "eight", "ellipse", "square", "slot", "pocket")]
        found += [(f"helix {mode}", helix(mode), False), (f"spline {mode}", spline(mode), not smooth), (f"segments {mode}", segments(mode), True)]
        if FOREIGN.is_dir():
            found += [(f"{name} {mode}", foreign(name, mode), True) for name in OTHERS]
    return found
