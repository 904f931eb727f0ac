#!/usr/bin/env python3
"""Programs that nobody has chosen: drawn from generators by a seed, cut in a real LinuxCNC without and with the correction.

    show.py [--machine NAME] [--seed S] [--count N] [--mode MODE] [--models FOLDER]

Prints the RMS error to the programmed path, uncorrected, corrected by the machine's own model, and by one that was identified through LinuxCNC.
Without a seed one is drawn. `--models` keeps the models in a folder, and takes those that are there. Exit code 1 where a correction leaves more than 0.05.
"""
import argparse
import math
import pathlib
import random
import sys
import tempfile

import headless
import identified
import measure

LEFT = 0.05
MODES = ("G61", "G64 P0.001 Q0")


def polygon(pick):
    """Straight lines with corners."""
    return [f"G1 X{pick.uniform(-12, 12):.4f} Y{pick.uniform(-12, 12):.4f}" for _ in range(pick.randint(4, 7))]


def arcs(pick):
    """Arcs that meet smoothly or not, and lines between."""
    lines = []
    for _ in range(pick.randint(3, 5)):
        radius = pick.uniform(3, 9)
        lines.append(f"G91 {pick.choice(('G2', 'G3'))} X{radius:.4f} Y{pick.choice((-1, 1)) * radius:.4f} R{radius * pick.uniform(1, 1.3):.4f}")
        lines.append(f"G1 X{pick.uniform(-6, 6):.4f} Y{pick.uniform(-6, 6):.4f}")
    return [*lines, "G90"]


def wave(pick):
    """A closed curve in short lines, as of a CAM system."""
    count, waves, radius, high = pick.randint(60, 300), pick.randint(2, 6), pick.uniform(7, 11), pick.uniform(0.5, 3)
    lines = []
    for k in range(count + 1):
        angle = 2 * math.pi * k / count
        r = radius + high * math.sin(waves * angle)
        lines.append(f"G1 X{r * math.cos(angle):.5f} Y{r * math.sin(angle):.5f}")
    return lines


def lissajous(pick):
    """A curve that crosses itself, in short lines."""
    a, b, phase, count = pick.randint(1, 3), pick.randint(1, 3), pick.uniform(0, 3), pick.randint(100, 300)
    return [f"G1 X{10 * math.sin(a * 2 * math.pi * k / count + phase):.5f} Y{10 * math.sin(b * 2 * math.pi * k / count):.5f}" for k in range(count + 1)]


def helix(pick):
    """Three axes."""
    radius = pick.uniform(5, 10)
    return [f"{pick.choice(('G2', 'G3'))} X0 Y0 Z{-pick.uniform(1, 3):.3f} I{radius:.4f} J0", f"G3 X0 Y0 Z0 I{-radius:.4f} J0"]


def spline(pick):
    """Cubic splines that meet smoothly."""
    x, y = pick.uniform(10, 16), pick.uniform(-8, 8)
    bend = [pick.uniform(4, 10) for _ in range(3)]
    return [f"G5 I{bend[0]:.4f} J{bend[1]:.4f} P{-bend[2]:.4f} Q{bend[1]:.4f} X{x:.4f} Y{y:.4f}",
            f"G5 I{bend[2]:.4f} J{-bend[1]:.4f} P{-bend[0]:.4f} Q{-bend[2]:.4f} X{2 * x:.4f} Y{-y:.4f}"]


GENERATORS = (polygon, arcs, wave, lissajous, helix, spline)


def draw(pick):
    """Name and program, of which the path mode is left open."""
    generator, feed = pick.choice(GENERATORS), pick.choice((1000, 2000, 3000))
    lines = generator(pick)
    first = lines.pop(0).replace("G1", "G0", 1) if lines[0].startswith("G1") else "G0 X0 Y0 Z0"
    return f"{generator.__name__}, F{feed}", "\n".join([
        "G21 G17 G90 G94 MODE", "G0 X-6 Y-6", first, "G4 P0.3", f"F{feed}", *lines, "G4 P0.2", "M2"]) + "\n"


def errors(block, model, mode, drawn, enable):
    """RMS error of each program to its path, um."""
    texts = [text.replace("MODE", mode) for _, text in drawn]
    with tempfile.TemporaryDirectory(prefix="feedwright-show-") as folder:
        ini = {"FEEDWRIGHT": {"MACHINE": block, "MODEL": model}}
        for trial in range(measure.TRIALS):
            try:
                run = headless.run("cuts", {"programs": texts, "enable": enable}, ini, limit_s=400, keep=folder)
                break
            except headless.Failed:
                # On a busy machine LinuxCNC misses its own deadlines.
                if trial == measure.TRIALS - 1:
                    raise
        recorded = [of_file(run, pathlib.Path(folder) / f"samples-{k}.txt") for k in range(len(drawn))]
        # The first program begins where the machine was homed.
        home = recorded[0].rows[0].command
        return [measure.figures(recording, text, home=home).programmed for recording, text in zip(recorded, texts)]


def of_file(run, file):
    """The recording of one program of a run."""
    return headless.Recording(headless.rows(file), run.result, run.log)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--machine", default="tnv40")
    parser.add_argument("--seed", type=int)
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--mode", choices=MODES, help="this path mode alone")
    parser.add_argument("--models", type=pathlib.Path, help="folder of machine.fwmodel and model.fwmodel")
    args = parser.parse_args()
    seed = args.seed if args.seed is not None else random.SystemRandom().randrange(10**6)
    pick, missed = random.Random(seed), 0
    drawn = [draw(pick) for _ in range(args.count)]
    print(f"seed {seed}, machine {args.machine}; um RMS / largest to the program", flush=True)
    with tempfile.TemporaryDirectory(prefix="feedwright-show-models-") as name:
        folder = args.models or pathlib.Path(name)
        folder.chmod(0o755)
        block, model = folder / "machine.fwmodel", folder / "model.fwmodel"
        if not model.exists():
            identified.identify(folder, args.machine)
        for mode in [args.mode] if args.mode else MODES:
            off, own, found = (errors(block, of, mode, drawn, enable) for of, enable in ((block, False), (block, True), (model, True)))
            for (title, _), *each in zip(drawn, off, own, found):
                ratios = [with_um[0] / each[0][0] for with_um in each[1:]]
                missed += sum(ratio > LEFT for ratio in ratios)
                cells = "".join(f"{rms:9.2f} / {most:7.2f}" for rms, most in each)
                print(f"{mode:14} {title:18} {cells}   {ratios[0]:.4f} {ratios[1]:.4f} {'MISSED' if max(ratios) > LEFT else ''}", flush=True)
    print(f"{missed} cuts leave more than {LEFT}")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
