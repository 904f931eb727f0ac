"""What is done with LinuxCNC in a run: each function is one, and gets the machine of headless.py."""
import json
import random
import subprocess
import threading
import urllib.request


# A program may take so long, s.
LIMIT_S = 240


def cut(machine, program, enable=True, params=None, override=1.0):
    """A program from beginning to end."""
    machine.on()
    machine.home()
    machine.hal("setp", "feedwright.enable", int(enable))
    for pin, value in (params or {}).items():
        machine.hal("setp", pin, value)
    machine.command.feedrate(override)
    machine.command.set_optional_stop(False)
    machine.open(program)
    machine.record()
    machine.begin()
    machine.finish(LIMIT_S)


LONG = "G21 G17 G90 G94 G64 P0.01\nG0 X0 Y0\nG4 P0.3\n" + "G2 X0 Y0 I10 J0 F3000\n" * 3 + "G4 P0.2\nM2\n"


def in_mid_cut(machine, at_s, changes, again_s=None, restore=None, params=None, program=LONG, enable=1):
    """A program, in which pins are set after a while, and again later."""
    machine.on()
    machine.home()
    machine.hal("setp", "feedwright.enable", enable)
    for pin, value in (params or {}).items():
        machine.hal("setp", pin, value)
    machine.open(program)
    machine.record()
    machine.begin()
    machine.wait(at_s)
    for pin, value in changes.items():
        machine.hal("setp", pin, value)
    if again_s is not None:
        machine.wait(again_s)
        for pin, value in restore.items():
            machine.hal("setp", pin, value)
    ended_by = "end"
    try:
        machine.finish(20)
    except Exception:
        if not machine.messages:
            raise
        ended_by = "error"
    return {"ended_by": ended_by, "alive": machine.status.task_state}


# Sides of a square with a rest behind each, for as long as a cause needs to come back.
SIDES = "G21 G17 G90 G61 F3000\nG4 P0.3\n" + "".join(f"G1 X{x} Y{y}\nG4 P0.4\n" for _ in range(6) for x, y in ((20, 0), (20, 20), (0, 20), (0, 0))) + "M2\n"


def comes_back(machine, inertia):
    """A machine that gets heavy in the cut; then the correction is switched off and on, the machine repaired, the power taken away, and the program
    cut again."""
    pins = lambda *names: [machine.hal("getp", f"feedwright.{name}") for name in names]
    machine.on()
    machine.home()
    machine.hal("setp", "feedwright.enable", 1)
    machine.open(SIDES)
    machine.record()
    machine.begin()
    machine.wait(1.5)
    machine.hal("setp", "feedwright-plant.inertia", inertia)
    machine.finish(60)
    told = {"latched": pins("latched", "fault", "cause", "state")}
    machine.hal("setp", "feedwright.enable", 0)
    machine.wait(0.1)
    machine.hal("setp", "feedwright.enable", 1)
    machine.wait(0.1)
    told["reset"] = pins("latched", "fault")
    machine.hal("setp", "feedwright-plant.inertia", 1)
    machine.command.state(machine.linuxcnc.STATE_ESTOP)
    machine.wait(0.4)
    machine.on()
    machine.open(SIDES)
    machine.begin()
    machine.finish(60)
    return {**told, "repaired": pins("latched", "fault", "state")}


def hold(machine, at_s=0.9):
    """Feed hold on the way round a corner, on again, override from 0 to 200 %."""
    machine.on()
    machine.home()
    machine.open("G21 G90 G61\nG0 X0 Y0\nG4 P0.3\nG1 X20 F3000\nG1 Y20\nG1 X0\nG1 Y0\nG1 X20\nG1 Y20\nG4 P0.2\nM2\n")
    machine.record()
    machine.begin()
    machine.wait(at_s)
    machine.command.auto(machine.linuxcnc.AUTO_PAUSE)
    machine.wait(0.5)
    machine.command.auto(machine.linuxcnc.AUTO_RESUME)
    for share in (0.0, 2.0, 0.5, 1.0):
        machine.command.feedrate(share)
        machine.wait(0.3)
    machine.finish()


def abort(machine):
    """Abort in mid-cut, and a move behind it."""
    machine.on()
    machine.home()
    machine.open(LONG)
    machine.record()
    machine.begin()
    machine.wait(1.5)
    machine.command.abort()
    machine.command.wait_complete(5)
    machine.wait(0.5)
    machine.mdi("G0 X0 Y0")


