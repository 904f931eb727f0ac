//! What a machine file may hold, and what is said about one that holds something else.

use miette::Diagnostic;

use super::*;
use crate::toml_file::{Key, MAX_FILE_BYTES, Problem};

const TNV40: &str = BUILT_IN_MACHINES[0].1;

fn tnv40() -> Machine {
    Machine::load(OsStr::new("tnv40")).unwrap()
}

/// The faults that the tnv40 file has once `from` is replaced by `to`.
fn faults_after(from: &str, to: &str) -> Vec<Problem> {
    assert!(TNV40.contains(from), "the file has no '{from}'");
    match Machine::parse("broken.toml", &TNV40.replacen(from, to, 1)) {
        Err(MachineError::File(FileError::Invalid { problems, .. })) => problems,
        other => panic!("expected faults, got {other:?}"),
    }
}

/// Place and message.
fn placed(fault: &Problem) -> String {
    format!("{}:{}: {fault}", fault.line, fault.column)
}

/// The only fault after the replacement: its text, with the hint.
fn fault_after(from: &str, to: &str) -> String {
    let faults = faults_after(from, to);
    assert_eq!(faults.len(), 1, "{faults:?}");
    format!(
        "{} / {}",
        placed(&faults[0]),
        faults[0].hint.as_deref().unwrap_or("no hint")
    )
}

#[test]
fn tnv40_holds_the_values_of_table_1() {
    let machine = tnv40();
    let table_1 = |axis: &Axis| {
        (
            axis.inertia_kg_m2,
            axis.viscous_friction_nm_s,
            axis.coulomb_friction_nm,
            axis.disturbance_nm,
        )
    };
    assert_eq!(table_1(&machine.axes[0]), (0.0103, 0.0336, 0.2, 0.1));
    assert_eq!(table_1(&machine.axes[1]), (0.012, 0.0308, 0.3, 0.1));
    assert_eq!(
        machine.axes[2], machine.axes[1],
        "the paper has no z: it is assumed like y"
    );
    assert_eq!(machine.period.mechanics_per_servo, 10);
    assert_eq!(machine.axis_count(), 3);
}

#[test]
fn every_built_in_machine_reads_under_its_own_name() {
    for (name, text) in BUILT_IN_MACHINES {
        assert_eq!(Machine::parse(name, text).unwrap().name, *name);
    }
}

#[test]
fn every_value_carries_its_source() {
    for (number, line) in TNV40.lines().enumerate() {
        if line.contains(" = ") && !line.contains('"') && !line.starts_with('#') {
            assert!(
                line.contains(" # "),
                "line {} has no comment: {line}",
                number + 1
            );
        }
    }
}

#[test]
fn a_machine_without_z_has_two_axes() {
    let (text, _) = TNV40
        .split_once("# The paper simulates X and Y only")
        .unwrap();
    assert_eq!(Machine::parse("two.toml", text).unwrap().axis_count(), 2);
}

#[test]
fn values_out_of_range_name_place_value_limit_and_unit() {
    assert_eq!(
        fault_after("inertia_kg_m2 = 0.0103", "inertia_kg_m2 = -0.0103"),
        "25:17: inertia_kg_m2 is -0.0103 kg m2; it must lie between 1e-9 and 1000 kg m2 / is the sign wrong? 0.0103 kg m2 is allowed"
    );
    assert_eq!(
        fault_after("servo_s = 0.001 ", "servo_s = 0 "),
        "12:11: servo_s is 0 s; it must lie between 1e-5 and 0.1 s / no hint"
    );
    for (value, shown) in [
        ("nan", "NaN"),
        ("inf", "inf"),
        ("-inf", "-inf"),
        ("+nan", "NaN"),
    ] {
        let fault = fault_after("kp_1_s = 50", &format!("kp_1_s = {value}"));
        assert!(
            fault.contains(&format!("kp_1_s is {shown} 1/s"))
                && fault.ends_with("/ write a finite number"),
            "{fault}"
        );
    }
    assert!(
        fault_after("torque_limit_nm = 30", "torque_limit_nm = 30e9")
            .contains("is the unit right? this key is in N m")
    );
    assert!(
        fault_after(
            "torque_limit_nm = 30",
            "torque_limit_nm = 99999999999999999999"
        )
        .contains("torque_limit_nm")
    );
    assert!(
        fault_after("torque_limit_nm = 30", "torque_limit_nm = 1e999").contains("torque_limit_nm")
    );
}

