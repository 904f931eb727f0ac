#!/usr/bin/python3
"""The panel beside the component, without LinuxCNC and on a screen that is not there (Xvfb): what it shows, switches and records.

    panel.py --machine MACHINE.fwmodel [--picture FILE.png] [--units inch]

Two axes swing. Exit code 1 where the panel does not show, switch or record what it should; where Xvfb or tkinter is missing, the test
is left out, loudly, and fails where CI is set. `--picture` keeps a picture of it (imagemagick).
"""
import argparse
import importlib.machinery
import importlib.util
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
HAL = """loadrt threads name1=servo-thread period1=1000000
loadrt feedwright model={model}
loadrt feedwright_plant model={model}
loadrt siggen num_chan=2
addf siggen.0.update servo-thread
addf siggen.1.update servo-thread
addf feedwright servo-thread
addf feedwright-plant servo-thread
setp siggen.0.frequency 0
setp siggen.0.amplitude 10
setp siggen.1.frequency 0
setp siggen.1.amplitude 10
net x-command siggen.0.sine => feedwright.command-0
net y-command siggen.1.sine => feedwright.command-1
net x-drive feedwright.drive-0 => feedwright-plant.command-0
net y-drive feedwright.drive-1 => feedwright-plant.command-1
net z-drive feedwright.drive-2 => feedwright-plant.command-2
net z-actual feedwright-plant.actual-2 => feedwright.actual-2
net x-actual feedwright-plant.actual-0 => feedwright.actual-0
net y-actual feedwright-plant.actual-1 => feedwright.actual-1
setp feedwright-plant.powered 1
setp feedwright.powered 0
start
"""
# Of a core, while a user looks at it.
MOST_CPU = 0.06
# Samples in a log of a second, at least.
LEAST_SAMPLES = 800


def left_out(what):
    print(f"\n==> THE PANEL IS NOT TESTED: there is no {what}\n    hint: as root, apt-get install --no-install-recommends xvfb python3-tk", file=sys.stderr)
    return 1 if os.environ.get("CI") else 0