def estop(machine):
    """Emergency stop in mid-cut, and on again."""
    machine.on()
    machine.home()
    machine.open(LONG)
    machine.record()
    machine.begin()
    machine.wait(1.5)
    machine.command.state(machine.linuxcnc.STATE_ESTOP)
    machine.wait(0.5)
    machine.on()
    machine.wait(0.3)
    machine.mdi("G0 X0 Y0")


def jog(machine):
    """Continuous and incremental jog, joints and teleop."""
    machine.on()
    machine.home()
    machine.mode(machine.linuxcnc.MODE_MANUAL)
    machine.record()
    machine.command.teleop_enable(1)
    machine.wait(0.2)
    machine.command.jog(machine.linuxcnc.JOG_CONTINUOUS, 0, 0, 30.0)
    machine.wait(0.6)
    machine.command.jog(machine.linuxcnc.JOG_STOP, 0, 0)
    machine.wait(0.3)
    machine.command.jog(machine.linuxcnc.JOG_INCREMENT, 0, 1, 20.0, 5.0)
    machine.wait(0.8)
    machine.mdi("G1 X3 Y3 F1500")
    machine.mdi("G0 X0 Y0")


def home_again(machine):
    """Homing with search and latch on switches in the machine (home.hal)."""
    machine.on()
    machine.record()
    machine.home(60)
    machine.mdi("G0 X1 Y1")
    return {"home": [machine.hal("getp", f"joint.{i}.motor-offset") for i in range(3)]}


PROBE_MM_MIN = (60, 300, 1500)


def probe(machine, enable):
    """A probing motion to a plane behind a cut; where it tripped."""
    machine.on()
    machine.home()
    machine.hal("setp", "feedwright.enable", int(enable))
    machine.record()
    machine.mdi("G21 G90 G64 G1 X5 Y5 Z0 F3000")
    trips = []
    for speed in PROBE_MM_MIN:
        machine.mdi(f"G38.2 Z-20 F{speed}")
        machine.poll()
        trips.append(machine.status.probed_position[2])
        machine.mdi("G1 Z0 F3000")
    return {"trips": trips}


PLANE_MM = -10


def probing_program(count=36, seed=1):
    """Probing motions behind cuts, rapids and each other, in one program: the speed along Z, mm/min, and the trip of each go to a file. The tool
    touches a plane at PLANE_MM."""
    pick = random.Random(seed)
    lines = ["G21 G17 G90 G94 G64", "(LOGOPEN,TRIPS)", "G1 X0 Y0 Z0 F3000"]
    for k in range(count):
        mm_min = pick.choice((100, 300, 600, 1500))
        lines += [f"{pick.choice(('G1', 'G1', 'G0'))} X{pick.uniform(0, 10):.3f} Y{pick.uniform(0, 10):.3f} "
                  f"Z{PLANE_MM + mm_min / 150 + pick.uniform(0, 1):.3f} F3000",
                  f"{pick.choice(('G38.2', 'G38.3'))} Z-20 F{mm_min}", f"(LOG,-{mm_min} #5063)"]
        if k % 3 == 2:
            lines += [f"{pick.choice(('G38.4', 'G38.5'))} Z0 F{mm_min}", f"(LOG,{mm_min} #5063)"]
    return "\n".join(lines + ["(LOGCLOSE)", "G1 Z0 F3000", "M2"]) + "\n"


def logged(machine, program, params=None):
    """A program that logs to the file TRIPS; what it logged."""
    file = machine.folder / "trips.txt"
    cut(machine, program.replace("TRIPS", str(file)), params=params)
    return {"trips": [tuple(map(float, line.split())) for line in file.read_text().splitlines()]}


# Threads behind cuts, in one program: only motion that follows the spindle feeds along Z. The index comes
# within 10 ms, sooner than the delay.
THREADING = """G21 G18 G90 G94 G64
M3 S6000
G1 X5 Z0 F3000
G33 Z-10 K0.25
G0 X8
G0 Z0
G1 X5 F3000
G33 Z-5 K0.5
G33 Z-8 K0.25
G0 Z0
G1 X5 Y5 F3000
G33.1 Z-10 K0.25
G1 X6 F3000
G76 P0.25 Z-8 I-1 J0.4 K1.2 R1 Q29.5 H1
G1 X0 F3000
M5
M2
"""


def thread(machine):
    """A motion that follows the spindle."""
    machine.on()
    machine.home()
    machine.record()
    machine.mdi("G21 G90 G64 G1 X0 Y0 Z0 F3000")
    machine.mdi("M3 S600")
    machine.wait(0.5)
    machine.mdi("G33 Z-10 K1")
    machine.mdi("G1 X5 Z0 F3000")
    machine.mdi("M5")


