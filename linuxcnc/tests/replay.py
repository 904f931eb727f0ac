#!/usr/bin/env python3
"""A cut in a real LinuxCNC is recorded in the servo thread, and computed again by feedwright-replay: the same to the last bit.

    replay.py --machine MACHINE.fwmodel[:MODEL.fwmodel]
"""
import argparse
import pathlib
import subprocess
import sys
import tempfile

import headless
import programs

# Smaller recordings than this hold no cut, servo periods.
LEAST_PERIODS = 2000
# As of feedwright.h: 27 numbers and the flags; 29 numbers, ten whole ones.
INPUT_BYTES, PERIOD_BYTES = 224, 496


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--machine", required=True, help="MACHINE.fwmodel[:MODEL.fwmodel]")
    args = parser.parse_args()
    files = [str(pathlib.Path(file).resolve()) for file in args.machine.split(":")]
    with tempfile.TemporaryDirectory(prefix="feedwright-replay-") as folder:
        ini = {"FEEDWRIGHT": {"MACHINE": files[0], "MODEL": files[-1], "RECORD": 20, "RECORDING": "recording.fwreplay"}}
        headless.run("cut", {"program": programs.part("square", "G61")}, ini, keep=folder)
        recording = pathlib.Path(folder) / "recording.fwreplay"
        again = subprocess.run(["feedwright-replay", recording], capture_output=True, text=True, check=False)
        print(again.stdout, end="")
        periods = int(again.stdout.split()[0]) if again.returncode == 0 else 0
        if periods < LEAST_PERIODS:
            print(f"not replayed: {again.stderr or again.stdout}", file=sys.stderr)
            return 1
        # One bit of one drive's command is found.
        content = bytearray(recording.read_bytes())
        content[-PERIOD_BYTES * (periods // 2) + INPUT_BYTES] ^= 1
        recording.write_bytes(content)
        if subprocess.run(["feedwright-replay", recording], capture_output=True, check=False).returncode != 1:
            print("a recording that was changed replays as one that was not", file=sys.stderr)
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
