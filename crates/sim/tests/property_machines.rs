//! Machines with a soft screw, late drives and coarse encoders stay machines: they follow a slow
//! line, and what is measured is what the encoder can show.

use feedwright_sim::{Machine, Plant, Transmission};
use proptest::prelude::*;

/// Feedrate of the line, mm/s.
const FEED_MM_S: f64 = 10.0;

fn tnv40() -> Machine {
    Machine::load("tnv40".as_ref()).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn a_slow_line_is_followed_within_its_lag(
        resonance_hz in 30.0..150.0, share in 0.2..0.8, backlash_um in 0.0..20.0, delay_s in 0.0..0.003, step_um in 0.0..5.0,
        scale_on_table in any::<bool>()
    ) {
        let mut machine = tnv40();
        for axis in &mut machine.axes {
            axis.transmission =
                Some(Transmission { table_share: share, resonance_hz, damping_ratio: 0.05, backlash_um, scale_on_table });
            axis.drive_delay_s = delay_s;
            axis.encoder_step_um = step_um;
        }
        let lag_mm = FEED_MM_S / machine.axes[0].kp_1_s;
        let mut plant = Plant::<2>::new(&machine, [0.0; 2]);
        for n in 0..2000_u32 {
            let command_mm = FEED_MM_S * machine.period.servo_s * f64::from(n);
            let measured = plant.step([command_mm, -command_mm]);
            for (axis, sign) in [1.0, -1.0].into_iter().enumerate() {
                let off_mm = sign * command_mm - measured.position_mm[axis];
                prop_assert!(off_mm.abs() <= 3.0 * lag_mm, "{n}: {off_mm} mm");
                let steps = measured.measured_mm[axis] * 1e3 / step_um;
                prop_assert!(step_um == 0.0 || (steps - steps.round()).abs() < 1e-6, "{steps}");
            }
        }
    }
}

#[test]
fn a_machine_without_these_parts_measures_where_it_is() {
    let mut plant = Plant::<2>::new(&tnv40(), [1.0, -2.0]);
    for n in 0..100 {
        let measured = plant.step([1.0 + 0.01 * f64::from(n), -2.0]);
        assert_eq!(measured.position_mm, measured.measured_mm);
    }
}

/// Machines of the folder that are not built in.
const REAL: [&str; 3] = ["workshop", "stiff", "router"];

#[test]
fn real_machines_follow_a_slow_line_whatever_the_seed() {
    for name in REAL {
        let file =
            std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("machines/{name}.toml"));
        let machine = Machine::read(&file).unwrap();
        assert_eq!((machine.name.as_str(), machine.axis_count()), (name, 3));
        for seed in 0..5 {
            let mut plant = Plant::<3>::with_seed(&machine, [0.0; 3], seed);
            let lag_mm = FEED_MM_S / machine.axes[0].kp_1_s;
            let periods = (2.0 / machine.period.servo_s) as u32;
            for n in 0..periods {
                let command_mm = FEED_MM_S * machine.period.servo_s * f64::from(n);
                let measured = plant.step([command_mm, -command_mm, 0.5 * command_mm]);
                for (axis, part) in [1.0, -1.0, 0.5].into_iter().enumerate() {
                    let off_mm = part * command_mm - measured.joint_mm[axis];
                    assert!(
                        off_mm.abs() <= lag_mm + 0.05,
                        "{name}, seed {seed}, {n}: {off_mm} mm"
                    );
                }
            }
        }
    }
}

#[test]
fn every_value_of_a_real_machine_has_a_reason() {
    for name in REAL {
        let file =
            std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("machines/{name}.toml"));
        for (number, line) in std::fs::read_to_string(file).unwrap().lines().enumerate() {
            if line.contains(" = ") && !line.contains('"') && !line.starts_with('#') {
                assert!(
                    line.contains(" # "),
                    "{name}, line {} has no reason: {line}",
                    number + 1
                );
            }
        }
    }
}

#[test]
fn files_that_build_upon_each_other_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, base: &str| {
        let text = format!("base = '{base}'\nname = 'n'\ndescription = 'd'\nsource = 's'\n");
        std::fs::write(folder.path().join(name), text).unwrap();
    };
    write("a.toml", "b.toml");
    for (base, name) in [
        ("a.toml", "b.toml"),
        ("b.toml", "b.toml"),
        ("../x/a.toml", "b.toml"),
    ] {
        let base = base.replace(
            "../x",
            &format!("../{}", folder.path().file_name().unwrap().display()),
        );
        write(name, &base);
        let circular = format!(
            "{:?}",
            Machine::read(&folder.path().join("a.toml")).unwrap_err()
        );
        assert!(
            circular.contains("builds upon this machine in turn"),
            "{base}: {circular}"
        );
    }
}

#[test]
fn a_file_upon_a_base_has_what_it_does_not_say() {
    let heavy = Machine::load("heavy".as_ref()).unwrap();
    assert_eq!(heavy.limits, tnv40().limits);
    for (heavy, base) in heavy.axes.iter().zip(&tnv40().axes) {
        assert_eq!(heavy.inertia_kg_m2, 2.0 * base.inertia_kg_m2);
        assert_eq!(heavy.kp_1_s, base.kp_1_s);
    }
    let faults = |text: &str| Machine::parse("x.toml", text).unwrap_err();
    let words = "name = \"a\"\ndescription = \"b\"\nsource = \"c\"\n";
    let chained = Machine::parse("x.toml", &format!("base = \"heavy\"\n{words}")).unwrap();
    assert_eq!(
        (&chained.axes, &chained.limits),
        (&heavy.axes, &heavy.limits)
    );
    for name in ["heavy.toml", "heavy", "tnv40.toml"] {
        let named_as_its_base =
            Machine::parse(name, &format!("base = \"heavy\"\n{words}")).unwrap();
        assert_eq!(named_as_its_base.axes, heavy.axes, "{name}");
    }
    let unknown = faults(&format!("base = \"tnv4\"\n{words}"));
    assert_eq!(
        unknown.to_string().split(';').next(),
        Some("no machine is called 'tnv4'")
    );
    let fast = faults(&format!(
        "base = \"tnv40\"\n{words}[axis.x.transmission]\ntable_share = 0.5\nresonance_hz = 900\ndamping_ratio = 0.1\nbacklash_um = 0\n"
    ));
    assert!(
        format!("{fast:?}").contains("mechanics_s has to be"),
        "{fast:?}"
    );
}
