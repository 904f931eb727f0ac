//! The default controller with a model of one machine, on machines that differ from it: it learns
//! the difference while it cuts.

use std::path::Path;
use std::sync::Arc;

use feedwright::BEST;
use feedwright_gcode::Settings;
use feedwright_lab::mismatch::{Variants, variants};
use feedwright_lab::{CONTROLLERS, Cutter, Length, SweepOptions, SweepProgram};
use feedwright_sim::Machine;

/// Largest part of the uncorrected RMS error that may remain, in addition to the error with the
/// exact model: the first tenth of a second of motion.
const LEFT: f64 = 0.2;
/// The same for half of the cuts.
const LEFT_OF_HALF: f64 = 0.02;

#[test]
fn what_a_model_gets_wrong_is_learned_while_cutting_and_nothing_is_worse() {
    let star = Path::new(env!("CARGO_MANIFEST_DIR")).join("../parts/star.ngc");
    for (name, differences) in [
        (
            "workshop",
            [
                "inertia1.40",
                "friction1.80",
                "kp0.97",
                "feedforward0.93",
                "delay+0.8ms",
                "drawn10-0",
            ],
        ),
        (
            "stiff",
            [
                "inertia0.80",
                "friction0.75",
                "kp1.08",
                "kv0.85",
                "ti1.20",
                "drawn20-0",
            ],
        ),
        (
            "tnv40",
            [
                "inertia1.25",
                "friction1.50",
                "kp0.92",
                "kv1.15",
                "delay+0.4ms",
                "drawn20-0",
            ],
        ),
    ] {
        let base = Arc::new(Machine::load(name.as_ref()).unwrap());
        let length = Length(&base, 60.0);
        let program = SweepProgram::read(&star, &Settings::default(), length).unwrap();
        let options = SweepOptions::of(vec![CONTROLLERS.find(BEST).unwrap()]);
        let mut cutter = Cutter::new(&base, &options);
        let all = variants(
            &base,
            Variants {
                gross: false,
                drawn: 1,
                seed: 77,
            },
        );
        let exact = cutter.rows(&program, &all[0], &()).unwrap()[0].rms_ratio();
        let mut more = vec![];
        for difference in differences {
            let wanted = format!("{name}-{difference}");
            let machine = all
                .iter()
                .find(|machine| machine.name == wanted)
                .expect(&wanted);
            let row = &cutter.rows(&program, machine, &()).unwrap()[0];
            assert_eq!(row.faults(), [], "{wanted}: {row:?}");
            more.push(row.rms_ratio() - exact);
        }
        more.sort_by(f64::total_cmp);
        assert!(
            more[more.len() / 2] < LEFT_OF_HALF && more[more.len() - 1] < LEFT,
            "{name}: {exact}, and {more:?}"
        );
    }
}
