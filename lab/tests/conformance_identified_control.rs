//! A controller that was set up on an identified machine file cuts the machine that the log came from nearly as well as one that was set up
//! on the true file.

use crate::identification_log::log_of;
use feedwright::{Choices, LogJob, Make, Setup, machine_text};
use feedwright_gcode::canon::Corner;
use feedwright_ident::AxisFacts;
use feedwright_lab::{CONTROLLERS, contour};
use feedwright_sim::{Machine, Row, Run, Sink};
use rayon::prelude::*;

/// A log of this time, s, in steps of this size, um.
const LOG_S: f64 = 5.0;
const STEP_UM: f64 = 1.0;
const FEED_MM_S: f64 = 50.0;
/// Largest RMS error with the identified file, as a multiple of the RMS error of the same
/// controller with the true file. Applies to `receding-horizon`.
const RATIO: f64 = 1.3;
/// Largest error of any of them, um: the uncorrected cut has 16.
const MOST_UM: f64 = 0.5;

/// Mean square of the contour error while it cuts, um2.
#[derive(Default)]
struct ContourError([f64; 2]);

impl Sink for ContourError {
    fn row(&mut self, row: &Row) -> std::io::Result<()> {
        if row.cutting {
            self.0 = [self.0[0] + (1e3 * row.contour_error_mm).powi(2), self.0[1] + 1.0];
        }
        Ok(())
    }
}

/// RMS contour error on a machine, um, of a controller that was set up on another file of it.
fn rms_um(controller: &str, file: &Machine, machine: &Machine, name: &str) -> f64 {
    let choices = Choices::default();
    let mut controller = Make::<2>::make(CONTROLLERS.find(controller).unwrap(), &mut Setup::new(file, &choices));
    let steps = contour(name).unwrap().steps(FEED_MM_S, Corner::ExactPath).unwrap();
    let mut error = ContourError::default();
    let run = Run::on(machine).cut_steps::<2>(&steps, &mut *controller, &mut [&mut error]).unwrap();
    assert_eq!(run.faded_out, None);
    (error.0[0] / error.0[1]).sqrt()
}

/// Most that a command delay costs a controller that knows it, as a multiple of the RMS error without the delay.
const DELAYED: f64 = 2.0;

#[test]
fn a_known_command_delay_costs_no_more_than_as_much_again() {
    let machine = Machine::load("tnv40".as_ref()).unwrap();
    let late = |periods: u32| {
        let mut late = machine.clone();
        let delay_s = f64::from(periods) * machine.period.servo_s;
        late.axes.iter_mut().for_each(|axis| axis.command_delay_s = delay_s);
        late
    };
    let cases: Vec<(&str, u32)> =
        ["lqg-identified", "feedforward"].into_iter().flat_map(|of| [1, 2, 3].map(|n| (of, n))).collect();
    cases.par_iter().for_each(|&(controller, periods)| {
        let [prompt_um, late_um] =
            [0, periods].map(late).map(|machine| rms_um(controller, &machine, &machine, "circle"));
        assert!(
            late_um < DELAYED * prompt_um,
            "{controller}, {periods}: {late_um} um, {prompt_um} um without the delay"
        );
    });
}

#[test]
fn control_by_an_identified_file_is_nearly_that_by_the_true_one() {
    let machine = Machine::load("tnv40".as_ref()).unwrap();
    let facts = AxisFacts { record_delay_s: Some(0.0), ..AxisFacts::default() };
    let job = LogJob { name: "a log".to_owned(), facts, ..LogJob::default() };
    let found = job.run(log_of(&machine, LOG_S, STEP_UM, 21), &()).unwrap();
    let identified = Machine::parse("mine.toml", &machine_text(&found, "mine")).unwrap();
    // The regulator trusts a file whose encoder has steps of 1 um and whose residual is noise: it is careful on a machine that has neither.
    let cases = [("receding-horizon", RATIO), ("lqg-identified", f64::INFINITY)];
    cases.par_iter().for_each(|&(controller, most)| {
        let [by_true, by_identified] = [&machine, &identified].map(|file| rms_um(controller, file, &machine, "circle"));
        let ratio = by_identified / by_true;
        eprintln!("{controller}: {by_true:.4} um by the true file, {by_identified:.4} um by the identified one");
        assert!(ratio <= most && by_identified < MOST_UM, "{controller}: {ratio}, {by_identified} um");
    });
}
