#!/usr/bin/python3
"""Hardware that setup does not know stays untouched in a copy that `feedwright linuxcnc setup --simulate` writes.

    untouched.py [CASE...]

A driver that counts in every servo period how often its inputs change is compiled and installed for this test. It takes the commands and enables
of four configurations: directly, behind arithmetic with an inverted enable, beside a command that is its own feedback, and behind a pid. The
original moves the driver; that shows that it counts. In the copy the simulated machine moves as far, and the inputs of the driver never change.
Exit code 1 where they do, or where the simulated machine does not move.
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import headless

MODULES = pathlib.Path("/usr/lib/linuxcnc/modules")
DRIVE = "feedwright_unknown"
SOURCE = f"""component {DRIVE} "Counts how often its inputs change";
pin in float position_cmd; pin in float speed; pin in bit enable; pin in bit disable; pin in bit relay;
pin out float position_fb; pin out u32 changes;
variable int runs; variable double floats[2]; variable int bits[3];
function _;
license "MIT";
;;
FUNCTION(_) {{
    if (runs && (position_cmd != floats[0] || speed != floats[1] || enable != bits[0] || disable != bits[1] || relay != bits[2])) changes++;
    runs = 1;
    floats[0] = position_cmd; floats[1] = speed; bits[0] = enable; bits[1] = disable; bits[2] = relay;
    position_fb = position_cmd;
}}
"""
HEAD = f"""loadrt [KINS]KINEMATICS
loadrt [EMCMOT]EMCMOT servo_period_nsec=[EMCMOT]SERVO_PERIOD num_joints=[KINS]JOINTS
loadrt {DRIVE} count=3
addf motion-command-handler servo-thread
addf motion-controller servo-thread
net estop-loop iocontrol.0.user-enable-out => iocontrol.0.emc-enable-in
"""
# For each joint: @ is its number, D its driver.
DIRECT = """net cmd@ joint.@.motor-pos-cmd => D.position-cmd
net fb@ D.position-fb => joint.@.motor-pos-fb
net en@ joint.@.amp-enable-out => D.enable
"""
ARITHMETIC = """net cmd@ joint.@.motor-pos-cmd => scale.@.in
net scaled@ scale.@.out => mux2.@.in0
net set@ mux2.@.out => D.position-cmd D.speed
net raw@ D.position-fb => sum2.@.in0
net fb@ sum2.@.out => joint.@.motor-pos-fb
net en@ joint.@.amp-enable-out => and2.@.in0
setp and2.@.in1 1
net off@ and2.@.out => not.@.in
net disable@ not.@.out => D.disable
setp scale.@.gain 1
addf scale.@ servo-thread
addf mux2.@ servo-thread
addf and2.@ servo-thread
addf not.@ servo-thread
"""
LOOPBACK = """newsig cmd@ float
linksp cmd@ <= joint.@.motor-pos-cmd
linksp cmd@ => joint.@.motor-pos-fb
linksp cmd@ => D.position-cmd
net speed@ joint.@.vel-cmd => D.speed
"""
PID = """net cmd@ joint.@.motor-pos-cmd => pid.@.command D.position-cmd
net fb@ D.position-fb => pid.@.feedback joint.@.motor-pos-fb
net out@ pid.@.output => D.speed
net en@ joint.@.amp-enable-out => pid.@.enable D.enable
setp pid.@.Pgain 20
setp pid.@.FF1 1
addf pid.@.do-pid-calcs servo-thread
"""
CASES = {
    "direct": ("", DIRECT, ""),
    "arithmetic": ("".join(f"loadrt {name} count=3\n" for name in ("scale", "mux2", "sum2", "and2", "not")), ARITHMETIC,
                   "".join(f"addf sum2.{i} servo-thread\n" for i in range(3))),
    "loopback": ("", LOOPBACK, "loadrt charge_pump\naddf charge-pump servo-thread\nnet pump charge-pump.out => D.relay\n"
                               "net m3 spindle.0.on => D1.relay\nnet ready motion.motion-enabled => D2.relay\n"),
    "pid": ("loadrt pid num_chan=3\n", PID, ""),
}
TARGET_MM = (20, -10, 5)


def ini():
    """A mill with three linear joints that are homed where they stand."""
    text = f"""[EMC]
