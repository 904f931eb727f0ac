#!/usr/bin/env python3
"""The limit, peers and the controllers of feedwright over the level of each kind of noise: the study examples/05_noise.

    lab/noise_levels.py FOLDER [LEVELS [defaults]]   a comparison, its table and a figure for each kind of noise
    lab/noise_levels.py --show                       what the kept comparison shows, as JSON, for the golden tests

Every peer is tuned on `tnv40` with one kind of noise at each level, and then cut there. LEVELS, 1 to 5, is the number of
levels of each kind, spread from the lowest to the highest. With `defaults` the peers are not tuned: the result is a trial, and
the table says so. An interrupted run continues where it stopped. The programs feedwright-lab and its example `draw` are those
of target/release.
"""

import itertools
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile

from tables import BASELINE, LIMIT, ROOT, Comparison, markdown, replaced

# It has no noise of its own but the 25 Hz of its disturbance.
BASE = "tnv40"
CONTROLLERS = [BASELINE, "feedforward-cross-coupled", "kalman-disturbance", "lqg-identified", LIMIT]
CONTOURS = ["circle", "eight", "star", "square"]
NOISE_SEEDS = 3
# Marks a controller that did not stay in the loop in every cut.
OUT_OF_THE_LOOP = "*"
# Room on either side of curves, powers of ten.
MARGIN = 0.06
# Kind of noise: what its level is, unit, key of an axis, other keys, levels in powers of about three. The values of
# examples/03_realism/machines, where reasons stand beside them, lie within the levels.
KINDS = {
    "white": ("white encoder noise, RMS", "µm", "encoder_noise_um", "", (0.03, 0.1, 0.3, 1.0, 3.0)),
    "steps": ("encoder step", "µm", "encoder_step_um", "", (0.1, 0.3, 1.0, 3.0, 10.0)),
    "interpolation": (
        "interpolation error of the encoder, amplitude",
        "µm",
        "interpolation_error_um",
        "signal_period_um = 20\n",
        (0.03, 0.1, 0.3, 1.0, 3.0),
    ),
    "torque": (
        "broadband torque up to 100 Hz, RMS",
        "N m",
        "torque_noise_nm",
        "torque_noise_s = 0.0015915494309189536\n",
        (0.01, 0.03, 0.1, 0.3, 1.0),
    ),
    "cogging": ("cogging, amplitude", "N m", "cogging_nm", "cogging_per_rev = 24\n", (0.01, 0.03, 0.1, 0.3, 1.0)),
    "wander": (
        "wander of the 25 Hz of the disturbance, RMS, part of it",
        "1",
        "disturbance_wander",
        "",
        (0.005, 0.015, 0.05, 0.15, 0.5),
    ),
}


def machine_name(kind, level):
    return f"{kind}_{level:g}"


def machine_file(kind, level):
    """The machine with a level of a kind of noise on both axes."""
    what, unit, key, more, _ = KINDS[kind]
    axes = "".join(f"[axis.{axis}]\n{key} = {level}\n{more}" for axis in "xy")
    about = f'description = "{BASE} with {what}: {level:g} {unit}"\nsource = "levels of a study"\n'
    return f'base = "{BASE}"\nname = "{machine_name(kind, level)}"\n{about}{axes}'


def error(comparison, machine, controller):
    """RMS error by the encoders over all contours, um; none unless all was cut to its end."""
    return comparison.rms_um(machine, controller, "joint_rms_um", "rms_um")


def levels_cut(comparison, kind):
    return [level for level in KINDS[kind][4] if machine_name(kind, level) in comparison.machines]


def table(comparison):
    """A line for each level of each kind, a column for each controller."""

    def cell(machine, controller):
        rms_um = error(comparison, machine, controller)
        lost = any(comparison.lines.get((machine, controller), {}).get("lost", ()))
        return "lost" if rms_um is None else f"{rms_um:.3f}{OUT_OF_THE_LOOP if lost else ''}"

    def line(name, size, machine):
        return [name, size, *(cell(machine, controller) for controller in CONTROLLERS)]

    lines = [line("without noise", "0", BASE)]
    for kind, (what, unit, *_) in KINDS.items():
        for number, level in enumerate(levels_cut(comparison, kind)):
            size = f"{level:g}" if unit == "1" else f"{level:g} {unit}"
            lines.append(line(what if number == 0 else "", size, machine_name(kind, level)))
    evaluations = sum(tuned["cuts"] for tuned in comparison.tuned)
    made = f"peers were tuned in {evaluations} evaluations"
    if evaluations == 0:
        made = "peers run with their defaults, which is a trial and no verdict"
    text = markdown("RMS over all contours, µm", ["", *CONTROLLERS], lines).replace("|  |", "| |", 1)
    return f"{text}\n{len(comparison.machines)} machines, {comparison.noise_seeds} noise seeds; {made}.\n"