#[test]
fn a_position_gain_is_one_of_a_loop_with_this_servo_period() {
    for (kp, servo, limits) in [
        (
            "0.0036",
            "0.001",
            "with servo_s of 0.001 s a position loop has 0.5 to 5000 1/s",
        ),
        (
            "0.05",
            "0.001",
            "with servo_s of 0.001 s a position loop has 0.5 to 5000 1/s",
        ),
        (
            "5500",
            "0.001",
            "with servo_s of 0.001 s a position loop has 0.5 to 5000 1/s",
        ),
        (
            "1300",
            "0.004",
            "with servo_s of 0.004 s a position loop has 0.5 to 1250 1/s",
        ),
    ] {
        let text = TNV40
            .replacen("kp_1_s = 50", &format!("kp_1_s = {kp}"), 1)
            .replacen("servo_s = 0.001", &format!("servo_s = {servo}"), 1);
        let Err(MachineError::File(FileError::Invalid { problems, .. })) =
            Machine::parse("broken.toml", &text)
        else {
            panic!("{kp} 1/s was taken");
        };
        assert_eq!(
            placed(&problems[0]),
            format!("31:10: kp_1_s is {kp} 1/s; {limits}")
        );
        assert!(
            problems[0]
                .hint
                .as_deref()
                .is_some_and(|hint| hint.contains("1/ms times 1000"))
        );
    }
    for kp in ["0.5", "5000"] {
        assert!(
            Machine::parse(
                "mine.toml",
                &TNV40.replacen("kp_1_s = 50", &format!("kp_1_s = {kp}"), 1)
            )
            .is_ok()
        );
    }
}

#[test]
fn missing_unknown_and_mistyped_keys_are_reported() {
    assert_eq!(
        faults_after("kp_1_s = 50", "kp_l_s = 50")
            .iter()
            .map(placed)
            .collect::<Vec<_>>(),
        [
            "23:1: kp_1_s is missing from [axis.x]",
            "31:1: unknown key 'kp_l_s' in [axis.x]"
        ]
    );
    assert!(
        fault_after("kd = 0", "kd = 0\ninertia_kgm2 = 1")
            .ends_with("/ did you mean 'inertia_kg_m2'?")
    );
    assert!(
        fault_after("kd = 0", "kd = 0\nqqq = 1")
            .contains("[axis.x] holds transmission, lead_mm_per_rev, ")
    );
    assert_eq!(
        fault_after("kd = 0 ", "kd = \"0\" "),
        "32:6: kd has to be a number, but is a string / without the quotes: kd = 0"
    );
    assert!(
        fault_after("name = \"tnv40\"", "name = 40")
            .contains("name has to be a text in quotes, but is an integer")
    );
    assert!(fault_after("name = \"tnv40\"", "name = \" \"").contains("name is empty"));
    assert!(fault_after("\n[axis.z]", "\n[axis.w]").contains("unknown table 'w' in [axis]"));
    assert!(
        fault_after("[period]", "[[period]]")
            .contains("period has to be a table [period], but is an array")
    );
}

