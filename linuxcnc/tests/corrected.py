#!/usr/bin/env python3
"""Programs of `feedwright correct` in a real LinuxCNC without any live correction: original and corrected text, against the original path.

    corrected.py

Exit code 1 where a smooth path keeps more than a tenth of its RMS or a quarter of its largest error, or a square more than a quarter and 0.3.
"""
import argparse
import pathlib
import subprocess
import sys
import tempfile

import headless
import measure
import programs

# The limits of configs/workshop-sim.
LIMITS = "".join(f"\n[axis.{axis}]\nmax_velocity_mm_s = 200\nmax_accel_mm_s2 = 2000\nmax_jerk_mm_s3 = 50000\n" for axis in "xyz")
MACHINE = f"""base = "tnv40"
name = "limited"
description = "tnv40 with the limits of LinuxCNC's configuration"
source = "a test"
{LIMITS}
[limits]
path_tolerance_um = 10
"""
SMOOTH, CORNERS = (0.1, 0.25), (0.25, 0.3)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    args = parser.parse_args()
    missed = 0
    with tempfile.TemporaryDirectory(prefix="feedwright-corrected-") as name:
        folder = pathlib.Path(name)
        folder.chmod(0o755)
        machine, block, out = folder / "machine.toml", folder / "machine.fwmodel", folder / "corrected.ngc"
        machine.write_text(MACHINE)
        run = lambda *words: subprocess.run([headless.FEEDWRIGHT, "--quiet", *map(str, words)], check=True, stdout=subprocess.DEVNULL)
        run("block", "tnv40", "--axes", 3, "--out", block)
        print(f"{'program':10} {'original, um':>16} {'corrected':>16}  time")
        for part, (rms, most) in (("circle", SMOOTH), ("star", SMOOTH), ("eight", SMOOTH), ("square", CORNERS)):
            run("correct", programs.PARTS / f"{part}.ngc", "--machine", machine, "--for", "linuxcnc", "--file-error", 0, "--out", out)
            original = programs.with_rests((programs.PARTS / f"{part}.ngc").read_text())
            cut = lambda text: measure.figures(
                headless.run("cut", {"program": text, "enable": False}, {"FEEDWRIGHT": {"MACHINE": block, "MODEL": block}}), original)
            was, now = cut(original), cut(programs.with_rests(out.read_text()))
            ok = now.programmed[0] <= rms * was.programmed[0] and now.programmed[1] <= most * was.programmed[1]
            missed += not ok
            cells = [f"{figures.programmed[0]:.2f} / {figures.programmed[1]:.2f}" for figures in (was, now)]
            print(f"{part:10} {cells[0]:>16} {cells[1]:>16}  {now.time_s / was.time_s:.3f}  {'' if ok else 'MISSED'}", flush=True)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