def figures(comparison):
    """A figure for each kind, as the example `draw` reads it: errors over the level. All have the same vertical axis."""

    def curves(kind):
        for number, controller in enumerate(CONTROLLERS):
            line = {BASELINE: "Dotted", LIMIT: "Dashed"}.get(controller, "Solid")
            label = controller + (", the limit" if controller == LIMIT else "")
            found = [(level, error(comparison, machine_name(kind, level), controller)) for level in levels_cut(comparison, kind)]
            for there, run in itertools.groupby(found, lambda pair: pair[1] is not None):
                if there:  # A cut that was lost leaves a gap.
                    points = [[math.log10(level), math.log10(rms_um)] for level, rms_um in run]
                    yield {"label": label, "points": points, "line": line, "color": f"color {number}"}

    def spread(curves, axis):
        values = [point[axis] for curve in curves for point in curve["points"]]
        return [min(values) - MARGIN, max(values) + MARGIN] if values else None

    drawn = {kind: list(curves(kind)) for kind in KINDS}
    y_range = spread([curve for all_ in drawn.values() for curve in all_], 1)

    def panel(kind):
        what, unit = KINDS[kind][:2]
        return {
            "x_title": what[0].upper() + what[1:] + ("" if unit == "1" else f" [{unit}]"),
            "y_title": "RMS contour error [µm]",
            "curves": drawn[kind],
            "powers_of_ten": True,
            "x_range": spread(drawn[kind], 0),
            "y_range": y_range,
        }

    return {f"{kind}.svg": {"panels": [panel(kind)]} for kind in KINDS}


def compared(levels, tuning, machines):
    """The comparison as text. It claims nothing."""
    chosen = [4 * k // (levels - 1) for k in range(levels)] if levels > 1 else [2]
    names = [(kind, KINDS[kind][4][k]) for kind in KINDS for k in chosen]
    files = [machines / f"{machine_name(*name)}.toml" for name in names]
    for file, name in zip(files, names):
        file.write_text(machine_file(*name))
    result = machines / "noise.json"
    only = ",".join([*CONTOURS, BASE, *CONTROLLERS])
    command = [ROOT / "target/release/feedwright-lab", "compare", "--only", only, "--knowledge", "own"]
    command += ["--seeds", str(NOISE_SEEDS), "--tuning", tuning, "--json", result]
    subprocess.run([*command, *(word for file in files for word in ("--machine", file))], check=True, stdout=subprocess.DEVNULL)
    return re.sub(r'"claims":\[\n.*?\n\]', '"claims":[\n\n]', result.read_text(), count=1, flags=re.DOTALL)


def main(arguments):
    if arguments == ["--show"]:
        kept = Comparison("examples/05_noise/noise.json")
        ends = {machine_name(kind, level): machine_file(kind, level) for kind in KINDS for level in KINDS[kind][4][::4]}
        print(json.dumps({"table": table(kept), "figures": figures(kept), "ends": ends, "controllers": CONTROLLERS}))
        return
    folder, levels, tuning = (*arguments, *("5", "search")[len(arguments) - 1 :])
    folder = pathlib.Path(folder).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as machines:
        text = compared(min(max(int(levels), 1), 5), tuning, pathlib.Path(machines))
    (folder / "noise.json").write_text(text)
    comparison = Comparison(folder / "noise.json")
    for name, figure in figures(comparison).items():
        subprocess.run([ROOT / "target/release/examples/draw", folder / name], input=json.dumps(figure), text=True, check=True)
    document = folder / "README.md"
    if document.exists():
        document.write_text(replaced(document.read_text(), "noise levels", table(comparison), "noise-levels"))
    print(table(comparison), end="")


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3, 4):
        sys.exit(__doc__)
    main(sys.argv[1:])