#[test]
fn a_missing_table_is_one_fault_not_one_for_every_key() {
    let faults = faults_after("[limits]", "[limit]");
    let texts: Vec<String> = faults
        .iter()
        .map(|fault| {
            format!(
                "{} / {}",
                placed(fault),
                fault.hint.clone().unwrap_or_default()
            )
        })
        .collect();
    assert_eq!(
        texts,
        [
            "1:1: table [limits] is missing / is [limit] meant to be it?",
            "15:2: unknown table 'limit' in the file / did you mean 'limits'?"
        ]
    );
}

#[test]
fn all_faults_come_in_one_go_in_the_order_of_the_text() {
    let text = TNV40
        .replacen("servo_s = 0.001", "servo_s = true", 1)
        .replacen("rapid_mm_s = 400", "rapid_mm_s = -1", 1)
        .replacen("kd = 0", "kdd = 0", 1);
    let Err(MachineError::File(FileError::Invalid { problems, .. })) =
        Machine::parse("broken.toml", &text)
    else {
        panic!()
    };
    assert_eq!(
        problems
            .iter()
            .map(|problem| problem.line)
            .collect::<Vec<_>>(),
        [12, 16, 23, 32]
    );
}

#[test]
fn the_servo_period_is_a_whole_multiple_of_the_mechanics_period() {
    let fault = fault_after("mechanics_s = 0.0001", "mechanics_s = 0.0003");
    assert!(
        fault.contains("whole multiple") && fault.contains("s gives 3 steps"),
        "{fault}"
    );
    assert!(fault_after("mechanics_s = 0.0001", "mechanics_s = 0.01").contains("gives 1 steps"));
}

#[test]
fn whole_ratios_survive_the_rounding_of_decimal_numbers() {
    for steps in 1..=1000_u32 {
        let servo_s = 0.003;
        let text = TNV40
            .replacen("servo_s = 0.001", &format!("servo_s = {servo_s}"), 1)
            .replacen(
                "mechanics_s = 0.0001",
                &format!("mechanics_s = {}", servo_s / f64::from(steps)),
                1,
            );
        assert_eq!(
            Machine::parse("fine.toml", &text)
                .unwrap()
                .period
                .mechanics_per_servo,
            steps
        );
    }
}

#[test]
fn a_fault_between_a_value_here_and_one_of_the_base_has_its_place_here() {
    let folder = tempfile::tempdir().unwrap();
    let (_, transmission) = BUILT_IN_MACHINES[4]
        .1
        .split_once("[axis.x.transmission]")
        .unwrap();
    std::fs::write(
        folder.path().join("screw.toml"),
        format!("{TNV40}\n[axis.x.transmission]{transmission}"),
    )
    .unwrap();
    let text = "base = 'screw.toml'\nname = 'slow'\ndescription = 'd'\nsource = 's'\n[period]\nmechanics_s = 0.001\n[axis.y]\n";
    let file = folder.path().join("slow.toml");
    let Err(MachineError::File(FileError::Invalid { problems, .. })) =
        Machine::parse(&file.display().to_string(), text)
    else {
        panic!()
    };
    let lines: Vec<usize> = problems.iter().map(|problem| problem.line).collect();
    assert!(
        problems
            .iter()
            .all(|problem| problem.message.starts_with("resonance_hz is 60 Hz")),
        "{problems:?}"
    );
    // Of x and z the text says nothing: [axis] begins at line 7.
    assert_eq!(lines, [7, 7, 7]);
}

#[test]
fn broken_toml_shows_where() {
    let fault = fault_after("[limits]", "[limits");
    assert!(
        fault.starts_with("15:") && fault.contains("not TOML"),
        "{fault}"
    );
    assert!(matches!(
        Machine::parse("x.toml", "kp = = 1\nname = \"a\nb = \"c"),
        Err(MachineError::File(FileError::Invalid { .. }))
    ));
}

