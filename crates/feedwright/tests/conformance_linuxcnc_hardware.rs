//! `linuxcnc setup` on hardware that it does not know. With `--simulate`, nothing in the copy
//! commands or enables it, or nothing is written. Gains of a `pid` count only where its output is a
//! speed.

use std::fmt::Write as _;

use crate::command::{Folder, Ran};

/// The motion controller, and three joints of a configuration.
const HEAD: &str = "loadrt [KINS]KINEMATICS
loadrt [EMCMOT]EMCMOT servo_period_nsec=[EMCMOT]SERVO_PERIOD num_joints=[KINS]JOINTS
addf motion-command-handler servo-thread
addf motion-controller servo-thread
";

/// A configuration in a folder. In `joint`, `@` is the number of a joint.
fn configuration(unit: &str, loads: &str, joint: &str, rest: &str) -> Folder {
    let mut hal = format!("{HEAD}{loads}\n");
    let mut ini = format!(
        "[EMC]\nMACHINE = m\n[KINS]\nJOINTS = 3\nKINEMATICS = trivkins coordinates=XYZ\n[EMCMOT]\nEMCMOT = motmod\nSERVO_PERIOD = 1000000\n\
         [TRAJ]\nCOORDINATES = XYZ\nLINEAR_UNITS = {unit}\n[HAL]\nHALFILE = m.hal\n"
    );
    for (number, letter) in ["X", "Y", "Z"].into_iter().enumerate() {
        let _ = writeln!(hal, "{}", joint.replace('@', &number.to_string()));
        let limits = "MAX_VELOCITY = 60\nMAX_ACCELERATION = 400\nMIN_LIMIT = -200\nMAX_LIMIT = 200";
        let _ = writeln!(
            ini,
            "[AXIS_{letter}]\n{limits}\n[JOINT_{number}]\nTYPE = LINEAR\n{limits}\nFERROR = 0.5\nMIN_FERROR = 0.1\nHOME = 0\nP = 5\nFF1 = 0.125"
        );
    }
    let folder = Folder::new();
    folder.file("m.hal", hal + rest);
    folder.file("m.ini", ini);
    folder
}

fn setup(folder: &Folder, options: &[&str]) -> Ran {
    folder.run(&[&["linuxcnc", "setup", "m.ini"], options].concat())
}

/// The lines of the written HAL files that name a text, without comments.
fn lines_with(folder: &Folder, text: &str) -> Vec<String> {
    let files = ["m-feedwright-m.hal", "m-feedwright.hal"].map(|name| folder.text(name));
    let lines = files
        .iter()
        .flat_map(|file| file.lines())
        .filter(|line| !line.starts_with('#') && line.contains(text));
    lines
        .map(|line| line.split_whitespace().collect::<Vec<_>>().join(" "))
        .collect()
}

/// A driver with a position command and an enable.
const DRIVER: &str = "net cmd@ joint.@.motor-pos-cmd => mydrive.@.position-cmd
net fb@ mydrive.@.position-fb => joint.@.motor-pos-fb
net en@ joint.@.amp-enable-out => mydrive.@.enable";

#[test]
fn an_unknown_driver_is_not_simulated_and_is_disconnected() {
    let folder = configuration("mm", "loadrt mydrive count=3", DRIVER, "");
    let plain = setup(&folder, &[]);
    assert_eq!(plain.code, Some(1));
    assert!(
        plain
            .reported()
            .contains("setup does not know whether mydrive.0.position-fb is a measured position"),
        "{plain:?}"
    );
    let simulated = setup(&folder, &["--simulate", "tnv40"])
        .succeeded()
        .reported();
    assert!(!simulated.contains("It is simulated"), "{simulated}");
    assert!(
        simulated
            .contains("mydrive.2: enable (from joint.2.amp-enable-out), position-cmd (from joint.2.motor-pos-cmd)"),
        "{simulated}"
    );
    let reported = [0, 1, 2].map(|n| format!("net fb{n} mydrive.{n}.position-fb"));
    assert_eq!(lines_with(&folder, "mydrive."), reported);
    assert!(
        folder
            .text("m-feedwright.hal")
            .contains("net cmd0 => feedwright-plant.command-0")
    );
}

