"""What a soak test does with LinuxCNC in one session: random actions by a seed, faults among them, and a way back from each."""
import math
import random
import sys
import time

# A session's actions end here and the way back begins, mm.
REACH_MM = 40.0
PATH_MODES = ("G61", "G64", "G64 P0.001 Q0", "G64 P0.01")
# Values in range and out of it, for each pin.
NONSENSE = (math.nan, math.inf, -math.inf, -1.0, 1e300, -1e-300, 1e12)
PINS = {
    "delay": (0.008, 0.010, 0.012, 0.015),
    "deviation-limit": (0.0, 0.01, 0.1, 0.5, 2.0),
    "speed-limit": (100.0, 400.0, 1000.0),
    "correction-acceleration": (100.0, 400.0, 2000.0),
    "acceleration-limit": (0.0, 2000.0, 100000.0),
}
GOOD = {"delay": 0.010, "deviation-limit": 0.5, "speed-limit": 400.0, "correction-acceleration": 400.0, "acceleration-limit": 0.0}
# Longest wait for a state on the way back, s.
RETURNS_S = 8.0
# On a busy machine without a real-time kernel, the servo thread now and then stands for some seconds.
STARVED_S = 30.0


def program(pick, with_rotary):
    """A random program of some seconds within REACH_MM."""
    place = lambda: pick.uniform(-REACH_MM, REACH_MM)
    x, y = place(), place()
    lines = [f"G21 G17 G90 G94 {pick.choice(PATH_MODES)}", f"G0 X{x:.4f} Y{y:.4f} Z0", f"F{pick.choice((300, 1500, 3000, 6000))}"]
    lines += [f"G4 P{pick.choice((0.02, 0.3))}"] * pick.randint(0, 1)
    for _ in range(pick.randint(5, 60)):
        kind = pick.random()
        if kind < 0.5:
            # Short steps as of a CAM system, and long ones.
            reach = pick.choice((0.05, 0.5, 5.0, 20.0))
            x, y = (min(max(at + pick.uniform(-reach, reach), -REACH_MM), REACH_MM) for at in (x, y))
            rotary = f" A{pick.uniform(-90, 90):.3f}" if with_rotary and pick.random() < 0.2 else ""
            lines.append(f"G1 X{x:.4f} Y{y:.4f} Z{pick.uniform(-2, 0):.3f}{rotary}")
        elif kind < 0.8:
            lines.append(f"{pick.choice(('G2', 'G3'))} X{x:.4f} Y{y:.4f} I{pick.uniform(-8, 8):.4f} J{pick.uniform(1, 8):.4f}")
        elif kind < 0.9:
            x, y = place(), place()
            lines.append(f"G0 X{x:.4f} Y{y:.4f}")
        elif kind < 0.95:
            lines += [f"G38.3 Z{pick.uniform(-6, -3):.3f}", "G0 Z0"]
        else:
            lines.append(f"G4 P{pick.choice((0.0, 0.005, 0.05, 0.4))}")
    return "\n".join([*lines, "M2"]) + "\n"