#[test]
fn empty_text_names_everything_that_is_missing() {
    let Err(MachineError::File(FileError::Invalid { problems, .. })) =
        Machine::parse("empty.toml", "")
    else {
        panic!()
    };
    let text: Vec<String> = problems
        .iter()
        .map(|problem| problem.message.clone())
        .collect();
    assert_eq!(
        text,
        [
            "table [period] is missing",
            "name is missing",
            "description is missing",
            "source is missing",
            "table [limits] is missing",
            "table [axis] is missing"
        ]
    );
}

#[test]
fn unknown_names_list_the_known_ones() {
    let error = Machine::load(OsStr::new("tnv4")).unwrap_err();
    assert_eq!(
        error.to_string(),
        "no machine is called 'tnv4'; there is tnv40, heavy, sticky, rough, soft, coarse, workshop, stiff, router, emps, sinumerik"
    );
    assert_eq!(error.help().unwrap().to_string(), "did you mean 'tnv40'?");
    assert!(
        Machine::load(OsStr::new("lathe"))
            .unwrap_err()
            .help()
            .unwrap()
            .to_string()
            .contains("ending in .toml")
    );
}

#[test]
fn files_that_are_no_machine_files_say_so() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    };
    let load = |path: &Path| Machine::load(path.as_os_str());
    assert!(matches!(
        load(&folder.path().join("none.toml")),
        Err(MachineError::File(FileError::Unreadable {
            hint: Some(_),
            ..
        }))
    ));
    assert!(matches!(
        load(folder.path()),
        Err(MachineError::File(FileError::Unreadable { .. }))
    ));
    assert!(matches!(
        load(&write("binary.toml", b"name = \"\xff\"")),
        Err(MachineError::File(FileError::NotText {
            offset: 8,
            byte: 0xff,
            ..
        }))
    ));
    assert!(matches!(
        load(&write(
            "large.toml",
            &vec![b'#'; (MAX_FILE_BYTES + 1) as usize]
        )),
        Err(MachineError::File(FileError::TooLarge { .. }))
    ));
    let mine = write(
        "mine.toml",
        TNV40
            .replace("name = \"tnv40\"", "name = \"mine\"")
            .as_bytes(),
    );
    assert_eq!(load(&mine).unwrap().name, "mine");
}

#[test]
fn fingerprint_follows_the_content_and_nothing_else() {
    let parse = |from: &str, to: &str| {
        Machine::parse("x", &TNV40.replacen(from, to, 1))
            .unwrap()
            .fingerprint()
    };
    let original = tnv40().fingerprint();
    assert_eq!(original.len(), 64);
    assert_eq!(parse("name = \"tnv40\"", "name = \"other\""), original);
    assert_eq!(parse("kp_1_s = 50", "kp_1_s = 50.0"), original);
    assert_ne!(
        parse("kp_1_s = 50", "kp_1_s = 50.000000000000007"),
        original
    );
    let (two_axes, _) = TNV40
        .split_once("# The paper simulates X and Y only")
        .unwrap();
    assert_ne!(
        Machine::parse("x", two_axes).unwrap().fingerprint(),
        original
    );
}

#[test]
fn geometry_and_seed_are_read_upon_a_base_and_belong_to_the_fingerprint() {
    let words = "base = 'tnv40'\nname = 'n'\ndescription = 'd'\nsource = 's'\n";
    let machine = |tables: &str| Machine::parse("n.toml", &format!("{words}{tables}")).unwrap();
    let skewed =
        machine("[geometry]\nsquareness_yz_urad = -20\n[noise]\nseed = 9007199254740991\n");
    assert_eq!(
        (skewed.geometry.squareness_yz_urad, skewed.noise.seed),
        (-20.0, 9_007_199_254_740_991)
    );
    assert_eq!(
        machine("[noise]\nseed = 0\n[geometry]\nsquareness_xy_urad = 0\n").fingerprint(),
        tnv40().fingerprint()
    );
    for tables in [
        "[noise]\nseed = 1\n",
        "[geometry]\nsquareness_xy_urad = 1\n",
        "[axis.x]\nripple_per_rev = 6\n",
    ] {
        assert_ne!(
            machine(tables).fingerprint(),
            tnv40().fingerprint(),
            "{tables}"
        );
    }
    let fault = Machine::parse("n.toml", &format!("{words}[noise]\nseed = 1.5\n")).unwrap_err();
    assert!(
        format!("{fault:?}").contains("seed is 1.5; it must be a whole number"),
        "{fault:?}"
    );
}

