//! Faults that once occurred, as small as they could be made.

use feedwright::{BEST, Choices, Setup, Statistics};
use feedwright_gcode::canon::Canon;
use feedwright_gcode::{Reader, Settings};
use feedwright_lab::{CONTROLLERS, Workpiece};
use feedwright_sim::{Machine, Run};

/// Found by mutation: each call made two more and an error, and the reader counted millions of
/// them.
#[test]
fn a_program_that_errs_ever_more_often_is_given_up() {
    let text = "o<twice> sub\nG1 [oops\no<twice> call\no<twice> call\no<twice> endsub\nG1 X1 F100\no<twice> call\nM2\n";
    let mut reader = Reader::from_text("twice.ngc", text, Settings::default()).unwrap();
    let faults: Vec<_> = reader.by_ref().filter_map(Result::err).collect();
    let last = faults.last().unwrap();
    assert!(
        last.message
            .contains("the rest of the program was not read"),
        "{}",
        last.message
    );
    assert!(reader.lines() < 1_000_000, "{} lines", reader.lines());
}

/// One line made millions of motions, which are held until they are read: gigabytes from forty
/// bytes.
#[test]
fn no_line_makes_more_motions_than_fit_into_memory() {
    for (name, text, place) in [
        (
            "pecks",
            "G21 G90 F100\nG0 Z5\nG83 X1 Z-1000 R1 Q0.0002\nM2\n",
            3,
        ),
        (
            "holes",
            "G21 G91 F100\nG83 X1 Z-1 R1 Q0.01 L100000\nM2\n",
            2,
        ),
        (
            "passes",
            "G18 G21 G8 F100\nG0 X30 Z5\no1 sub\n#1 = 0\no1 while [#1 LT 2000]\nG1 X[10+#1*0.001] Z[-#1*0.001]\n#1 = [#1+1]\n\
             o1 endwhile\no1 endsub\nG70 Q1 P9999\nM2\n",
            10,
        ),
    ] {
        let reader = Reader::from_text(name, text, Settings::default()).unwrap();
        let (mut steps, mut faults) = (0, Vec::new());
        for step in reader {
            match step {
                Ok(_) => steps += 1,
                Err(fault) => faults.push(fault),
            }
        }
        assert!(steps < 1_000_000, "{name}: {steps} steps");
        assert!(
            faults.iter().any(|fault| fault.line == place),
            "{name}: {faults:?}"
        );
    }
}

/// Found by mutation: behind a profile of one motion, which is not cut, the next motion began where
/// the profile ended.
#[test]
fn a_profile_that_is_not_cut_moves_nothing() {
    let text = "G18 G21 F400\no100 sub\nG1 X5000 Z-40\no100 endsub\nG72 Q100 X50 Z0 I3 R0.1\nG0 X0 Z0\nM30\n";
    let steps = Reader::from_text("short.ngc", text, Settings::default())
        .unwrap()
        .map(Result::unwrap);
    let motions: Vec<_> = steps
        .filter_map(|step| {
            if let Canon::Motion(motion) = step {
                Some(motion)
            } else {
                None
            }
        })
        .collect();
    for pair in motions.windows(2) {
        assert_eq!(pair[0].end_mm, pair[1].start_mm);
    }
    assert_eq!(motions.last().unwrap().start_mm, [50.0, 0.0, 0.0]);
}

/// Found by mutation: cutter compensation inside a profile let its motions out.
#[test]
fn a_profile_with_cutter_compensation_lets_nothing_out() {
    let text = "G18 G21 F400\nG0 X60 Z5\no1 sub\nG17\nG42.1 D1\nG1 X1\nG1 Z-5\nG40\nG18\nG1 X50\no1 endsub\nG72 Q1 I3\nM30\n";
    let steps: Vec<_> = Reader::from_text("held.ngc", text, Settings::default())
        .unwrap()
        .collect();
    assert!(steps.iter().any(|step| {
        step.as_ref()
            .is_err_and(|fault| fault.message.contains("inside the profile"))
    }));
    let out = |step: &Result<Canon, _>| matches!(step, Ok(Canon::Motion(motion)) if (5..=11).contains(&motion.line));
    assert!(!steps.iter().any(out), "{steps:?}");
}

/// Found by mutation: rounding left an arc's start behind its end, and a level was clamped between
/// them.
#[test]
fn levels_of_a_profile_whose_arc_runs_back_by_rounding() {
    let text = "G21 G18 G8 G90 F100\nG0 X30 Z5\nO100 SUB\nG0 X12\nG1 Z-15\nX9 Z-12\nZ-9\nX14 Z-7\nX21100\nG0 X30 Z5\nG0 X12\nG1\n\
                O100 ENDSUB\nG71 Q100 X20 Z-25 D.5 I2\nX50\nM2\n";
    let steps = Reader::from_text("back.ngc", text, Settings::default())
        .unwrap()
        .count();
    assert!(steps > 10, "{steps} steps");
}

/// Found by mutation: F that is divided by next to nothing, times a length, a spindle speed or the
/// inch.
#[test]
fn a_feed_beyond_all_numbers_is_still_a_number() {
    for feed in [
        "G93 G1 X900000 F#1",
        "G95 S#1 M3 G1 X9 F#1",
        "G20 G94 G1 X9 F#1",
        "G20 G94 G1 A9 F#1",
    ] {
        let text = format!("G21\n#1=[1/0.{}1]\n{feed}\nM2\n", "0".repeat(307));
        let steps: Vec<_> = Reader::from_text("fast.ngc", text, Settings::default())
            .unwrap()
            .collect();
        let finite = |step: &Result<Canon, _>| matches!(step, Ok(Canon::Motion(motion)) if motion.feed_mm_s.is_finite());
        assert!(steps.iter().any(finite), "{feed}: {steps:?}");
        assert!(
            steps
                .iter()
                .all(|step| !matches!(step, Ok(Canon::Motion(_))) || finite(step)),
            "{feed}: {steps:?}"
        );
    }
}

/// Checks a former fault: where the plan came to rest, a command a thousandth of a millimetre off
/// was taken back to a point of the path 1.7 mm behind. Along the path a command may be ahead or
/// behind.
#[test]
fn without_any_deviation_the_command_stays_where_the_path_is() {
    let mut machine = Machine::load("tnv40".as_ref()).unwrap();
    machine.limits.max_deviation_mm = 0.0;
    let choices = Choices::default();
    let workpiece = Workpiece::contours()
        .into_iter()
        .find(|workpiece| workpiece.name == "square")
        .unwrap();
    let mut setup = Setup::new(&machine, &choices);
    let mut controller = CONTROLLERS.find(BEST).unwrap().in_plane(&mut setup);
    let mut statistics = Statistics::new();
    Run::on(&machine)
        .cut_steps(&workpiece.steps, &mut *controller, &mut [&mut statistics])
        .unwrap();
    let off_um = statistics.max_deviation_um();
    assert!(
        off_um < 200.0,
        "the command is up to {off_um} um from its place on the path"
    );
}
