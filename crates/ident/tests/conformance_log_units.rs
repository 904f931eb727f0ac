//! A unit that a log states is converted or refused, never ignored, whether columns are found by
//! their names or by what they hold.

use crate::logs::{SAMPLES, axis, read, reported, rows, time_s};
use feedwright_ident::{LogError, TorqueUnit};

/// Rounding of numbers that were written as text, mm.
const ROUNDING_MM: f64 = 1e-9;

fn scaled(values: &[f64], by: f64) -> Vec<f64> {
    values.iter().map(|value| value * by).collect()
}

/// A log of one axis in these numbers for 1 mm, and of a torque that counts samples.
fn log(header: &str, per_mm: [f64; 2]) -> String {
    let (command, actual) = axis(20.0, 1.0);
    let torque: Vec<f64> = (0..SAMPLES).map(|k| k as f64 % 7.0).collect();
    let columns = [
        time_s(),
        scaled(&command, per_mm[0]),
        scaled(&actual, per_mm[1]),
        torque,
    ];
    format!(
        "{header}\n{}",
        rows(&columns.each_ref().map(Vec::as_slice), ",")
    )
}

#[test]
fn a_unit_that_is_not_known_is_refused_with_its_column_and_the_known_ones() {
    for (header, column, unit, known) in [
        (
            "t,x_cmd [cnt],x_act [cnt],q",
            "'x_cmd [cnt]'",
            "'cnt'",
            "mm, um, m or inch",
        ),
        (
            "t,x_cmd,x.act (furlong),q",
            "'x.act (furlong)'",
            "'furlong'",
            "mm, um, m or inch",
        ),
        (
            "t,x_cmd_counts,x_act_counts,q",
            "'x_cmd_counts'",
            "'counts'",
            "mm, um, m or inch",
        ),
        (
            "t,x_cmd [mm] (X),x_act [mil],q",
            "'x_act [mil]'",
            "'mil'",
            "mm, um, m or inch",
        ),
        // What the columns are is guessed.
        (
            "t,p1 [mil],p2 [mil],q",
            "'p1 [mil]'",
            "'mil'",
            "mm, um, m or inch",
        ),
        (
            "t,p1 ticks,p2 ticks,q",
            "'p1 ticks'",
            "'ticks'",
            "mm, um, m or inch",
        ),
        (
            "t,first,second,q\ns,mils,mils,",
            "'first'",
            "'mils'",
            "mm, um, m or inch",
        ),
        (
            "t,x cmd,x act,q\ns,furlong,furlong,-",
            "'x cmd'",
            "'furlong'",
            "mm, um, m or inch",
        ),
        (
            "t,x_cmd,x_act,x_torque [mil]",
            "'x_torque [mil]'",
            "'mil'",
            "N m, mN m",
        ),
        (
            "t,x_cmd,x_act,x_current (lb)",
            "'x_current (lb)'",
            "'lb'",
            "A, mA or %",
        ),
        (
            "t [fortnight],x_cmd,x_act,q",
            "'t [fortnight]'",
            "'fortnight'",
            "s, ms, us, ns or samples",
        ),
    ] {
        let error = read(log(header, [1.0; 2]).as_bytes(), "").unwrap_err();
        let LogError::Columns { message, hint, .. } = &error else {
            panic!("{header}: {error:?}")
        };
        for part in [column, unit, known] {
            assert!(message.contains(part), "{header}: {message} lacks {part}");
        }
        assert!(hint.contains("--columns"), "{header}: {hint}");
    }
}

#[test]
fn a_line_that_states_a_unit_that_is_not_known_is_refused_with_its_number() {
    for (unit, shown) in [("furlong", "furlong"), ("mil", "mil"), ("Counts", "counts")] {
        let text = log(
            &format!("# a log\n# unit = {unit}\nt,x_cmd,x_act,q"),
            [1.0; 2],
        );
        let error = read(text.as_bytes(), "").unwrap_err();
        let message = error.to_string();
        assert!(
            message.contains("line 2: positions are in") && message.contains(&format!("'{shown}'")),
            "{message}"
        );
        read(text.as_bytes(), "unit=mm").unwrap();
    }
    let error = read(
        log("# unit = inch\nt,x_cmd_mm,x_act_mm,q", [1.0; 2]).as_bytes(),
        "",
    )
    .unwrap_err()
    .to_string();
    assert!(
        error.contains("in inch, and a column that it is in mm"),
        "{error}"
    );
}

#[test]
fn what_is_said_of_a_unit_goes_before_what_is_written() {
    let (command, _) = axis(20.0, 1.0);
    let read =
        |header: &str, columns: &str| read(log(header, [1.0; 2]).as_bytes(), columns).unwrap();
    let found = read("t [tick],x_cmd [cnt],x_act [cnt],q", "unit=um,time=s");
    assert!((found.axes[0].command_mm[700] - 1e-3 * command[700]).abs() < ROUNDING_MM);
    // Columns that are not used may be in any unit.
    read("t,x_cmd,x_act,spindle [furlong]", "");
    read("t,x_cmd,x_act,x_torque [mil]", "t=0,x.cmd=1,x.act=2");
}

