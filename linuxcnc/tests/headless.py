#!/usr/bin/python3
"""LinuxCNC without a screen, on the simulated machine: one scenario, every servo period recorded.

    run(scenario, settings) -> Recording

starts LinuxCNC in a folder of its own with the configuration of ../configs/workshop-sim and this file in place of a screen, which then runs
the function of that name in scenarios.py. HAL's shared memory is one for the whole machine, so one run goes on at a time.
"""
import dataclasses
import fcntl
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
CONFIG = HERE.parent / "configs" / "workshop-sim"
# What is sampled in each servo period: HAL pin, letter of its type. A sampler takes 21 at most.
SAMPLED = [
    *((f"joint.{i}.motor-pos-cmd", "f") for i in range(3)),
    *((f"feedwright-plant.tool-{i}", "f") for i in range(3)),
    *((f"feedwright.drive-{i}", "f") for i in range(3)),
    *((f"feedwright.feedback-{i}", "f") for i in range(3)),
    *((f"feedwright.correction-{i}", "f") for i in range(3)),
    ("feedwright.contour-error", "f"),
    ("feedwright.state", "u"),
    ("feedwright.cause", "u"),
    ("feedwright.fault", "b"),
    ("feedwright.tick-time", "s"),
    ("motion.motion-type", "s"),
]
# The signals that the configuration already has on some of them.
SIGNALS = {"joint.0.motor-pos-cmd": "x-command", "joint.1.motor-pos-cmd": "y-command", "joint.2.motor-pos-cmd": "z-command",
           "feedwright.drive-0": "x-drive", "feedwright.drive-1": "y-drive", "feedwright.drive-2": "z-drive",
           "feedwright.feedback-0": "x-feedback", "feedwright.feedback-1": "y-feedback", "feedwright.feedback-2": "z-feedback",
           "motion.motion-type": "motion-type"}
# A touch probe that meets a plane at -10 mm of the tool's Z.
PROBE = """loadrt comp names=probed
addf probed servo-thread
setp probed.in1 -10
setp probed.hyst 0
net sampled-5 => probed.in0
net probe-input probed.out => motion.probe-input
"""
STARTS_S, ENDS_S = 40, 20
# The command that makes models and reads programs.
FEEDWRIGHT = os.environ.get("FEEDWRIGHT", "feedwright")


@dataclasses.dataclass
class Row:
    """A servo period: positions in mm."""
    command: tuple
    tool: tuple
    drive: tuple
    feedback: tuple
    correction: tuple
    contour_error: float
    state: int
    cause: int
    fault: bool
    tick_ns: int
    motion_type: int


@dataclasses.dataclass
class Recording:
    """What a scenario came to."""
    rows: list
    result: dict
    log: str


class Failed(Exception):
    """LinuxCNC or the scenario did not come to its end."""


# The simulated drives have no limit.
UNLIMITED = 0