/// The driver is behind a scale and a limit; the enable is inverted, and the feedback goes through
/// a sum.
#[test]
fn a_driver_behind_arithmetic_is_disconnected_and_kept_off() {
    let joint = "net cmd@ joint.@.motor-pos-cmd => scale.@.in
net scaled@ scale.@.out => mux2.@.in1
net set@ mux2.@.out => mydrive.@.speed
net raw@ mydrive.@.count => sum2.@.in0
net fb@ sum2.@.out => joint.@.motor-pos-fb
net en@ joint.@.amp-enable-out => and2.@.in0
net on@ motion.motion-enabled => and2.@.in1
net off@ and2.@.out => not.@.in
net disable@ not.@.out => mydrive.@.disable";
    let loads = "loadrt mydrive count=3\nloadrt scale count=3\nloadrt mux2 count=3\nloadrt sum2 count=3\nloadrt and2 count=3\nloadrt not count=3";
    let folder = configuration("mm", loads, &joint.replace("net on@", "net on"), "");
    let printed = setup(&folder, &["--simulate", "tnv40"])
        .succeeded()
        .reported();
    assert!(
        printed.contains("mydrive.1: disable (from not.1.out, set to 1), speed (from mux2.1.out)"),
        "{printed}"
    );
    assert_eq!(lines_with(&folder, ".speed"), [""; 0]);
    assert_eq!(
        lines_with(&folder, "disable"),
        [0, 1, 2]
            .map(|n| [
                format!("net disable{n} not.{n}.out"),
                format!("setp mydrive.{n}.disable 1")
            ])
            .concat()
    );
}

/// The command is its own feedback, and a driver without encoder takes it, too; spindle, coolant
/// and charge pump reach hardware.
#[test]
fn a_driver_beside_a_loopback_is_hardware_too() {
    let joint = "net cmd@ joint.@.motor-pos-cmd => joint.@.motor-pos-fb drv-@.cmd\nlinksp speed@ <= joint.@.vel-cmd\nlinksp speed@ => drv-@.velocity";
    let rest = "loadrt charge_pump\nnet pump charge-pump.out => io.0.out-00\nnet m3 spindle.0.on => io.0.out-01\n\
                net flood iocontrol.0.coolant-flood => io.0.out-02\nalias pin io.0.out-03 relay\nnet power iocontrol.0.user-enable-out => relay iocontrol.0.emc-enable-in\n\
                net door io.0.in-00 => or2.0.in0 motion.feed-hold\n";
    let folder = configuration(
        "mm",
        "loadrt mydrive names=drv-0,drv-1,drv-2\nloadrt or2",
        joint,
        rest,
    );
    let printed = setup(&folder, &["--simulate", "tnv40"])
        .succeeded()
        .reported();
    assert!(
        printed.contains("drv-0.cmd takes the position, the command is its own feedback"),
        "{printed}"
    );
    assert!(
        printed
            .contains("drv-2: cmd (from joint.2.motor-pos-cmd), velocity (from joint.2.vel-cmd)"),
        "{printed}"
    );
    for pin in [
        "drv-0.",
        "drv-1.",
        "drv-2.",
        "io.0.out-00",
        "io.0.out-01",
        "io.0.out-02",
        "=> relay",
    ] {
        assert_eq!(
            lines_with(&folder, pin)
                .iter()
                .filter(|line| !line.starts_with("alias"))
                .count(),
            0,
            "{pin}"
        );
    }
    // What the hardware reports stays.
    assert_eq!(
        lines_with(&folder, "io.0.in-00"),
        ["net door io.0.in-00 => or2.0.in0 motion.feed-hold"]
    );
    assert_eq!(
        lines_with(&folder, "emc-enable-in"),
        ["net power iocontrol.0.user-enable-out iocontrol.0.emc-enable-in"]
    );
}