#[test]
fn values_of_an_axis_that_do_not_go_together_are_reported() {
    for (line, says) in [
        (
            "interpolation_error_um = 0.5",
            "interpolation_error_um is 0.5, and signal_period_um is 0 or not there",
        ),
        (
            "stribeck_nm = 0.1",
            "stribeck_nm is 0.1, and stribeck_mm_s is 0 or not there",
        ),
        (
            "cogging_nm = 0.1",
            "cogging_nm is 0.1, and cogging_per_rev is 0 or not there",
        ),
        (
            "ripple = 0.1",
            "ripple is 0.1, and ripple_per_rev is 0 or not there",
        ),
        (
            "coulomb_asymmetry_nm = -0.21",
            "must lie within the Coulomb friction, 0.2 N m each way",
        ),
        (
            "jitter_s = 0.0011",
            "must lie within a servo period, 0.001 s",
        ),
    ] {
        let fault = fault_after("kd = 0 ", &format!("{line}\nkd = 0 "));
        assert!(fault.starts_with("32:") && fault.contains(says), "{fault}");
    }
    let text = TNV40.replacen("servo_s = 0.001", "servo_s = 0.0002", 1);
    for (key, delay, most) in [
        ("drive_delay_s", "0.0121", "0.012"),
        ("measurement_delay_s", "0.0121", "0.012"),
        ("command_delay_s", "0.0017", "0.0016"),
    ] {
        let fault = Machine::parse(
            "fast.toml",
            &text.replacen("kd = 0 ", &format!("{key} = {delay}\nkd = 0 "), 1),
        );
        assert!(
            format!("{:?}", fault.unwrap_err()).contains(&format!("it must be {most} s or less")),
            "{key}"
        );
    }
}

/// The tnv40 file with more at its end, which is in [plc].
fn with_events(text: &str) -> Result<Machine, MachineError> {
    Machine::parse("events.toml", &format!("{TNV40}\n{text}"))
}

#[test]
fn m_codes_may_be_given_a_meaning() {
    let text = "[plc.event.\"m 64 p3\"]\nrow = 'lamp'\nlabel = 'lamp on'\ntakes_s = 0.25\n\
                [plc.event.M101]\nrow = 'chuck'\nlabel = 'opens'\ntakes_s = 2\n";
    let events = with_events(text).unwrap().plc_events;
    let event = |code, p, row: &str, label: &str, takes_s| PlcEvent {
        code,
        p,
        row: row.to_owned(),
        label: label.to_owned(),
        takes_s,
    };
    assert_eq!(
        events,
        [
            event(64, Some(3), "lamp", "lamp on", 0.25),
            event(101, None, "chuck", "opens", 2.0)
        ]
    );
    assert_eq!(tnv40().plc_events, []);
}

#[test]
fn the_rate_of_rotary_axes_may_be_left_out() {
    assert_eq!(tnv40().plc.rotary_deg_s, 0.0);
    assert_eq!(
        with_events("rotary_deg_s = 90").unwrap().plc.rotary_deg_s,
        90.0
    );
    assert!(
        fault_after(
            "spindle_rev_min_s = 4000",
            "rotary_deg_s = -1\nspindle_rev_min_s = 4000"
        )
        .contains("degrees/s")
    );
}