def run(scenario, settings=None, ini=None, hal="", limit_s=270, keep=None, change=None):
    """Runs a scenario of scenarios.py. `settings` go to it; `ini` are values of the INI file, as {"SECTION": {"KEY": value}}, and `hal` are
    lines of HAL beside those of the configuration; `change` gets the folder of the configuration before LinuxCNC starts. Recordings
    go to the folder `keep`."""
    with tempfile.TemporaryDirectory(prefix="feedwright-") as name, open("/tmp/feedwright-linuxcnc.lock", "w") as lock:
        folder = pathlib.Path(name)
        for file in CONFIG.iterdir():
            if file.is_file():
                shutil.copy(file, folder)
        home = folder / "home"
        home.mkdir()
        text = (folder / "workshop-sim.ini").read_text()
        changes = {"DISPLAY": {"DISPLAY": str(pathlib.Path(__file__).resolve()), "CYCLE_TIME": 0.05, "INTRO_GRAPHIC": ""},
                   "FEEDWRIGHT": {"ACCELERATION_LIMIT": UNLIMITED}}
        for section, values in (ini or {}).items():
            changes.setdefault(section, {}).update(values)
        text = changed(text, changes)
        text = text.replace("HALFILE = feedwright.hal\n", "HALFILE = feedwright.hal\nHALFILE = sampled.hal\n")
        (folder / "workshop-sim.ini").write_text(text)
        (folder / "sampled.hal").write_text(sampled_hal() + hal)
        if change:
            change(folder)
        environment = dict(os.environ, HOME=str(home), FEEDWRIGHT_SCENARIO=scenario, FEEDWRIGHT_FOLDER=name,
                           FEEDWRIGHT_SETTINGS=json.dumps(settings or {}), FEEDWRIGHT_LIMIT_S=str(limit_s))
        environment.pop("DISPLAY", None)
        if os.getuid() == 0:
            environment["RTAPI_UID"] = "65534"
            os.chmod(folder, 0o777)
            os.chmod(home, 0o777)
        fcntl.flock(lock, fcntl.LOCK_EX)
        try:
            done = subprocess.run(["linuxcnc", "-r", "workshop-sim.ini"], cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=limit_s + STARTS_S + ENDS_S,
                                  close_fds=True)
        except subprocess.TimeoutExpired as expired:
            raise Failed(f"{scenario}: LinuxCNC did not end\n{expired.stdout}") from expired
        result = folder / "result.json"
        if done.returncode != 0 or not result.exists():
            raise Failed(f"{scenario}: LinuxCNC ended with {done.returncode}\n{done.stdout[-4000:]}")
        if keep:
            for file in (*folder.glob("*.fwreplay"), *folder.glob("samples-*.txt")):
                shutil.copy(file, keep)
        return Recording(rows(folder / "samples.txt"), json.loads(result.read_text()), done.stdout)


def changed(ini, changes):
    """The text of an INI file with other values."""
    lines, section = [], None
    for line in ini.splitlines():
        named = re.fullmatch(r"\[(\w+)\]", line)
        section = named[1] if named else section
        key = line.split("=")[0].strip()
        if "=" in line and not line.startswith("#") and key in changes.get(section, {}):
            line = f"{key} = {changes[section][key]}"
        lines.append(line)
    return "\n".join(lines) + "\n"


def sampled_hal():
    letters = "".join(letter for _, letter in SAMPLED)
    lines = [f"loadrt sampler depth=20000 cfg={letters}", "addf sampler.0 servo-thread", "setp sampler.0.enable 0"]
    for i, (pin, _) in enumerate(SAMPLED):
        signal = SIGNALS.get(pin)
        lines.append(f"net {signal} => sampler.0.pin.{i}" if signal else f"net sampled-{i} {pin} => sampler.0.pin.{i}")
    return "\n".join(lines) + "\n"


def rows(file):
    found, last = [], None
    for line in file.read_text().splitlines() if file.exists() else []:
        words = line.split()
        # halsampler says so of the first sample, where an earlier one has read those before.
        if last is None and words == ["overrun"]:
            continue
        if len(words) != len(SAMPLED) + 1:
            raise Failed(f"a sample was lost: {line}")
        if last is not None and int(words[0]) != last + 1:
            raise Failed(f"samples between {last} and {words[0]} were lost")
        last = int(words[0])
        f = [float(word) for word in words[1:17]]
        vectors = [tuple(f[i:i + 3]) for i in range(0, 15, 3)]
        found.append(Row(*vectors, f[15], int(words[17]), int(words[18]), words[19] == "1", int(words[20]), int(words[21])))
    return found


