//! `feedwright-lab ball-bar`: a ball bar on a simulated machine.
use std::process::ExitCode;

use feedwright::OutputFiles;
use feedwright::command::{Console, remark};
use feedwright_ident::{BallBarProgram, Circularity, GeometryInput, SimulatedBallBar};
use feedwright_sim::Machine;
use miette::{IntoDiagnostic, Result, WrapErr, miette};

use crate::command::args::ball_bar::BallBarArgs;
use crate::command::sweep::{say_place, write_text};

/// Samples of a circle: as many as usual bars take.
const SAMPLES: u32 = 3600;
/// Longest bar, mm.
const MOST_MM: f64 = 1000.0;
/// Noise above which it is no bar, um.
const MOST_UM: f64 = 1000.0;

pub(crate) fn run(args: &BallBarArgs, console: &Console) -> Result<ExitCode> {
    let &BallBarArgs {
        radius,
        feed,
        noise,
        encoders,
        seed,
        ..
    } = args;
    let machine = Machine::load(args.machine.as_ref())?;
    let most_mm_min = 60.0 * machine.limits.max_feed_mm_s;
    for (name, value, least, most) in [
        ("--radius", radius, 1.0, MOST_MM),
        ("--feed", feed, 1.0, most_mm_min),
        ("--noise", noise, 0.0, MOST_UM),
    ] {
        if !(least..=most).contains(&value) {
            return Err(miette!(
                "{name} is {value}; it must be from {least} to {most}"
            ));
        }
    }
    let bar = SimulatedBallBar {
        program: BallBarProgram {
            radius_mm: radius,
            feed_mm_min: feed,
            plane: [0, 1],
        },
        center_mm: [0.0; 3],
        noise_um: noise,
        samples: SAMPLES,
        calibrated: true,
        has_encoders: encoders,
        seed,
    };
    let read = |path| {
        let text = std::fs::read_to_string(path).into_diagnostic();
        text.wrap_err_with(|| format!("cannot read {path:?}"))
    };
    let text = match &args.program {
        Some(path) => bar.text_of(&machine, &read(path)?)?,
        None => bar.text(&machine)?,
    };
    let files = OutputFiles::new(args.program.as_deref());
    write_text(files, &args.out, &text, console)?;
    if let GeometryInput::Sets(sets) = GeometryInput::parse("the bar", &text, None)?
        && !console.is_quiet()
    {
        let found = sets.iter().filter_map(Circularity::of);
        found.for_each(|of| remark(&of.line()));
    }
    say_place(&args.out)
}