#[test]
fn faults_of_named_m_codes_have_their_places() {
    let faults = |text: &str| match with_events(text) {
        Err(MachineError::File(FileError::Invalid { problems, .. })) => {
            problems.iter().map(ToString::to_string).collect::<Vec<_>>()
        }
        other => panic!("expected faults, got {other:?}"),
    };
    let rest = "row = 'lamp'\nlabel = 'on'\ntakes_s = 0\n";
    for (key, says) in [
        ("lamp", "names 'lamp', which is no M-code"),
        ("M", "no M-code"),
        ("M64P", "no M-code"),
        ("M64P-3", "no M-code"),
        ("M+64", "no M-code"),
        ("M10000", "no M-code"),
        ("M99999999999", "no M-code"),
        ("M6", "M6 cannot be given another meaning"),
    ] {
        let found = faults(&format!("[plc.event.'{key}']\n{rest}"));
        assert!(
            found.len() == 1 && found[0].contains(says),
            "{key}: {found:?}"
        );
    }
    assert!(faults("[plc.event]\nM100 = 'lamp'\n")[0].contains("table"));
    let twice = faults(&format!(
        "[plc.event.M100]\n{rest}[plc.event.'m 100']\n{rest}"
    ));
    assert!(
        twice.len() == 1 && twice[0].contains("named already"),
        "{twice:?}"
    );
    let found = faults("[plc.event.M100]\nrow = ' '\nlabel = 3\ntakes_s = -1\nlamp = 1\n");
    assert_eq!(found.len(), 4, "{found:?}");
}

#[test]
fn what_is_written_reads_as_the_same_machine() {
    for (name, _) in BUILT_IN_MACHINES {
        let machine = Machine::load(name.as_ref()).unwrap();
        assert_eq!(
            Machine::parse("written.toml", &machine.text()).unwrap(),
            machine,
            "{}",
            machine.text()
        );
    }
    let mut odd = Machine::load("soft".as_ref()).unwrap();
    odd.description = "a \"quoted\" \\ text\nof two lines".to_owned();
    odd.limits.path_tolerance_um = Some(7.5);
    for axis in &mut odd.axes {
        (
            axis.max_velocity_mm_s,
            axis.max_accel_mm_s2,
            axis.max_jerk_mm_s3,
        ) = (Some(150.0), Some(1e3), Some(2.5e5));
    }
    odd.axes[1].torque_bits = Some(12);
    odd.axes[1].encoder_step_um = 0.1 + 0.2;
    odd.axes[1].speed_from_encoder = true;
    odd.axes[2].coulomb_asymmetry_nm = -0.1;
    odd.geometry.squareness_xz_urad = -12.5;
    odd.noise.seed = 1 << 53;
    odd.plc_events = vec![PlcEvent {
        code: 64,
        p: Some(3),
        row: "lamp".into(),
        label: "lamp on".into(),
        takes_s: 0.1,
    }];
    assert_eq!(Machine::parse("written.toml", &odd.text()).unwrap(), odd);
}

/// The document's tables begin `| `key` | unit | range |`.
#[test]
fn the_document_has_the_units_and_ranges_of_all_keys() {
    let document = include_str!("../../../../docs/machine-file.md");
    let number = |value: f64| {
        let plain = value == 0.0 || (0.01..1000.0).contains(&value.abs());
        if plain {
            format!("{value}")
        } else {
            format!("{value:e}")
        }
    };
    let row = |name: &str, unit: &str, [least, most]: [f64; 2]| match unit {
        "(no unit)" => format!("| `{name}` | 1 | {} to {} |", number(least), number(most)),
        "(0 or 1)" => format!("| `{name}` | | 0 or 1 |"),
        unit => format!(
            "| `{name}` | {unit} | {} to {} |",
            number(least),
            number(most)
        ),
    };
    fn rows<T>(keys: &[Key<T>], row: impl Fn(&str, &str, [f64; 2]) -> String) -> Vec<String> {
        keys.iter()
            .map(|key| row(key.name, key.unit, key.range))
            .collect()
    }
    let all = [
        rows(keys::PERIOD, row),
        rows(keys::LIMITS, row),
        rows(keys::AXIS, row),
        rows(keys::TRANSMISSION, row),
        rows(keys::GEOMETRY, row),
        rows(keys::PLC, row),
    ];
    for row in all.concat() {
        assert!(
            document.contains(&row),
            "docs/machine-file.md has no row that begins {row}"
        );
    }
}

