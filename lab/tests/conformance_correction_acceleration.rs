//! The default controller is no worse than uncorrected, however little or much the correction may accelerate.

use feedwright::{BASELINE, Choices, CutErrors, Make, Setup, Statistics, harm};
use feedwright_lab::{CONTROLLERS, HORIZON, Workpiece};
use feedwright_sim::{Machine, Run};
use rayon::prelude::*;

const CONTOURS: [&str; 4] = ["square", "circle", "star", "butterfly"];
const ACCELERATIONS_MM_S2: [f64; 4] = [100.0, 200.0, 400.0, 2000.0];

/// RMS and largest contour error.
fn errors(machine: &Machine, workpiece: &Workpiece, name: &str) -> CutErrors {
    let choices = Choices::default();
    let mut setup = Setup::new(machine, &choices);
    let mut controller = Make::<2>::make(CONTROLLERS.find(name).unwrap(), &mut setup);
    let mut statistics = Statistics::new();
    let run = Run::on(machine).cut_steps(&workpiece.steps, &mut *controller, &mut [&mut statistics]).unwrap();
    assert!(run.engaged_at_end, "{}: {name} is out of the loop at the end", workpiece.name);
    CutErrors { rms_um: statistics.rms_um(), max_um: statistics.max_um(), uncut_um: None }
}

#[test]
fn no_acceleration_of_the_correction_makes_a_cut_worse_than_uncorrected() {
    let tnv40 = Machine::load("tnv40".as_ref()).unwrap();
    let contours: Vec<Workpiece> =
        Workpiece::contours().into_iter().filter(|workpiece| CONTOURS.contains(&workpiece.name.as_str())).collect();
    assert_eq!(contours.len(), CONTOURS.len());
    contours.par_iter().for_each(|workpiece| {
        let uncorrected = errors(&tnv40, workpiece, BASELINE);
        for acceleration_mm_s2 in ACCELERATIONS_MM_S2 {
            let mut machine = tnv40.clone();
            machine.axes.iter_mut().for_each(|axis| axis.correction_accel_mm_s2 = Some(acceleration_mm_s2));
            let worse = harm(&uncorrected, &errors(&machine, workpiece, HORIZON));
            assert!(worse.is_empty(), "{} at {acceleration_mm_s2} mm/s2: {worse:?}", workpiece.name);
        }
    });
}