class Soak:
    """A session: `machine` is that of headless.py."""

    def __init__(self, machine, pick, expects, with_rotary):
        import hal
        self.machine, self.pick, self.expects, self.with_rotary = machine, pick, expects, with_rotary
        self.values, self.me = hal, hal.component("soak")
        self.me.ready()
        self.injected, self.counts, self.wrong, self.begun = False, {}, [], time.monotonic()

    def get(self, pin):
        return self.values.get_value(f"feedwright.{pin}")

    def set(self, pin, value):
        self.values.set_p(pin if "." in pin else f"feedwright.{pin}", str(value))

    def note(self, what):
        self.counts[what] = self.counts.get(what, 0) + 1
        print(f"[soak {time.monotonic() - self.begun:7.3f}] {what}", file=sys.stderr, flush=True)

    def complain(self, what):
        self.note(f"WRONG {what}")
        self.wrong.append(what)

    def look(self):
        """What LinuxCNC says, and whether the component is alive."""
        said = len(self.machine.messages)
        self.machine.poll()
        for message in self.machine.messages[said:]:
            if "following error" in message and not self.injected:
                self.complain(f"{message}, with no fault that was injected; settings {[(pin, self.get(pin)) for pin in PINS]}")

    def wait(self, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.look()
            time.sleep(0.01)

    def until(self, is_so, seconds):
        end = time.monotonic() + seconds
        while not is_so():
            if time.monotonic() > end:
                return False
            self.look()
            time.sleep(0.003)
        return True

    def is_on(self):
        return self.machine.status.task_state == self.machine.linuxcnc.STATE_ON

    def is_done(self):
        return not self.is_on() or self.machine.is_idle()

    def ready(self):
        """Powered, homed, idle, in the mode that is asked for."""
        self.machine.poll()
        if not self.is_on():
            self.machine.on()
        if not self.until(lambda: all(self.machine.status.homed[:self.machine.status.joints]), 0.5):
            self.machine.home()

    def mode(self, mode):
        self.machine.command.mode(mode)
        self.machine.command.wait_complete(2)
        return self.until(lambda: self.machine.status.task_mode == mode, 2)

    # Actions: what moves.

    def do_mdi(self):
        if self.mode(self.machine.linuxcnc.MODE_MDI):
            for _ in range(self.pick.randint(1, 4)):
                place = [self.pick.uniform(-REACH_MM, REACH_MM) for _ in range(2)]
                self.machine.command.mdi(f"G21 G90 {self.pick.choice(('G0', 'G1'))} X{place[0]:.3f} Y{place[1]:.3f} F{self.pick.choice((600, 4000))}")
            self.events(1.5)

    def do_jog(self):
        command, linuxcnc = self.machine.command, self.machine.linuxcnc
        if not self.mode(linuxcnc.MODE_MANUAL):
            return
        command.teleop_enable(1)
        self.wait(0.1)
        for _ in range(self.pick.randint(1, 3)):
            axis, speed = self.pick.randint(0, 2), self.pick.choice((-1, 1)) * self.pick.uniform(5, 60)
            if self.pick.random() < 0.5:
                command.jog(linuxcnc.JOG_CONTINUOUS, 0, axis, speed)
                self.events(self.pick.uniform(0.05, 0.6))
                command.jog(linuxcnc.JOG_STOP, 0, axis)
            else:
                command.jog(linuxcnc.JOG_INCREMENT, 0, axis, speed, self.pick.uniform(0.01, 5))
                self.events(0.5)
        self.wait(0.2)

    def do_auto(self):
        file = self.machine.folder / "program.ngc"
        file.write_text(program(self.pick, self.with_rotary))
        if self.mode(self.machine.linuxcnc.MODE_AUTO):
            self.machine.command.program_open(str(file))
            self.machine.command.wait_complete(2)
            self.machine.command.auto(self.machine.linuxcnc.AUTO_RUN, 0)
            self.wait(0.1)
            self.events(self.pick.uniform(2, 8))

    def events(self, seconds):
        """Lets it move, and meddles."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.wait(self.pick.uniform(0.02, 0.5))
            if self.pick.random() < 0.8:
                self.meddle()
            if self.is_done() and self.pick.random() < 0.5:
                break

    # Meddling: what goes wrong, or is set, while it moves.

    def meddle(self):
        doings = [self.meddle_pin] * 6 + [self.meddle_enable] * 3 + [self.meddle_direct] * 2 + [self.meddle_override] * 3 + [self.meddle_hold] * 2 + [
            self.meddle_abort, self.meddle_estop, self.meddle_off, self.meddle_noise, self.meddle_inertia, self.meddle_wire]
        doing = self.pick.choice(doings)
        self.note(doing.__name__)
        doing()

    def meddle_pin(self):
        pin = self.pick.choice(list(PINS))
        self.set(pin, self.pick.choice(NONSENSE if self.pick.random() < 0.3 else PINS[pin]))

    def meddle_enable(self):
        self.set("enable", self.pick.randint(0, 1))

    def meddle_direct(self):
        self.set("direct", self.pick.randint(0, 1))

    def meddle_override(self):
        self.machine.command.feedrate(self.pick.choice((0.0, 0.3, 1.0, 1.0, 2.0)))

    def meddle_hold(self):
        self.machine.command.auto(self.machine.linuxcnc.AUTO_PAUSE)
        self.wait(self.pick.uniform(0.01, 0.4))
        self.machine.command.auto(self.machine.linuxcnc.AUTO_RESUME)

    def meddle_abort(self):
        self.machine.command.abort()

    def meddle_estop(self):
        self.machine.command.state(self.machine.linuxcnc.STATE_ESTOP)
        self.wait(self.pick.uniform(0.05, 0.3))

    def meddle_off(self):
        self.machine.command.state(self.machine.linuxcnc.STATE_OFF)
        self.wait(self.pick.uniform(0.02, 0.3))

    def inject(self, pin, value, seconds, back):
        self.injected = True
        self.set(f"feedwright-plant.{pin}", value)
        self.wait(seconds)
        self.set(f"feedwright-plant.{pin}", back)

    def meddle_noise(self):
        self.inject("wire-noise", 1, self.pick.choice((0.002, 0.01, 0.5)), 0)

    def meddle_wire(self):
        self.inject("wire-broken", 1, self.pick.choice((0.01, 0.1, 1.0)), 0)

    def meddle_inertia(self):
        self.set("feedwright-plant.inertia", self.pick.choice((0.7, 1.0, 1.4, 2.0)))

    # The way back.

    def come_back(self):
        """Good settings, power off and on, and every state in its turn: the link has to leave each."""
        self.note("way back")
        machine = self.machine
        machine.command.abort()
        machine.command.feedrate(1.0)
        for pin, value in (*GOOD.items(), ("enable", 1), ("direct", 0), ("feedwright-plant.inertia", 1), ("feedwright-plant.wire-noise", 0),
                           ("feedwright-plant.wire-broken", 0)):
            self.set(pin, value)
        machine.command.state(machine.linuxcnc.STATE_ESTOP)
        self.wait(0.3)
        self.reach((0,), "power off")
        self.ready()
        self.injected = False
        file = machine.folder / "program.ngc"
        file.write_text("G21 G17 G90 G94 G64 P0.01\nG0 X5 Y5 Z0\nG0 X0 Y0\nG4 P0.3\nF3000\n" + "G2 X0 Y0 I10 J0\nM2\n")
        self.mode(machine.linuxcnc.MODE_AUTO)
        machine.command.program_open(str(file))
        machine.command.wait_complete(2)
        machine.command.auto(machine.linuxcnc.AUTO_RUN, 0)
        self.reach(self.expects, "a cut")
        if not self.until(self.is_done, 15):
            self.complain("a program of 3 s has not ended")
        self.set("direct", 1)
        self.reach((1,), "direct")
        self.set("direct", 0)
        self.reach((1,) if self.expects == (1,) else (2, 3, 4), "delay again")

    def reach(self, states, what):
        if not self.until(lambda: self.get("state") in states, RETURNS_S):
            self.complain(f"state {self.get('state')} with {what}: expected {states}; cause {self.get('cause')}")
        # It changes in each servo period: a steady pause between two looks could meet the same value each time.
        seen, end = set(), time.monotonic() + STARVED_S
        while len(seen) < 2 and time.monotonic() < end:
            seen.add(bool(self.get("heartbeat")))
            time.sleep(random.uniform(0, 0.003))
        if len(seen) < 2:
            self.complain(f"no heartbeat with {what}")


def run(machine, seed, seconds, expects, with_rotary):
    """A session; what it did and what was wrong."""
    soak = Soak(machine, random.Random(seed), tuple(expects), with_rotary)
    machine.on()
    machine.home()
    end = time.monotonic() + seconds
    while time.monotonic() < end and not soak.wrong:
        try:
            soak.ready()
            doing = soak.pick.choice((soak.do_auto, soak.do_auto, soak.do_mdi, soak.do_jog))
            soak.note(doing.__name__)
            doing()
            if soak.injected or soak.pick.random() < 0.3:
                soak.come_back()
        except soak.machine.linuxcnc.error as error:
            soak.complain(f"LinuxCNC: {error}")
    soak.come_back()
    return {"counts": soak.counts, "wrong": soak.wrong}