#[test]
fn known_units_are_converted_where_columns_are_guessed_too() {
    let (command, actual) = axis(20.0, 1.0);
    const PER_MM: [(&str, f64); 5] = [
        ("mm", 1.0),
        ("m", 1e-3),
        ("um", 1e3),
        ("inch", 1.0 / 25.4),
        ("in", 1.0 / 25.4),
    ];
    for (unit, per_mm) in PER_MM {
        for (other, other_per_mm) in PER_MM {
            for header in [
                format!("t [s],x_cmd [{unit}],x_act ({other}),q"),
                format!("t,p1 [{unit}],p2 [{other}],q"),
                format!("t,x_cmd_{unit},x_act_{other},q"),
                format!("t,x cmd,x act,q\ns,{unit},{other},"),
            ] {
                let found = read(log(&header, [per_mm, other_per_mm]).as_bytes(), "");
                // Numbers of other sizes do not look alike where nothing but them says what belongs
                // together.
                let Ok(found) = found else {
                    assert!(
                        header.contains("p1") && unit != other,
                        "{header}: {found:?}"
                    );
                    continue;
                };
                for (found, wanted) in [
                    (&found.axes[0].command_mm, &command),
                    (&found.axes[0].actual_mm, &actual),
                ] {
                    let worst = found
                        .iter()
                        .zip(wanted)
                        .map(|(a, b)| (a - b).abs())
                        .fold(0.0, f64::max);
                    assert!(worst < ROUNDING_MM, "{header}: {worst} mm");
                }
                assert!(
                    !reported(&found).contains("guessed, as the command goes"),
                    "{header}: {}",
                    reported(&found)
                );
            }
        }
    }
}

#[test]
fn torques_come_in_the_unit_of_their_column() {
    for (unit, wanted, scale) in [
        ("N m", TorqueUnit::NewtonMetre, 1.0),
        ("Nm", TorqueUnit::NewtonMetre, 1.0),
        ("mNm", TorqueUnit::NewtonMetre, 1e-3),
        ("N", TorqueUnit::Newton, 1.0),
        ("A", TorqueUnit::Ampere, 1.0),
        ("mA", TorqueUnit::Ampere, 1e-3),
        ("V", TorqueUnit::Volt, 1.0),
        ("%", TorqueUnit::Percent, 1.0),
    ] {
        let found = read(
            log(&format!("t,x_cmd,x_act,x_torque [{unit}]"), [1.0; 2]).as_bytes(),
            "",
        )
        .unwrap();
        let torque = found.axes[0].torque.as_ref().unwrap();
        assert_eq!(
            (found.axes[0].torque_unit, torque[5]),
            (wanted, 5.0 * scale),
            "{unit}"
        );
    }
}

#[test]
fn times_and_speeds_come_in_the_units_of_their_columns() {
    let (command, actual) = axis(20.0, 1.0);
    for (unit, per_s) in [
        ("s", 1.0),
        ("ms", 1e3),
        ("us", 1e6),
        ("\u{b5}s", 1e6),
        ("ns", 1e9),
    ] {
        for header in [
            format!("t [{unit}],x_cmd,x_act"),
            format!("f0 [{unit}],p1,p2"),
        ] {
            let times: Vec<f64> = (0..SAMPLES).map(|k| 0.001 * per_s * k as f64).collect();
            let text = format!("{header}\n{}", rows(&[&times, &command, &actual], ","));
            let found = read(text.as_bytes(), "").unwrap();
            assert!(
                (found.sample_time_s - 0.001).abs() < 1e-9,
                "{header}: {} s",
                found.sample_time_s
            );
        }
    }
    // Without a time column the speed determines the time between samples.
    let speed: Vec<f64> = (0..SAMPLES)
        .map(|k| (actual[(k + 1).min(SAMPLES - 1)] - actual[k.max(1) - 1]) / 0.004)
        .collect();
    for (unit, per_mm_s) in [
        ("mm/s", 1.0),
        ("mm/min", 60.0),
        ("inch/min", 60.0 / 25.4),
        ("m/s", 1e-3),
    ] {
        let text = format!(
            "x_cmd [mm],x_act [mm],x_vel [{unit}]\n{}",
            rows(&[&command, &actual, &scaled(&speed, per_mm_s)], ",")
        );
        let found = read(text.as_bytes(), "").unwrap();
        assert!(
            (found.sample_time_s - 0.002).abs() < 1e-9,
            "{unit}: {} s",
            found.sample_time_s
        );
    }
}

#[test]
fn angles_are_rotary_whoever_says_what_the_columns_are() {
    for unit in ["deg", "rad", "\u{b0}"] {
        let text = log(&format!("t,x_cmd [mm],x_act [mm],b_cmd [{unit}]"), [1.0; 2]);
        assert_eq!(read(text.as_bytes(), "").unwrap().axes.len(), 1, "{unit}");
        for header in [
            format!("t,x_cmd [{unit}],x_act [{unit}],q"),
            format!("t,p1 [{unit}],p2 [{unit}],q"),
        ] {
            let error = read(log(&header, [1.0; 2]).as_bytes(), "")
                .unwrap_err()
                .to_string();
            assert!(error.contains("rotary"), "{header}: {error}");
        }
        let error = read(
            log(&format!("t,p1 [{unit}],p2 [{unit}],q"), [1.0; 2]).as_bytes(),
            "t=0,x.cmd=1,x.act=2",
        );
        assert!(
            error
                .unwrap_err()
                .to_string()
                .contains(&format!("'{unit}'")),
            "{unit}"
        );
    }
}