#[test]
fn a_pid_in_front_of_an_unknown_amplifier_keeps_its_input() {
    let joint = "net cmd@ joint.@.motor-pos-cmd => pid.@.command
net fb@ dev.@.angle => pid.@.feedback joint.@.motor-pos-fb
net out@ pid.@.output => dev.@.torque
net en@ joint.@.amp-enable-out => pid.@.enable dev.@.run";
    let folder = configuration("mm", "loadrt pid num_chan=3\nloadrt dev", joint, "");
    let printed = setup(&folder, &["--simulate", "tnv40"])
        .succeeded()
        .reported();
    assert!(
        printed.contains("dev.0: run (from joint.0.amp-enable-out), torque (from pid.0.output)"),
        "{printed}"
    );
    assert_eq!(
        lines_with(&folder, "dev.0."),
        ["net fb0 dev.0.angle => pid.0.feedback"]
    );
}

#[test]
fn what_cannot_be_disconnected_is_refused_and_nothing_is_written() {
    let cases = [
        // The value at which the device is off depends on a threshold, or on the hardware.
        (
            "net f joint.0.pos-cmd => comp.0.in0\nnet lamp comp.0.out => io.0.power\n",
            "cannot disconnect io.0.power",
        ),
        (
            "net key io.0.in => or2.0.in1\nnet e joint.0.homed => or2.0.in0\nnet o or2.0.out => io.0.power\n",
            "cannot disconnect io.0.power",
        ),
        (
            "loadusr -w halcmd -kf more.hal\n",
            "m.hal:17: setup does not read what halcmd does",
        ),
    ];
    for (rest, said) in cases {
        let folder = configuration(
            "mm",
            "loadrt mydrive count=3\nloadrt comp\nloadrt or2",
            DRIVER,
            rest,
        );
        let before = folder.content();
        let ran = setup(&folder, &["--simulate", "tnv40"]);
        assert_eq!(ran.code, Some(1), "{rest}");
        assert!(ran.reported().contains(said), "{ran:?}");
        assert_eq!(folder.content(), before);
    }
    for (line, said) in [
        (
            "HALCMD = net x joint.0.homed => io.0.power",
            "m.ini:14: setup does not read HALCMD",
        ),
        (
            "POSTGUI_HALFILE = p.tcl",
            "m.ini:14: setup does not read p.tcl",
        ),
    ] {
        let folder = configuration("mm", "loadrt mydrive count=3", DRIVER, "");
        folder.file(
            "m.ini",
            folder
                .text("m.ini")
                .replace("HALFILE = m.hal\n", &format!("HALFILE = m.hal\n{line}\n")),
        );
        let ran = setup(&folder, &["--simulate", "tnv40"]);
        assert!(
            ran.code == Some(1) && ran.reported().contains(said),
            "{ran:?}"
        );
    }
}

/// Joints of an analog servo.
const ANALOG: &str = "setp pid.@.Pgain [JOINT_@]P
setp pid.@.FF1 [JOINT_@]FF1
net cmd@ joint.@.motor-pos-cmd => pid.@.command
net fb@ hm2_7i97.0.encoder.0@.position => pid.@.feedback joint.@.motor-pos-fb
net out@ pid.@.output => OUTPUT";

