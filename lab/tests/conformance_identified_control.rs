//! A controller that was set up on an identified machine file cuts the machine that the log came
//! from well.

use crate::identification_log::log_of;
use feedwright::{Choices, LogJob, Setup, machine_text};
use feedwright_gcode::canon::Corner;
use feedwright_ident::AxisFacts;
use feedwright_lab::{CONTROLLERS, contour};
use feedwright_sim::{Machine, Row, Run, Sink};
use rayon::prelude::*;

/// A log of this time, s, in steps of this size, um.
const LOG_S: f64 = 5.0;
const STEP_UM: f64 = 1.0;
const FEED_MM_S: f64 = 50.0;
/// Largest RMS error with the identified file, um: the uncorrected cut has 16.
const MOST_UM: f64 = 0.5;

/// Mean square of the contour error while it cuts, um2.
#[derive(Default)]
struct ContourError([f64; 2]);

impl Sink for ContourError {
    fn row(&mut self, row: &Row) -> std::io::Result<()> {
        if row.cutting {
            self.0 = [
                self.0[0] + (1e3 * row.contour_error_mm).powi(2),
                self.0[1] + 1.0,
            ];
        }
        Ok(())
    }
}

/// RMS contour error on a machine, um, of a controller that was set up on another file of it.
fn rms_um(controller: &str, file: &Machine, machine: &Machine, name: &str) -> f64 {
    let choices = Choices::default();
    let mut controller = CONTROLLERS
        .find(controller)
        .unwrap()
        .in_plane(&mut Setup::new(file, &choices));
    let steps = contour(name)
        .unwrap()
        .steps(FEED_MM_S, Corner::ExactPath)
        .unwrap();
    let mut error = ContourError::default();
    let run = Run::on(machine)
        .cut_steps::<2>(&steps, &mut *controller, &mut [&mut error])
        .unwrap();
    assert_eq!(run.faded_out, None);
    (error.0[0] / error.0[1]).sqrt()
}

/// Most that a command delay costs a controller that knows it, as a multiple of the RMS error
/// without the delay.
const DELAYED: f64 = 2.0;

#[test]
fn a_known_command_delay_costs_no_more_than_as_much_again() {
    let machine = Machine::load("tnv40".as_ref()).unwrap();
    let late = |periods: u32| {
        let mut late = machine.clone();
        let delay_s = f64::from(periods) * machine.period.servo_s;
        late.axes
            .iter_mut()
            .for_each(|axis| axis.command_delay_s = delay_s);
        late
    };
    let cases: Vec<(&str, u32)> = ["lqg-identified", "feedforward"]
        .into_iter()
        .flat_map(|of| [1, 2, 3].map(|n| (of, n)))
        .collect();
    cases.par_iter().for_each(|&(controller, periods)| {
        let [prompt_um, late_um] = [0, periods]
            .map(late)
            .map(|machine| rms_um(controller, &machine, &machine, "circle"));
        assert!(
            late_um < DELAYED * prompt_um,
            "{controller}, {periods}: {late_um} um, {prompt_um} um without the delay"
        );
    });
}

#[test]
fn control_by_an_identified_file_leaves_hardly_any_error() {
    let machine = Machine::load("tnv40".as_ref()).unwrap();
    let facts = AxisFacts {
        record_delay_s: Some(0.0),
        ..AxisFacts::default()
    };
    let job = LogJob {
        name: "a log".to_owned(),
        facts,
        ..LogJob::default()
    };
    let found = job.run(log_of(&machine, LOG_S, STEP_UM, 21), &()).unwrap();
    let identified = Machine::parse("mine.toml", &machine_text(&found, "mine")).unwrap();
    // The regulator relies on a file that states encoder steps of 1 um and a residual of noise, so
    // it is cautious on a machine that has neither.
    let by_identified_um = rms_um("lqg-identified", &identified, &machine, "circle");
    eprintln!("{by_identified_um:.4} um by the identified file");
    assert!(by_identified_um < MOST_UM, "{by_identified_um} um");
}
