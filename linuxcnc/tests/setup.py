#!/usr/bin/python3
"""From Debian's sample configuration sim/axis to a corrected cut, by the commands that `feedwright linuxcnc setup` prints and nothing else.

    setup.py [--ini axis.ini] [--known] [--transcript FILE]

--ini names another sample of that folder, such as gantry/gantry_mm.ini. With --known the model is made of the simulated machine itself: nothing is
recorded and identified. After a cut within ACCELERATION_LIMIT, as setup writes it, comes one without that limit: the simulated drives have none. The configuration is copied to a folder of its own, and its screen is
this file: it homes the machine and runs a program when it is asked to, in place of somebody at AXIS. The simulated machine tnv40 stands in for the
drives. Prints commands and their output. Exit code 1 where the first corrected cut is no better than the uncorrected
one, the second does not come below 0.15 of it, a second motor is not with the first, or the folder is not as before after --undo.
"""
import argparse
import hashlib
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time

import headless

SAMPLES = pathlib.Path("/usr/share/doc/linuxcnc/examples/sample-configs/sim/axis")
PART = "G21 G17 G90 G94 G64 P0.001 Q0\nG0 X0 Y0\nG0 X20 Y10\nG4 P0.3\nG2 X20 Y10 I-10 J0 F3000\nG1 X30 Y20\nG1 X10 Y30\nG1 X0 Y10\nG1 X20 Y10\nG4 P0.2\nG0 X0 Y0\nM2\n"
FACTOR = 0.15
ROOM = "halcmd setp feedwright.acceleration-limit 0"
TANDEM_MM = 12
LIMIT_S = 400


class Walk:
    """A user in a folder: types commands, and reads what they print."""

    def __init__(self, folder, transcript):
        self.folder, self.transcript, self.machine = folder, transcript, None
        self.environment = dict(os.environ, FEEDWRIGHT_FOLDER=str(folder), HOME=str(folder / "home"), COLUMNS="100", NO_COLOR="1")
        self.environment["PATH"] = f"{folder}/bin:" + self.environment["PATH"]
        self.environment.pop("DISPLAY", None)
        if os.getuid() == 0:
            self.environment["RTAPI_UID"] = "65534"

    def tell(self, text):
        # The folder of this run is of no interest.
        text = text.replace(str(self.folder), "~/linuxcnc/configs/axis")
        self.transcript.append(text)
        print(text, flush=True)

    def open_all(self):
        """LinuxCNC gives up its rights and writes here, too."""
        subprocess.run(["chmod", "-R", "a+rwX", self.folder], check=True)

    def type(self, command, codes=(0,)):
        self.tell(f"$ {command}")
        done = subprocess.run(command, shell=True, cwd=self.folder, env=self.environment, capture_output=True, text=True, check=False)
        self.tell((done.stdout + done.stderr).rstrip())
        self.open_all()
        if done.returncode not in codes:
            raise headless.Failed(f"{command}: {done.returncode}")
        return done.stdout

    def start(self, command):
        """Starts LinuxCNC, and waits until it is homed."""
        self.open_all()
        (self.folder / "ready").unlink(missing_ok=True)
        self.tell(f"$ {command}")
        self.log = open(self.folder / "linuxcnc.log", "w+", encoding="utf-8")
        self.machine = subprocess.Popen(shlex.split(command.replace("linuxcnc ", "linuxcnc -r ", 1)), cwd=self.folder, env=self.environment,
                                        stdin=subprocess.DEVNULL, stdout=self.log, stderr=subprocess.STDOUT)
        self.wait_for("ready", 90)

    def wait_for(self, name, limit_s):
        end = time.monotonic() + limit_s
        while not (self.folder / name).exists():
            if time.monotonic() > end or self.machine.poll() is not None:
                raise headless.Failed(f"{name} has not come\n{self.printed()[-4000:]}")
            time.sleep(0.05)

    def printed(self):
        self.log.flush()
        return (self.folder / "linuxcnc.log").read_text(encoding="utf-8")

    def ask(self, request):
        """Lets the screen do something, and waits until it is done."""
        (self.folder / "done").unlink(missing_ok=True)
        (self.folder / "request.new").write_text(request)
        (self.folder / "request.new").rename(self.folder / "request")
        self.wait_for("done", LIMIT_S)
        error = (self.folder / "done").read_text()
        if error:
            raise headless.Failed(f"{request}: {error}")

    def record(self, command, program):
        """Records while a program runs."""
        self.tell(f"$ {command}")
        recorder = subprocess.Popen(command, shell=True, cwd=self.folder, env=self.environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                    stderr=subprocess.STDOUT, text=True)
        time.sleep(1)
        self.ask(f"run {program}")
        out, _ = recorder.communicate("\n", timeout=60)
        self.tell(out.rstrip())
        self.open_all()
        if recorder.returncode:
            raise headless.Failed(f"{command}: {recorder.returncode}")

    def end(self):
        self.ask("quit")
        self.machine.wait(60)
        told = [line for line in self.printed().splitlines() if line.startswith("feedwright")]
        self.tell("\n".join(told))


