#!/usr/bin/env python3
"""The controllers of Lee, Cho and Jeon (2005) in the real LinuxCNC: the feedrate through motion.adaptive-feed, the geometry in the component.

    paper.py [--figure FILE.svg]

Cuts the circle of parts/circle.ngc on the simulated tnv40 without control, with the speed alone controlled, with speed and geometry, and with
lqg-identified, in LinuxCNC's own time. The feed override stands at 200 % and the component asks for half of it, so that the cut can be faster than
programmed. Prints a row each; the figure shows the deviation of command (blue) and tool (orange) from the circle, 100 times enlarged, and the commanded speed in mm/s. Exit code 1 where speed and
geometry leave more than 0.3 of the RMS error, or one of them takes the feedrate where it was not asked to go.
"""
import argparse
import math
import pathlib
import subprocess
import sys
import tempfile

import headless
import measure
import programs

# What two components leave of the RMS error, most of it while the trial at the beginning lasts; and the feedrates, as a multiple of the programmed one,
# that a controller may ask for.
LEFT, RATES = 0.3, (0.5, 1.2)
FEED_MM_S = 50.0
# The planner rounds a feedrate in its last digits, and changes it within the acceleration of the machine.
SAME_FEED = 1e-6
ENLARGED = 100
RADIUS = 10.0
# A circle takes 1,350 servo periods.
LEAST_PERIODS = 1000
# Name, controller of the model, pins.
ROWS = [("no control", None, {}),
        ("magnitude-only", "two-dimensional", {"feedwright.speed-alone": 1}),
        ("two-dimensional", "two-dimensional", {}),
        ("lqg-identified", "lqg-identified", {})]


def program():
    """The circle with M52 P1, in which LinuxCNC heeds motion.adaptive-feed."""
    return programs.part("circle", "G64\nM52 P1")


def cut(run, folder, controller, pins):
    """The recording of a row."""
    block, model = folder / "machine.fwmodel", folder / f"{controller}.fwmodel"
    if controller and not model.exists():
        found = folder / f"{controller}.model.toml"
        run("identify", "--machine", "tnv40", "--controller", controller, "--axes", 3, "--out", found)
        run("block", found, "--out", model)
    settings = {"program": program(), "params": {"feedwright.adaptive-scale": 0.5, **pins}, "enable": controller is not None, "override": 2.0}
    # Now and then LinuxCNC ends such a program as its arc begins, without a word.
    for _ in range(measure.TRIALS):
        recording = headless.run("cut", settings, {"FEEDWRIGHT": {"MACHINE": block, "MODEL": model if controller else block}})
        if len(arc(recording)) > LEAST_PERIODS:
            return recording
    raise headless.Failed("the circle was not cut")


def speeds(rows):
    """Speed of the command of each servo period of 1 ms, mm/s."""
    return [math.dist(a.command, b.command) / 1e-3 for a, b in zip(rows, rows[1:])]


def arc(recording):
    """Rows in which the commanded feed is an arc's and has been taken up."""
    moving = [i for i, row in enumerate(recording.rows) if row.motion_type == 3]
    return recording.rows[moving[0]:moving[-1]]


def enlarged(points, center):
    """Points of the plane, their distance from the circle enlarged."""
    found = []
    for x, y, _ in points:
        dx, dy = x - center[0], y - center[1]
        off = math.hypot(dx, dy)
        grown = (RADIUS + ENLARGED * (off - RADIUS)) / off
        found.append((dx * grown, dy * grown))
    return found


def polyline(points, color, width=1.4):
    path = " ".join(f"{x:.2f},{y:.2f}" for x, y in points)
    return f'<polyline points="{path}" fill="none" stroke="{color}" stroke-width="{width}" stroke-linejoin="round"/>'


def figure(cuts):
    """Circle plots in a row, below each its speed over time."""
    side, mid, base, high = 230, 140, 330, 60
    slow, fast, scale = 45.0, 55.0, 8.0
    parts = []
    for column, (name, recording, text) in enumerate(cuts):
        rows, left = arc(recording), column * side
        center = (rows[0].command[0] + RADIUS, rows[0].command[1])
        place = lambda points: [(left + side / 2 + scale * x, mid - scale * y) for x, y in points]
        parts.append(f'<text x="{left + side / 2}" y="18" text-anchor="middle" font-weight="bold">{name}</text>')
        parts += [f'<text x="{left + side / 2}" y="{mid + 4 + 16 * line}" text-anchor="middle">{words}</text>' for line, words in enumerate(text)]
        parts.append(polyline(place(enlarged([row.drive for row in rows[::4]], center)), "#0072b2"))
        parts.append(polyline(place(enlarged([row.tool for row in rows[::4]], center)), "#d55e00"))
        level = lambda speed: base - high * (min(max(speed, slow), fast) - slow) / (fast - slow)
        parts.append(f'<path d="M{left + 30},{base - high} V{base} h{side - 45}" fill="none" stroke="#888"/>')
        parts += [f'<text x="{left + 26}" y="{level(speed) + 4}" text-anchor="end">{speed:.0f}</text>' for speed in (slow, fast)]
        step = (side - 45) / len(rows)
        parts.append(polyline([(left + 30 + step * i, level(speed)) for i, speed in list(enumerate(speeds(rows)))[::4]], "#009e73"))
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {side * len(cuts)} {base + 14}" font-family="sans-serif" font-size="12">'
            f'<rect width="100%" height="100%" fill="#fff"/>{"".join(parts)}</svg>\n')


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--figure", type=pathlib.Path, help="where the figure goes")
    args = parser.parse_args()
    run = lambda *words: subprocess.run([headless.FEEDWRIGHT, "--quiet", *map(str, words)], check=True, stdout=subprocess.DEVNULL)
    cuts, missed, first = [], 0, None
    with tempfile.TemporaryDirectory(prefix="feedwright-paper-") as name:
        folder = pathlib.Path(name)
        folder.chmod(0o755)
        run("block", "tnv40", "--axes", 3, "--out", folder / "machine.fwmodel")
        print(f"{'controller':16} {'programmed path, um':>20} {'commands, um':>16}  time s  speed mm/s  faults")
        for controller, model, pins in ROWS:
            recording = cut(run, folder, model, pins)
            found = measure.figures(recording, program())
            path, commands, time_s = found.programmed, found.commanded, found.time_s
            first = first or found
            run_in = [speed for speed in speeds(arc(recording))][100:-100]
            within = RATES[0] - SAME_FEED <= min(run_in) / FEED_MM_S and max(run_in) / FEED_MM_S <= RATES[1] + SAME_FEED
            missed += not within or (controller == "two-dimensional" and path[0] > LEFT * first.programmed[0])
            print(f"{controller:16} {path[0]:9.2f} / {path[1]:8.2f} {commands[0]:7.2f} / {commands[1]:6.2f}  {time_s:6.3f}  "
                  f"{min(run_in):4.1f} to {max(run_in):4.1f}  {measure.faults_of(recording)}", flush=True)
            cuts.append((controller, recording, (f"{path[0]:.2f} µm RMS", f"{path[1]:.1f} µm max", f"{time_s:.3f} s")))
    if args.figure:
        args.figure.write_text(figure(cuts))
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