class Machine:
    """LinuxCNC, as a scenario sees it."""

    def __init__(self, linuxcnc, folder):
        self.linuxcnc, self.folder = linuxcnc, folder
        self.command, self.status, self.errors = linuxcnc.command(), linuxcnc.stat(), linuxcnc.error_channel()
        self.messages, self.sampler, self.start = [], None, time.monotonic()

    def poll(self):
        self.status.poll()
        while message := self.errors.poll():
            self.messages.append(message[1].strip())
            print(f"[scenario {time.monotonic() - self.start:7.3f}] message: {message[1].strip()}", file=sys.stderr, flush=True)

    def until(self, what, is_so, limit_s=10.0):
        begun = time.monotonic()
        while True:
            self.poll()
            if is_so():
                return
            if time.monotonic() - begun > limit_s:
                raise Failed(f"{what} has not come within {limit_s} s; messages: {self.messages}")
            time.sleep(0.002)

    def wait(self, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.poll()
            time.sleep(0.005)

    @staticmethod
    def hal(*words):
        done = subprocess.run(["halcmd", *map(str, words)], capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise Failed(f"halcmd {' '.join(map(str, words))}: {done.stderr}")
        return done.stdout.strip()

    def on(self):
        self.command.state(self.linuxcnc.STATE_ESTOP_RESET)
        self.command.wait_complete(5)
        self.command.state(self.linuxcnc.STATE_ON)
        self.until("machine on", lambda: self.status.task_state == self.linuxcnc.STATE_ON)

    def home(self, limit_s=30):
        self.mode(self.linuxcnc.MODE_MANUAL)
        self.command.teleop_enable(0)
        self.command.wait_complete(5)
        self.command.home(-1)
        self.until("homed", lambda: all(self.status.homed[:self.status.joints]), limit_s)

    def mode(self, mode):
        self.command.mode(mode)
        self.command.wait_complete(5)
        self.until("mode", lambda: self.status.task_mode == mode)

    def mdi(self, line, limit_s=30):
        self.mode(self.linuxcnc.MODE_MDI)
        self.command.mdi(line)
        self.command.wait_complete(limit_s)
        self.until(line, self.is_idle, limit_s)

    def is_idle(self):
        s = self.status
        return s.interp_state == self.linuxcnc.INTERP_IDLE and s.exec_state == self.linuxcnc.EXEC_DONE and s.inpos and s.queue == 0

    def open(self, text):
        file = self.folder / "program.ngc"
        file.write_text(text)
        self.mode(self.linuxcnc.MODE_AUTO)
        self.command.program_open(str(file))
        self.command.wait_complete(5)

    def begin(self):
        """Begins the program; recording has to be on."""
        self.command.auto(self.linuxcnc.AUTO_RUN, 0)
        self.until("running", lambda: self.status.interp_state != self.linuxcnc.INTERP_IDLE, 5)

    def finish(self, limit_s=100):
        self.until("end of the program", self.is_idle, limit_s)
        self.wait(0.15)

    def record(self, file="samples.txt"):
        self.sampler = subprocess.Popen(["halsampler", "-t", str(self.folder / file)])
        time.sleep(0.1)
        self.hal("setp", "sampler.0.enable", 1)

    def end_record(self):
        self.hal("setp", "sampler.0.enable", 0)
        self.until("samples", lambda: int(self.hal("getp", "sampler.0.curr-depth")) == 0)
        time.sleep(0.1)
        self.sampler.terminate()
        self.sampler.wait()
        overruns = int(self.hal("getp", "sampler.0.overruns"))
        if overruns:
            raise Failed(f"{overruns} samples were lost")


def main():
    """In place of a screen."""
    import linuxcnc
    import scenarios
    folder = pathlib.Path(os.environ["FEEDWRIGHT_FOLDER"])
    machine = Machine(linuxcnc, folder)
    deadline = time.monotonic() + STARTS_S
    while True:
        try:
            machine.poll()
            break
        except linuxcnc.error:
            if time.monotonic() > deadline:
                raise
            time.sleep(0.05)
    settings = json.loads(os.environ["FEEDWRIGHT_SETTINGS"])
    result = getattr(scenarios, os.environ["FEEDWRIGHT_SCENARIO"])(machine, **settings) or {}
    if machine.sampler and machine.sampler.returncode is None:
        machine.end_record()
    for pin in ("tick-max", "faults", "cause", "heartbeat"):
        result[pin] = machine.hal("getp", f"feedwright.{pin}")
    result["messages"] = machine.messages
    (folder / "result.json").write_text(json.dumps(result))


if __name__ == "__main__":
    sys.path.insert(0, str(HERE))
    main()