def loaded():
    """The panel as a module."""
    loader = importlib.machinery.SourceFileLoader("feedwright_panel", str(HERE.parent / "panel" / "feedwright-panel"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    sys.dont_write_bytecode = True
    loader.exec_module(module)
    return module


def screen(display):
    """Xvfb on a display; its process."""
    server = subprocess.Popen(["Xvfb", display, "-screen", "0", "1024x700x24"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    os.environ["DISPLAY"] = display
    for _ in range(100):
        if pathlib.Path(f"/tmp/.X11-unix/X{display[1:]}").exists():
            return server
        time.sleep(0.05)
    raise RuntimeError("Xvfb has not started")


def unload():
    subprocess.run(["halrun", "-U"], check=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


class Looks:
    """The panel, and what is wrong with it."""

    def __init__(self, panel_module, root, panel):
        self.module, self.root, self.panel, self.wrong = panel_module, root, panel, []

    def run(self, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.root.update()
            time.sleep(0.01)

    def expect(self, what, is_so):
        print(f"{what:70} {'yes' if is_so else 'NO'}", flush=True)
        self.wrong += [] if is_so else [what]

    def expect_state(self, words):
        self.run(0.8)
        self.expect(f"it says: {words}", self.panel.state["text"] == words)


def check(looks, hal, home):
    panel, text = looks.panel, lambda widget: widget["text"]
    looks.expect("every cause has words", len(panel.words) >= 22 and "deviation-limit" in panel.words[17])
    looks.expect_state("Amplifiers are off")
    hal.set_p("feedwright.powered", "1")
    looks.expect_state("Delayed, not corrected")
    looks.expect("the switch is off", text(panel.switch) == "Correction is off" and not hal.get_value("feedwright.enable"))
    panel.switch.invoke()
    looks.run(0.6)
    looks.expect("the switch turns the correction on", hal.get_value("feedwright.enable") and text(panel.switch) == "Correction is on")
    hal.set_p("siggen.0.frequency", "0.8")
    hal.set_p("siggen.1.frequency", "0.7")
    looks.run(4)
    looks.expect("it says that it corrects", text(panel.state) == "Correcting")
    measured, without = (max(column[k] for column in list(panel.chart.columns)[-10:]) for k in (0, 1))
    looks.expect(f"the chart has both errors: {1e3 * measured:.1f} of {1e3 * without:.1f} um", 0 < measured < 0.2 * without)
    drawn = panel.chart.canvas.coords(panel.chart.lines["without"])
    looks.expect("both are drawn", len(drawn) >= 20 and max(drawn[1::2]) > min(drawn[1::2]) + 20)
    looks.expect("three axes have a line", {i for i, _ in panel.cells} == {0, 1, 2} and float(text(panel.cells[0, 1])) != 0.0)
    looks.expect("the deviation is shown with its limit", text(panel.deviation).endswith({"µm": "of 500.0", "0.001 in": "of 19.685"}[panel.unit]))
    hal.set_p("feedwright.deviation-limit", "-1")
    looks.run(0.6)
    looks.expect(f"a fault is told: {text(panel.cause)}", text(panel.cause).startswith("Fault 17: deviation-limit is not"))
    hal.set_p("feedwright.deviation-limit", "0.5")
    looks.run(0.6)
    looks.expect("and later as the last one", text(panel.cause).startswith("Last fault 17"))


def check_recorder(looks, hal, home):
    panel = looks.panel
    panel.button.invoke()
    looks.run(1.2)
    looks.expect("a log is recorded without delay", panel.recorder.is_on() and bool(hal.get_value("feedwright.direct")))
    panel.button.invoke()
    logs = list((home / "feedwright").glob("log-*.txt"))
    lines = logs[0].read_text().splitlines() if logs else []
    looks.expect("its file is told", len(logs) == 1 and str(logs[0]) in panel.told["text"])
    looks.expect("it begins as 'feedwright identify' reads it", lines[:2] == ["# sample_time_s = 0.001", "# n x.cmd x.act y.cmd y.act z.cmd z.act"])
    numbers = [int(line.split()[0]) for line in lines[2:]]
    looks.expect(f"no sample of {len(numbers)} is lost", len(numbers) > LEAST_SAMPLES and numbers == list(range(numbers[0], numbers[0] + len(numbers))))
    looks.expect("the delay comes back", not hal.get_value("feedwright.direct") and not panel.recorder.is_on())
    panel.button.invoke()
    looks.run(0.2)
    panel.button.invoke()
    looks.expect("it records again", "LOST" not in panel.told["text"] and "not recorded" not in panel.told["text"])


def check_switch_of_hal(looks):
    """A panel that comes later takes the switch again; where another pin drives it, it does not."""
    for name, others, expected in (("it switches again", [], True), ("a switch of HAL is left alone", [("loadrt", "not"), ("net", f"{looks.module.NAME}-enable", "not.0.out")], False)):
        for words in others:
            subprocess.run(["halcmd", *words], check=True)
        component = looks.module.Component()
        component.connect()
        looks.expect(name, component.owns_switch is expected)
        component.me.exit()


def check_layout(looks, home):
    """In the tab of AXIS, and on an inch machine."""
    ini = home / "inch.ini"
    ini.write_text("[TRAJ]\nLINEAR_UNITS = inch # as of old\n[HAL]\nHALFILE = a.hal\nHALFILE = b.hal\n")
    looks.expect("it shows inches on an inch machine", [looks.module.machine_units(file) for file in (str(ini), None)] == ["inch", "mm"])
    looks.root.geometry("400x465")
    looks.run(0.5)
    panel = looks.panel
    below = panel.table.winfo_rooty() >= panel.chart.canvas.winfo_rooty() + panel.chart.canvas.winfo_height()
    fits = panel.table.winfo_rooty() + panel.table.winfo_height() <= panel.button.winfo_rooty()
    looks.expect("in the tab of AXIS the numbers are below the chart, and fit", panel.narrow and below and fits)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--machine", required=True)
    parser.add_argument("--picture")
    parser.add_argument("--units", default="mm")
    args = parser.parse_args()
    if not shutil.which("Xvfb"):
        return left_out("Xvfb")
    try:
        import tkinter
    except ImportError:
        return left_out("tkinter")
    with tempfile.TemporaryDirectory(prefix="feedwright-panel-") as name:
        home = pathlib.Path(name)
        os.environ.update(HOME=name, **({"RTAPI_UID": "65534"} if os.getuid() == 0 else {}))
        home.chmod(0o777)
        server = screen(f":{90 + os.getpid() % 9}")
        hal_file = home / "panel.hal"
        hal_file.write_text(HAL.format(model=pathlib.Path(args.machine).resolve()))
        # What a LinuxCNC that was killed left behind.
        unload()
        subprocess.run(["/usr/lib/linuxcnc/realtime", "start"], check=True)
        try:
            subprocess.run(["halcmd", "-f", str(hal_file)], check=True)
            module = loaded()
            import hal
            root, component = tkinter.Tk(), module.Component()
            looks = Looks(module, root, module.Panel(root, component, args.units))
            looks.panel.read()
            check(looks, hal, home)
            begun, used = time.monotonic(), time.process_time()
            while time.monotonic() < begun + 5:
                root.update()
                time.sleep(0.05)
            share = (time.process_time() - used) / (time.monotonic() - begun)
            looks.expect(f"it takes {100 * share:.1f} % of a core", share < MOST_CPU)
            if args.picture:
                subprocess.run(["import", "-window", "root", args.picture], check=True)
            check_recorder(looks, hal, home)
            check_layout(looks, home)
            looks.panel.close()
            component.me.exit()
            enable = subprocess.run(["halcmd", "getp", "feedwright.enable"], capture_output=True, text=True, check=True).stdout.strip()
            looks.expect("the correction stays on without the panel", enable == "TRUE")
            check_switch_of_hal(looks)
        finally:
            unload()
            server.terminate()
            server.wait()
    return 1 if looks.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