def digest(folder):
    files = sorted(path for path in folder.iterdir() if path.is_file())
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def is_inch(text):
    """Whether lengths of an INI file are in inches."""
    return re.search(r"^LINEAR_UNITS *= *inch", text, re.MULTILINE) is not None


def middle(text):
    """Motion to the middle of the travel."""
    unit = "G20" if is_inch(text) else "G21"
    words = []
    for letter in "XYZ":
        section = text.split(f"[AXIS_{letter}]")[1].split("[")[0]
        low, high = (float(re.search(rf"^{key} *= *(\S+)", section, re.MULTILINE)[1]) for key in ("MIN_LIMIT", "MAX_LIMIT"))
        words.append(f"{letter}{(low + high) / 2:.4f}")
    return " ".join([unit, "G90 G53 G0", *words])


def sample(ini, folder):
    """A copy of the sample, without the parts that need a screen."""
    for file in (SAMPLES / ini).parent.iterdir():
        if file.is_file() and not file.is_symlink():
            shutil.copy(file, folder)
    ini = pathlib.Path(ini).name
    text = (folder / ini).read_text()
    text = headless.changed(text, {"DISPLAY": {"DISPLAY": str(pathlib.Path(__file__).resolve()), "INTRO_GRAPHIC": ""}})
    text = text.replace("HALFILE = axis_manualtoolchange.hal\n", "").replace("TASK = milltask\n", "TASK = milltask\n")
    (folder / ini).write_text(text)
    (folder / "home").mkdir()
    (folder / "bin").mkdir()
    (folder / "bin" / "feedwright").symlink_to(shutil.which(headless.FEEDWRIGHT))


def walk(ini, known, transcript):
    with tempfile.TemporaryDirectory(prefix="feedwright-setup-") as name:
        folder = pathlib.Path(name)
        sample(ini, folder)
        (folder / "part.ngc").write_text(PART)
        before = digest(folder)
        user = Walk(folder, transcript)
        try:
            return walked(pathlib.Path(ini).name, known, folder, before, user)
        except BaseException:
            if user.machine and user.machine.poll() is None:
                print(user.printed()[-6000:])
                (folder / "request").write_text("quit")
                user.machine.wait(60)
            raise


