//! Runs one kind of work a number of times, for counting its instructions with callgrind: see `just
//! instructions`.
//!
//! `instructions paper-tick|servo-period|regulator-period|screw-period|learn COUNT`. The difference
//! of two counts divided by the difference of their instructions leaves out what starting and
//! ending a process costs.

#![expect(clippy::unwrap_used, reason = "an example that only the recipe calls")]

#[path = "../benches/rig.rs"]
mod rig;

use feedwright_control::{ContourModel, Controller};

fn main() {
    let mut arguments = std::env::args().skip(1);
    let (work, count) = (
        arguments.next().unwrap(),
        arguments.next().unwrap().parse::<u32>().unwrap(),
    );
    match work.as_str() {
        "paper-tick" => decide(&mut rig::paper(), count),
        "servo-period" => live(rig::Rig::new(rig::paper(), rig::Tool::OnThePath), count),
        "regulator-period" => live(
            rig::Rig::new(rig::regulator(false), rig::Tool::Follows),
            count,
        ),
        "screw-period" => live(
            rig::Rig::new(rig::regulator(true), rig::Tool::Follows),
            count,
        ),
        "learn" => {
            let (mut net, inputs) = rig::network::<2>();
            (0..count)
                .for_each(|_| _ = std::hint::black_box(net.learn(&inputs, [0.2, -0.1], 0.01)));
        }
        other => eprintln!("no work called {other}"),
    }
}

fn decide(controller: &mut impl Controller<2>, count: u32) {
    let surroundings = rig::Surroundings::<2>::new();
    let (window, measured) = (surroundings.window(), surroundings.measured());
    for _ in 0..count {
        std::hint::black_box(rig::decide(
            controller,
            std::hint::black_box(&window),
            &measured,
        ));
    }
}

fn live(mut rig: rig::Rig<2, impl Controller<2>>, count: u32) {
    (0..count).for_each(|_| _ = std::hint::black_box(rig.servo_period()));
    rig.expect_in_the_loop();
}
