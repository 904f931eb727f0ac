#!/usr/bin/env python3
"""A gantry with a rotary axis in a real LinuxCNC: what passes through the component stays in step with the corrected joints.

    through.py --machine MACHINE.fwmodel[:MODEL.fwmodel]

The machine is X, Y, Z, a second motor of Y and A. Both motors of Y home on switches of their own. Every servo period is checked to the bit. Exit
code 1 where something is out of step.
"""
import argparse
import pathlib
import sys
import tempfile

import headless
import recordings

JOINT = """
[JOINT_{n}]
TYPE = {kind}
MAX_VELOCITY = 200
MAX_ACCELERATION = 2000
MIN_LIMIT = -400
MAX_LIMIT = 400
FERROR = 10
MIN_FERROR = 3
HOME = 0
HOME_OFFSET = 0
HOME_SEARCH_VEL = {search}
HOME_LATCH_VEL = {latch}
HOME_SEQUENCE = {sequence}
"""
AXIS_A = "\n[AXIS_A]\nMAX_VELOCITY = 200\nMAX_ACCELERATION = 2000\nMIN_LIMIT = -400\nMAX_LIMIT = 400\n"
# Where the switches of both motors of Y are, mm.
SWITCHES_MM = (3.0, 3.4)
# Drives that are where their commands are.
HAL = """unlinkp feedwright.through-actual-0
unlinkp feedwright.through-actual-1
net y2-drive => feedwright.through-actual-0
net a-drive => feedwright.through-actual-1
loadrt comp names=y-switch,y2-switch
addf y-switch servo-thread
addf y2-switch servo-thread
setp y-switch.in0 {}
setp y2-switch.in0 {}
net y-actual => y-switch.in1
net y2-drive => y2-switch.in1
net y-home y-switch.out => joint.1.home-sw-in
net y2-home y2-switch.out => joint.3.home-sw-in
""".format(*SWITCHES_MM)
PROGRAM = """G21 G17 G90 G94 G64 P0.01
G0 X0 Y0 A0
G4 P0.3
M67 E0 Q0.25
G1 X20 Y10 A90 F3000
M67 E0 Q0.75
G2 X20 Y10 I10 J0 A180
G1 A45 F6000
G4 P0.2
M67 E0 Q0.5
G1 Y0 A0 F3000
G4 P0.2
M2
"""
# The correction is in the same servo period as the drive's command: what is left is rounding, mm.
ROUNDING_MM = 1e-9


def gantry(folder):
    """Makes the configuration one of five joints."""
    ini = folder / "workshop-sim.ini"
    text = headless.changed(ini.read_text(), {
        "KINS": {"KINEMATICS": "trivkins coordinates=XYZYA kinstype=BOTH", "JOINTS": 5}, "TRAJ": {"COORDINATES": "X Y Z Y A"},
        "JOINT_1": {"HOME_SEARCH_VEL": 20, "HOME_LATCH_VEL": 2, "HOME_SEQUENCE": -1}})
    text += JOINT.format(n=3, kind="LINEAR", search=20, latch=2, sequence=-1) + JOINT.format(n=4, kind="ANGULAR", search=0, latch=0, sequence=0) + AXIS_A
    ini.write_text(text.replace("HALFILE = feedwright.hal\n", "HALFILE = feedwright.hal\nHALFILE = through.hal\n"))
    hal = folder / "workshop-sim.hal"
    hal.write_text(hal.read_text().replace("joints=[KINS]JOINTS max", "joints=3 through=2 tandem=1,-1 signals=1 max").replace(
        "[FEEDWRIGHT]MACHINE joints=[KINS]JOINTS", "[FEEDWRIGHT]MACHINE joints=3"))


def cut(machine, model, params):
    """A recording of the program, to the bit, and what the run came to."""
    with tempfile.TemporaryDirectory(prefix="feedwright-through-") as name:
        ini = {"FEEDWRIGHT": {"MACHINE": machine, "MODEL": model, "RECORD": 60, "RECORDING": "recording.fwreplay"}}
        run = headless.run("cut", {"program": PROGRAM, "params": params}, ini, HAL, keep=name, change=gantry)
        return recordings.read(pathlib.Path(name) / "recording.fwreplay"), run


def check(periods, run):
    """What is out of step, in words, and how far the motors of Y are apart, mm."""
    wrong, late = [], 0
    for n, period in enumerate(periods):
        if period.state == 0:
            wrong += [] if period.through_drive[:2] == period.through_actual[:2] else [f"{n}: without power a drive is not where it is"]
            continue
        due = periods[n - period.delay]
        late += period.delay > 0
        # Rotary axis and signal to the bit; the linear axes but for the rounding of the correction.
        if (period.through_drive[1], period.through_drive[2]) != (due.through[1], due.through[2]):
            wrong.append(f"{n}: {period.through_drive[1:3]} is not the command of {period.delay} servo periods before")
        axes = [drive - offset - command - of_joint for drive, offset, command, of_joint in zip(period.drive, period.correction, due.command, due.geometry)]
        if max(map(abs, axes)) > ROUNDING_MM:
            wrong.append(f"{n}: a linear axis is not as late as the rotary one: {axes}")
        tandem = period.through_drive[0] - due.through[0] - period.correction[1] - due.geometry[1]
        if abs(tandem) > ROUNDING_MM:
            wrong.append(f"{n}: the second motor of Y does not get its correction: off by {tandem}")
    moved = [max(period.through[1] for period in periods), max(period.through[2] for period in periods)]
    if late < 1000 or moved[0] < 170 or moved[1] != 0.75:
        wrong.append(f"there is nothing to see: {late} servo periods with a delay, at most {moved}")
    # Each motor has its own home: between the two lies what their switches are apart, whatever the correction.
    apart = {round(period.through_drive[0] - period.drive[1], 9) for period in periods[-2000:] if period.state > 0}
    if len(apart) != 1:
        wrong.append(f"the motors of Y went apart: {sorted(apart)}")
    wrong += [f"LinuxCNC: {message}" for message in run.result["messages"]]
    wrong += [f"fault {period.fault}" for period in periods if period.fault][:1]
    return wrong, late, apart


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--machine", required=True, help="MACHINE.fwmodel[:MODEL.fwmodel]")
    files = [str(pathlib.Path(file).resolve()) for file in parser.parse_args().machine.split(":")]
    failed = 0
    for name, params in (("corrected", {}), ("uncorrected", {"feedwright.enable": 0}), ("15 ms", {"feedwright.delay": 0.015}), ("direct", {"feedwright.direct": 1})):
        periods, run = cut(files[0], files[-1], params)
        wrong, late, apart = check(periods, run)
        if name == "direct":
            wrong = [text for text in wrong if "nothing to see" not in text] + (["it is delayed"] if late else [])
        largest = 1e3 * max(abs(period.correction[1]) for period in periods)
        failed += bool(wrong)
        print(f"{name:12} {len(periods)} servo periods, {late} with a delay, correction of Y up to {largest:.0f} um, motors of Y apart {max(apart):.6f} mm: "
              f"{'in step' if not wrong else f'{len(wrong)} WRONG: ' + '; '.join(wrong[:3])}", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