#[test]
fn gains_of_an_analog_servo_give_no_lag() {
    let pwm = ANALOG.replace("OUTPUT", "hm2_7i97.0.pwmgen.0@.value");
    let scaled = format!("setp hm2_7i97.0.pwmgen.0@.scale 10\n{pwm}");
    let torque = ANALOG.replace("OUTPUT", "lcec.0.@.target-torque");
    let without = pwm.replace("setp pid.@.FF1 [JOINT_@]FF1", "setp pid.@.FF1 0");
    for (unit, joint) in [
        ("mm", &scaled),
        ("inch", &without),
        ("mm", &torque),
        ("inch", &pwm),
    ] {
        let folder = configuration(unit, "loadrt pid num_chan=3\nloadrt hostmot2", joint, "");
        let printed = setup(&folder, &[]).succeeded().reported();
        assert!(!printed.contains("set FERROR"), "{printed}");
        assert!(
            printed.contains(
                "how far these drives are behind is not known before they are identified"
            ),
            "{printed}"
        );
        let machine = folder.text("m-feedwright.toml");
        assert!(
            !machine.contains("\nkp_1_s") && !machine.contains("\nvelocity_feedforward"),
            "{machine}"
        );
        assert!(
            folder
                .text("m-feedwright.ini")
                .contains("FERROR = 0.5\nMIN_FERROR = 0.1\n")
        );
    }
}

#[test]
fn gains_in_front_of_a_step_generator_give_a_lag() {
    let joint = ANALOG.replace("OUTPUT", "hm2_7i97.0.stepgen.0@.velocity-cmd");
    let folder = configuration("mm", "loadrt pid num_chan=3\nloadrt hostmot2", &joint, "");
    let printed = setup(&folder, &[]).succeeded().reported();
    assert!(
        printed
            .contains("[JOINT_2] set FERROR = 25.14 and MIN_FERROR = 25.13 mm (now 0.5 and 0.1)"),
        "{printed}"
    );
    assert!(
        folder
            .text("m-feedwright.toml")
            .contains("kp_1_s = 5.0 # P, m.ini:")
    );
}

#[test]
fn a_following_error_is_raised_to_the_value_that_the_user_names() {
    let joint = ANALOG.replace("OUTPUT", "hm2_7i97.0.pwmgen.0@.value");
    let folder = configuration("mm", "loadrt pid num_chan=3\nloadrt hostmot2", &joint, "");
    let printed = setup(&folder, &["--raise-ferror", "0.3"])
        .succeeded()
        .reported();
    assert!(
        printed.contains(
            "the copy allows a following error of 0.3 mm in [JOINT_0], [JOINT_1], [JOINT_2]"
        ),
        "{printed}"
    );
    let ini = folder.text("m-feedwright.ini");
    assert_eq!(
        ini.matches("FERROR = 0.5\nMIN_FERROR = 0.3\n").count(),
        3,
        "{ini}"
    );
    for value in ["0", "-1", "nan", "inf", "much"] {
        let says = "a following error is a number above 0, in the unit of the configuration";
        setup(&folder, &[&format!("--raise-ferror={value}")]).refused(&[says]);
    }
}

/// A machine file and a model file with a gain that no position loop has are refused in the same
/// words, by what cuts and by what writes a block.
#[test]
fn an_implausible_position_gain_is_refused_everywhere_in_the_same_words() {
    let folder = Folder::new();
    folder.file("part.ngc", "G21 G90\nG1 X10 F1000\nM2\n");
    for (gain, period) in [("0.0036", "0.001"), ("0.05", "0.001"), ("1300", "0.004")] {
        let text = format!(
            "base = \"workshop\"\nname = \"mine\"\n[period]\nservo_s = {period}\nmechanics_s = 0.0001\n[axis.x]\nkp_1_s = {gain}\n"
        );
        folder.file("mine.toml", text);
        let says = [format!(
            "kp_1_s is {gain} 1/s; with servo_s of {period} s a position loop has 0.5 to"
        )];
        let says: Vec<&str> = says
            .iter()
            .map(String::as_str)
            .chain(["a gain in 1/ms times 1000 is in 1/s"])
            .collect();
        folder
            .run(&["block", "mine.toml", "--out", "mine.fwmodel"])
            .refused(&says);
        folder
            .run(&["run", "part.ngc", "--machine", "mine.toml"])
            .refused(&says);
        assert!(!folder.path().join("mine.fwmodel").exists());
    }
}
