"""Programs that are cut: the parts of this repository, and some that need three axes or many segments."""
import math
import pathlib

PARTS = pathlib.Path(__file__).resolve().parents[2] / "parts"


def with_rests(text):
    """Rests before and behind the cut."""
    lines = []
    for line in text.splitlines():
        lines += (["G4 P0.2"] if line.startswith("M2") else []) + [line] + (["G4 P0.3"] if line.startswith("G0") else [])
    return "\n".join(lines) + "\n"


def part(name, mode):
    """A part of the repository in a path mode, with rests before and behind the cut."""
    lines = (PARTS / f"{name}.ngc").read_text().splitlines()
    return with_rests("\n".join(f"G21 G17 G90 G94 {mode}" if line.startswith("G21") else line for line in lines))


def helix(mode):
    return f"G21 G17 G90 G94 {mode}\nG0 X0 Y0 Z0\nG4 P0.3\n" + "".join(
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
    """Cubic splines that meet smoothly, as LinuxCNC reads G5."""
    return (f"G21 G17 G90 G94 {mode}\nG0 X0 Y0\nG4 P0.3\nF3000\nG5 I10 J15 P-10 Q15 X40 Y0\nG5 I10 J-15 P-10 Q-15 X80 Y0\n"
            "G5 I10 J15 P0 Q15 X100 Y-20\nG4 P0.2\nM2\n")


def programs(quick=False):
    """Name, text, and whether it has corners."""
    found = [("circle G64", part("circle", "G64"), False), ("star G64 P0.01", part("star", "G64 P0.01"), False),
             ("square G61", part("square", "G61"), True), ("helix G64", helix("G64"), False)]
    if quick:
        return found
    return found + [
        ("eight G64 P0.01", part("eight", "G64 P0.01"), False),
        ("ellipse G64 P0.01", part("ellipse", "G64 P0.01"), False),
        ("star G64 P0.001 Q0", part("star", "G64 P0.001 Q0"), False),
        ("eight G64 P0.001 Q0", part("eight", "G64 P0.001 Q0"), False),
        ("square G64 P0.01", part("square", "G64 P0.01"), True),
        ("square G64 P0.001 Q0", part("square", "G64 P0.001 Q0"), True),
        ("star G61", part("star", "G61"), True),
        ("spline G64 P0.01", spline("G64 P0.01"), False),
        ("slot G64 P0.01", part("slot", "G64 P0.01"), True),
        ("segments G64 P0.01", segments("G64 P0.01"), True),
        ("segments G64 P0.001 Q0", segments("G64 P0.001 Q0"), True),
    ]