VERSION = 1.1
MACHINE = untouched
[DISPLAY]
DISPLAY = {pathlib.Path(__file__).resolve()}
CYCLE_TIME = 0.05
[TASK]
TASK = milltask
CYCLE_TIME = 0.001
[RS274NGC]
PARAMETER_FILE = m.var
[EMCMOT]
EMCMOT = motmod
SERVO_PERIOD = 1000000
[EMCIO]
EMCIO = io
CYCLE_TIME = 0.1
[HAL]
HALFILE = m.hal
[TRAJ]
COORDINATES = XYZ
LINEAR_UNITS = mm
ANGULAR_UNITS = degree
MAX_LINEAR_VELOCITY = 100
DEFAULT_LINEAR_VELOCITY = 50
[KINS]
JOINTS = 3
KINEMATICS = trivkins coordinates=XYZ
"""
    limits = "MAX_VELOCITY = 60\nMAX_ACCELERATION = 400\nMIN_LIMIT = -200\nMAX_LIMIT = 200\n"
    for number, letter in enumerate("XYZ"):
        text += f"[AXIS_{letter}]\n{limits}[JOINT_{number}]\nTYPE = LINEAR\n{limits}FERROR = 0.5\nMIN_FERROR = 0.1\nHOME = 0\nHOME_SEQUENCE = 0\n"
    return text


def drive(number):
    return f"{DRIVE.replace('_', '-')}.{number}"


def hal(case):
    """The HAL file of a case."""
    loads, joint, rest = CASES[case]
    joints = "".join(joint.replace("@", str(i)).replace("D.", drive(i) + ".") for i in range(3))
    named = rest.replace("D1.", drive(1) + ".").replace("D2.", drive(2) + ".").replace("D.", drive(0) + ".")
    return HEAD + loads + joints + named + "".join(f"addf {drive(i)} servo-thread\n" for i in range(3))


def moved(folder, name, environment):
    """Runs a configuration: what the screen read at the end."""
    result = folder / "result.json"
    result.unlink(missing_ok=True)
    subprocess.run(["chmod", "-R", "a+rwX", folder], check=True)
    done = subprocess.run(["linuxcnc", "-r", name], cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, timeout=120, check=False)
    if not result.exists():
        raise headless.Failed(f"{name}: LinuxCNC ended with {done.returncode}\n{done.stdout[-4000:]}")
    return json.loads(result.read_text())


def tried(case):
    """Whether the driver of a case is moved by the original, and untouched by the copy."""
    with tempfile.TemporaryDirectory(prefix="feedwright-untouched-") as name:
        folder = pathlib.Path(name)
        (folder / "m.ini").write_text(ini())
        (folder / "m.hal").write_text(hal(case))
        (folder / "home").mkdir()
        environment = dict(os.environ, HOME=str(folder / "home"), FEEDWRIGHT_FOLDER=name)
        environment.pop("DISPLAY", None)
        if os.getuid() == 0:
            environment["RTAPI_UID"] = "65534"
        setup = [headless.FEEDWRIGHT, "linuxcnc", "setup", "m.ini", "--simulate", "tnv40", "--raise-ferror", "5"]
        subprocess.run(setup, cwd=folder, env=environment, check=True, stdout=subprocess.DEVNULL)
        original = moved(folder, "m.ini", environment)
        copy = moved(folder, "m-feedwright.ini", environment)
        print(f"{case}: inputs of the driver changed {original['changes']} times in the original, {copy['changes']} in the copy; "
              f"not zero there: {[pin for pin, value in copy['inputs'] if value]}; the simulated machine is at {copy['tool']} mm; "
              f"messages: {original['messages']} and {copy['messages']}", flush=True)
        there = all(abs(at - target) < 0.1 for at, target in zip(copy["tool"], TARGET_MM))
        off = all(value == (1.0 if pin == "disable" and case == "arithmetic" else 0.0) for pin, value in copy["inputs"])
        return min(original["changes"]) > 100 and max(copy["changes"]) == 0 and there and off


def main():
    with tempfile.TemporaryDirectory() as name:
        (pathlib.Path(name) / f"{DRIVE}.comp").write_text(SOURCE)
        subprocess.run(["halcompile", "--install", f"{DRIVE}.comp"], cwd=name, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        failed = [case for case in sys.argv[1:] or CASES if not tried(case)]
    finally:
        (MODULES / f"{DRIVE}.so").unlink()
    print(f"failed: {failed}")
    return 1 if failed else 0


def screen():
    """In place of a screen: switches on, homes, moves, and reads the driver."""
    import linuxcnc
    folder = pathlib.Path(os.environ["FEEDWRIGHT_FOLDER"])
    machine = headless.Machine(linuxcnc, folder)
    end = time.monotonic() + headless.STARTS_S
    while True:
        try:
            machine.poll()
            break
        except linuxcnc.error:
            if time.monotonic() > end:
                raise
            time.sleep(0.05)
    machine.on()
    machine.home(60)
    machine.mdi("G21 G90 G1 F2000 X{} Y{} Z{} M3 S100".format(*TARGET_MM))
    machine.wait(0.5)
    value = lambda pin: machine.hal("getp", pin)
    number = lambda pin: {"TRUE": 1.0, "FALSE": 0.0}.get(value(pin)) if value(pin) in ("TRUE", "FALSE") else float(value(pin))
    inputs = [(pin, number(f"{drive(i)}.{pin}")) for i in range(3) for pin in ("position-cmd", "speed", "enable", "disable", "relay")]
    simulated = "feedwright-plant" in machine.hal("list", "funct")
    tool = [number(f"feedwright-plant.tool-{i}") for i in range(3)] if simulated else []
    result = {"changes": [int(value(f"{drive(i)}.changes")) for i in range(3)], "inputs": inputs, "tool": tool, "messages": machine.messages}
    (folder / "result.json").write_text(json.dumps(result))


if __name__ == "__main__":
    if "FEEDWRIGHT_FOLDER" in os.environ:
        screen()
    else:
        sys.exit(main())
