#!/usr/bin/env python3
"""Every program on tnv40, and the quick ones on machines that differ: never worse than without the correction.

    sweep.py [--only CASE]

Models are identified with `feedwright identify`, on the machine itself or, where that is said, on the machine that it once was. Takes some
25 minutes, most of them waiting. Exit code 1 where a target is missed.
"""
import argparse
import dataclasses
import pathlib
import subprocess
import sys
import tempfile

import headless
import measure
import programs


@dataclasses.dataclass
class Case:
    """A machine, the one that it was identified as, and pins that are set."""
    name: str
    base: str
    changes: dict = dataclasses.field(default_factory=dict)
    identified: bool = True
    pins: dict = dataclasses.field(default_factory=dict)
    periods: dict = dataclasses.field(default_factory=dict)
    whole: bool = False


CASES = [
    Case("tnv40", "tnv40", whole=True),
    Case("workshop", "workshop"),
    Case("stiff", "stiff"),
    Case("encoder 1 um", "tnv40", {"encoder_step_um": 1}),
    Case("encoder 5 um", "tnv40", {"encoder_step_um": 5}),
    Case("2 ms late, identified", "tnv40", {"drive_delay_s": 0.002}),
    Case("2 ms late, not identified", "tnv40", {"drive_delay_s": 0.002}, identified=False),
    Case("gain 3 % low, not identified", "tnv40", {"kp_1_s": 48.5}, identified=False),
    Case("gain 8 % high, not identified", "tnv40", {"kp_1_s": 54}, identified=False),
    Case("0.8 ms late, not identified", "tnv40", {"drive_delay_s": 0.0008}, identified=False),
    Case("inertia x 1.4, not identified", "tnv40", pins={"feedwright-plant.inertia": 1.4}),
    Case("inertia x 3, not identified", "tnv40", pins={"feedwright-plant.inertia": 3}),
    Case("workshop, delay 8 ms", "workshop", pins={"feedwright.delay": 0.008}),
    Case("workshop, delay 15 ms", "workshop", pins={"feedwright.delay": 0.015}),
    Case("correction 2000 mm/s2", "tnv40", pins={"feedwright.correction-acceleration": 2000}),
    Case("servo period 0.25 ms", "tnv40", periods={"servo_s": 0.00025, "mechanics_s": 0.00005}),
    Case("correction unlimited", "tnv40", pins={"feedwright.correction-acceleration": 0}),
]


def made(folder, command, case):
    """Block of the machine, and block of its model."""
    machine = case.base
    if case.changes or case.periods:
        machine = folder / "machine.toml"
        table = lambda name, values: f"\n[{name}]\n" + "".join(f"{key} = {value}\n" for key, value in values.items())
        tables = table("period", case.periods) + "".join(table(f"axis.{axis}", case.changes) for axis in "xyz")
        machine.write_text(f'base = "{case.base}"\nname = "swept"\ndescription = "{case.name}"\nsource = "a sweep"\n{tables}')
    known = machine if case.identified else case.base
    block, model, identified = folder / "machine.fwmodel", folder / "model.fwmodel", folder / "swept.model.toml"
    run = lambda *words: subprocess.run([command, "--quiet", *map(str, words)], check=True, stdout=subprocess.DEVNULL)
    run("block", machine, "--axes", 3, "--out", block)
    run("identify", "--machine", known, "--controller", "lqg-identified", "--axes", 3, "--out", identified)
    run("block", identified, "--out", model)
    return str(block), str(model)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="cases whose name begins so")
    parser.add_argument("--skip", type=int, default=0, help="so many cases at the beginning")
    args = parser.parse_args()
    missed = 0
    for case in CASES[args.skip:]:
        if not case.name.startswith(args.only):
            continue
        with tempfile.TemporaryDirectory(prefix="feedwright-sweep-") as name:
            folder = pathlib.Path(name)
            folder.chmod(0o755)
            print(f"\n{case.name}", flush=True)
            machine = made(folder, headless.FEEDWRIGHT, case)
            missed += measure.table(machine, case.pins, programs.programs(not case.whole), never_worse=not case.whole)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