def places(machine, places, plane, params):
    """Stands at places, and where a joint was jogged to alone; then probes across X, far along Y."""
    machine.on()
    machine.home()
    for pin, value in params.items():
        machine.hal("setp", pin, value)
    machine.record()
    for x, y, z in places:
        machine.mdi(f"G21 G90 G1 X{x} Y{y} Z{z} F3000")
        machine.wait(0.7)
    machine.mode(machine.linuxcnc.MODE_MANUAL)
    machine.command.teleop_enable(0)
    machine.wait(0.2)
    machine.command.jog(machine.linuxcnc.JOG_INCREMENT, 1, 1, 60.0, 180.0)
    machine.wait(4.5)
    machine.mdi(f"G1 X{plane + 0.2} F3000")
    machine.wait(0.4)
    machine.hal("setp", "probed.in1", plane)
    machine.mdi(f"G38.2 X{plane - 0.2} F6")
    machine.poll()
    return {"probed": machine.status.probed_position[0], "compensates": machine.hal("getp", "feedwright.compensates")}


def home_twice(machine):
    """Homes, goes far, homes again from there, and goes far again; zeros of the joints."""
    zeros, compensates = [], []
    machine.on()
    compensates.append(machine.hal("getp", "feedwright.compensates"))
    machine.record()
    for _ in range(2):
        machine.home(120)
        zeros.append([float(machine.hal("getp", f"joint.{i}.motor-offset")) for i in range(3)])
        for place in ("X0 Y0 Z0", "X-100 Y-150 Z-50"):
            machine.mdi(f"G21 G90 G1 {place} F6000")
            machine.wait(0.7)
        compensates.append(machine.hal("getp", "feedwright.compensates"))
    return {"zeros": zeros, "compensates": compensates}


def estop_far(machine):
    """Power off and on, standing and in motion, far from zero."""
    machine.on()
    machine.home()
    machine.record()
    machine.mdi("G21 G90 G1 X150 Y200 F6000")
    for k in range(4):
        if k % 2:
            machine.command.mdi(f"G1 X{150 - 10 * k} F3000")
            machine.wait(0.3)
        machine.command.state(machine.linuxcnc.STATE_ESTOP)
        machine.wait(0.4)
        machine.on()
        machine.wait(0.4)
        machine.mode(machine.linuxcnc.MODE_MDI)
    machine.mdi("G1 X150 Y200 F3000")
    return {"compensates": machine.hal("getp", "feedwright.compensates")}


def soak(machine, **settings):
    """Random actions and faults."""
    import soaking
    return soaking.run(machine, **settings)


def cuts(machine, programs, enable):
    """One program after another, each recorded in a file of its own; behind each, which joints are corrected by what was learned."""
    learned = []
    machine.on()
    machine.home()
    machine.hal("setp", "feedwright.enable", int(enable))
    for number, program in enumerate(programs):
        machine.open(program)
        machine.record(f"samples-{number}.txt")
        machine.begin()
        machine.finish(LIMIT_S)
        machine.end_record()
        learned.append("".join(axis for i, axis in enumerate("xyz") if machine.hal("getp", f"feedwright.learned-{i}") == "TRUE"))
    return {"learned": learned}


def settings_of(machine):
    """The pins that a user sets."""
    lines = [line.split() for line in machine.hal("-s", "show", "pin", "feedwright.").splitlines()]
    return {words[4]: words[3] for words in lines if len(words) == 5 and words[2] == "IN"}


def live(machine, program, command):
    """A program, and what the page of `feedwright open --hal` gets meanwhile."""
    machine.on()
    machine.home()
    machine.hal("setp", "feedwright.enable", 1)
    page = subprocess.Popen([command, "open", "--hal", "--no-browser", "--quiet"], stdout=subprocess.PIPE, text=True)
    address, rows, ended = page.stdout.readline().strip(), [], threading.Event()

    def ask(begin):
        with urllib.request.urlopen(f"{address}hal/{begin}", timeout=5) as answer:
            return json.load(answer)

    def watch():
        begin = 0
        while not ended.wait(0.2):
            answer = ask(begin)
            begin = answer["next"]
            rows.extend(answer["rows"])

    watching = threading.Thread(target=watch)
    watching.start()
    try:
        pins = [settings_of(machine)]
        machine.open(program)
        machine.record()
        machine.begin()
        machine.finish()
        pins.append(settings_of(machine))
        machine.end_record()
        ended.set()
        watching.join()
        return {"rows": rows, "pins": pins}
    finally:
        ended.set()
        page.terminate()
        page.wait()
