#!/usr/bin/env python3
"""The whole way of a machine owner, on a simulated machine: the program of `feedwright excite` runs through the same HAL chain, the log is
identified, and the model of it corrects live.

    identified.py [--machine NAME]

Prints the products that make the motion, as identified and as they are, what is cut with the model, and what `feedwright run --log` reads out of
a record of that. Exit code 1 where products differ by more than 2 %, the largest contour error by more than 0.1 um, or a target is missed.
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile
import tomllib

import headless
import measure
import programs

# Relative, and um.
SAME = 0.02
SAME_UM = 0.1


def log_of(recording, command, actual):
    lines = ["# sample_time_s = 0.001", "# n x.cmd x.act y.cmd y.act z.cmd z.act"]
    for n, row in enumerate(recording.rows):
        pairs = " ".join(f"{c:.9f} {a:.9f}" for c, a in zip(getattr(row, command), getattr(row, actual)))
        lines.append(f"{n} {pairs}")
    return "\n".join(lines) + "\n"


def products(axis):
    """What positions tell of an axis; its inertia they do not."""
    kv, inertia = axis["kv_nm_s_per_rad"], axis["inertia_kg_m2"]
    return {"Kp Kv / J": axis["kp_1_s"] * kv / inertia, "(Kv + B) / J": (kv + axis["viscous_friction_nm_s"]) / inertia,
            "Fc / J": axis["coulomb_friction_nm"] / inertia}


def run(*words):
    """What the command of feedwright prints."""
    return subprocess.run([headless.FEEDWRIGHT, "--quiet", *map(str, words)], check=True, capture_output=True, text=True).stdout


def truth_of(machine):
    """The machine file of a built-in machine."""
    return tomllib.loads((headless.HERE.parents[1] / "crates" / "sim" / "machines" / f"{machine}.toml").read_text())


def identify(folder, machine):
    """Identifies a machine through LinuxCNC, as its owner does. Returns the files of the machine, of what was found, and of the model of it."""
    block, program, log, found, model = (folder / file for file in ("machine.fwmodel", "excite.ngc", "log.txt", "found.toml", "model.fwmodel"))
    run("block", machine, "--axes", 3, "--out", block)
    run("excite", "--machine", machine, "--out", program)
    recording = headless.run("cut", {"program": program.read_text(), "params": {"feedwright.direct": 1}},
                             {"FEEDWRIGHT": {"MACHINE": block, "MODEL": block}}, limit_s=300)
    log.write_text(log_of(recording, "drive", "feedback"))
    axis = truth_of(machine)["axis"]["x"]
    run("identify", log, "--lead", axis["lead_mm_per_rev"], "--inertia", axis["inertia_kg_m2"], "--out", found)
    run("block", found, "--out", model)
    return block, found, model


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--machine", default="tnv40")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="feedwright-identified-") as name:
        folder = pathlib.Path(name)
        folder.chmod(0o755)
        block, found, model = identify(folder, args.machine)
        log, truth = folder / "log.txt", truth_of(args.machine)
        machine, wrong = tomllib.loads(found.read_text()), 0
        for axis in "xyz":
            for product, value in products(machine["axis"][axis]).items():
                true = products(truth["axis"][axis])[product]
                off = value / true - 1
                wrong += abs(off) > SAME
                print(f"{axis} {product:14} {value:10.3f}, true {true:10.3f}: {100 * off:+.2f} %")
        wrong += measure.table((str(block), str(model)), {}, programs.programs(True))
        for name, program, _ in programs.programs(True):
            part, results = folder / "part.ngc", folder / "results.json"
            part.write_text(program)
            recording = headless.run("cut", {"program": program, "enable": True}, {"FEEDWRIGHT": {"MACHINE": block, "MODEL": model}})
            log.write_text(log_of(recording, "command", "tool"))
            # Of an axis that stands still a recorder shows noise alone.
            moved = "xyz" if name.startswith("helix") else "xy"
            columns = ",".join(f"{axis}.{what}={axis}.{what}" for axis in moved for what in ("cmd", "act"))
            run("run", part, "--machine", found, "--log", log, "--columns", columns, "--json", results, "--report", folder / "report.html")
            read = next(each for each in json.loads(results.read_text())["runs"] if each["controller"] == "measured")
            rms, most = measure.figures(recording, program).programmed
            # Where the cut ends and the rest begins the two tell otherwise, so that their means differ by some per cent.
            wrong += abs(read["max_um"] - most) > SAME_UM
            print(f"{name:24} read out of the record: {read['rms_um']:.2f} / {read['max_um']:.2f} um, by the exact path {rms:.2f} / {most:.2f}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