def walked(ini, known, folder, before, user):
    """The steps, in a folder that is ready."""
    user.type(f"feedwright linuxcnc setup {ini}", codes=(1,))
    # What tnv40 needs, by what setup prints without this option.
    ferror = 0.2 if is_inch((folder / ini).read_text()) else 5.1
    setup = f"feedwright linuxcnc setup {ini} --simulate tnv40 --raise-ferror {ferror}"
    printed = user.type(setup)
    commands = [line.strip() for line in printed.splitlines() if line.startswith("        ")]
    start, excite, direct, record_axes, indirect, identify, block, run, again, enable, limit, record_cut, compare, undo = commands
    if known:
        user.type("feedwright machines tnv40 --out mine.toml")
        user.type(block)
    else:
        user.start(start)
        user.type(excite)
        user.ask(f"mdi {middle((folder / ini).read_text())}")
        user.type(direct)
        user.record(record_axes, "excite.ngc")
        user.type(indirect)
        user.type(identify)
        user.type(block)
        user.type(run)
        user.end()
    user.start(again)
    user.record(record_cut, "part.ngc")
    uncorrected = measured(user.type(compare, codes=(0, 1)))
    user.type(enable)
    user.type(limit)
    user.record(record_cut, "part.ngc")
    within = measured(user.type(compare, codes=(0, 1)))
    user.type(ROOM)
    user.record(record_cut, "part.ngc")
    corrected = measured(user.type(compare, codes=(0, 1)))
    for pin in ("state", "cause", "faults"):
        user.type(f"halcmd getp feedwright.{pin}")
    second = "tandem=" not in hal_of(folder) or is_in_tandem(user)
    user.end()
    user.type(undo)
    after = digest(folder)
    kept = all(after.get(file) == sum for file, sum in before.items())
    left = [file for file in after if "-feedwright" in file and file not in before]
    user.tell(f"uncorrected {uncorrected} um, corrected {within} um, with room {corrected} um; second motor with the first: {second}; originals unchanged: {kept}; left behind: {left}")
    better = within < uncorrected and corrected < FACTOR * uncorrected
    return 0 if second and better and kept and left == [f"{pathlib.Path(ini).stem}-feedwright.fwmodel"] else 1


def hal_of(folder):
    """What the copies of the HAL files say."""
    return "".join(path.read_text() for path in folder.glob("*-feedwright*.hal"))


def is_in_tandem(user):
    """Whether the second motor of Y is sent where the first one is, away from home; through.py compares them in motion. The two pins are read
    one after the other, so that their corrections differ by some um."""
    user.ask(f"mdi G21 G90 G0 X10 Y{TANDEM_MM}")
    motors = [float(user.type(f"halcmd getp feedwright.{pin}")) for pin in ("drive-1", "through-drive-0")]
    return all(abs(motor - TANDEM_MM) < 0.05 for motor in motors)


def measured(text):
    """RMS of the measured cut in the table of `feedwright run`, um."""
    row = re.search(r"^measured, not simulated +[\d.]+ +([\d.]+)", text, re.MULTILINE)
    if not row:
        raise headless.Failed("no measured cut in the table")
    return float(row[1])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ini", default="axis.ini")
    parser.add_argument("--known", action="store_true")
    parser.add_argument("--transcript", type=pathlib.Path)
    args = parser.parse_args()
    transcript = []
    try:
        return walk(args.ini, args.known, transcript)
    finally:
        if args.transcript:
            args.transcript.write_text("\n".join(transcript) + "\n")


def screen():
    """In place of a screen."""
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
    (folder / "ready").touch()
    while True:
        machine.poll()
        request = folder / "request"
        if not request.exists():
            time.sleep(0.02)
            continue
        what, _, rest = request.read_text().partition(" ")
        request.unlink()
        error = ""
        machine.messages.clear()
        try:
            if what == "mdi":
                machine.mdi(rest)
            elif what == "run":
                machine.open((folder / rest).read_text())
                machine.begin()
                # Between a dwell and the next motion everything rests, too.
                for _ in range(4):
                    machine.finish(LIMIT_S)
                    machine.wait(0.5)
        except headless.Failed as failed:
            error = str(failed)
        print(f"screen: {what} {rest}: {error} {machine.messages}", flush=True)
        (folder / "done.new").write_text(error or "; ".join(machine.messages))
        (folder / "done.new").rename(folder / "done")
        if what == "quit":
            return


if __name__ == "__main__":
    if "FEEDWRIGHT_FOLDER" in os.environ:
        screen()
    else:
        sys.exit(main())