/// `tnv40` with `keys` added to its first `axes` axes and `tolerance` added to its limits.
fn limited(axes: usize, keys: &str, tolerance: &str) -> Result<Machine, MachineError> {
    let mut text = TNV40.to_owned();
    for name in &AXIS_NAMES[..axes] {
        text = text.replacen(
            &format!("[axis.{name}]\n"),
            &format!("[axis.{name}]\n{keys}"),
            1,
        );
    }
    Machine::parse(
        "limited.toml",
        &text.replacen("[limits]\n", &format!("[limits]\n{tolerance}"), 1),
    )
}

const ALL_LIMITS: &str = "max_velocity_mm_s = 200\nmax_accel_mm_s2 = 2000\nmax_jerk_mm_s3 = 5e4\n";
const TOLERANCE: &str = "path_tolerance_um = 10\n";

#[test]
fn limits_of_axes_are_given_for_all_or_for_none() {
    assert!(limited(3, ALL_LIMITS, TOLERANCE).unwrap().has_axis_limits());
    assert!(!tnv40().has_axis_limits());
    let said = |machine: Result<Machine, MachineError>| match machine {
        Err(MachineError::File(FileError::Invalid { problems, .. })) => problems
            .iter()
            .map(ToString::to_string)
            .collect::<Vec<_>>()
            .join("\n"),
        other => panic!("expected faults, got {other:?}"),
    };
    let some = said(limited(3, "max_velocity_mm_s = 200\n", TOLERANCE));
    assert!(
        some.contains("max_accel_mm_s2, max_jerk_mm_s3 missing"),
        "{some}"
    );
    assert!(said(limited(2, ALL_LIMITS, TOLERANCE)).contains("axis.z lacks"));
    assert!(limited(3, ALL_LIMITS, "").unwrap().has_axis_limits());
    assert!(said(limited(0, "", TOLERANCE)).contains("the axes have no limits of their own"));
    for value in ["0", "-5", "nan", "inf"] {
        let keys = ALL_LIMITS.replace("5e4", value);
        assert!(
            said(limited(3, &keys, TOLERANCE)).contains("max_jerk_mm_s3"),
            "{value}"
        );
        let tolerance = format!("path_tolerance_um = {value}\n");
        assert!(
            said(limited(3, ALL_LIMITS, &tolerance)).contains("path_tolerance_um"),
            "{value}"
        );
    }
}

#[test]
fn a_file_states_its_format_or_has_the_first_and_another_is_refused() {
    assert_eq!(MACHINE_FORMAT, 1);
    assert!(!TNV40.contains("format =") && tnv40().text().starts_with("format = 1\n"));
    let with = |format: &str| Machine::parse("mine.toml", &format!("format = {format}\n{TNV40}"));
    assert_eq!(with("1").unwrap(), tnv40());
    for (format, said) in [
        ("2", "is of format 2"),
        ("'one'", "format has to be a number"),
        ("0", "format is 0"),
    ] {
        let error = with(format).unwrap_err();
        let MachineError::File(FileError::Invalid { problems, .. }) = &error else {
            panic!("{error:?}")
        };
        assert!(
            problems.len() == 1 && problems[0].to_string().contains(said),
            "{format}: {problems:?}"
        );
    }
    let with_base = "format = 2\nbase = 'tnv40'\nname = 'a'\ndescription = 'b'\nsource = 'c'\n";
    assert!(Machine::parse("mine.toml", with_base).is_err());
    assert!(Machine::parse("mine.toml", &with_base.replace('2', "1")).is_ok());
}
