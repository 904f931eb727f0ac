//! Runs one kind of work a number of times, for counting its instructions with callgrind: see `just instructions`.
//!
//! `instructions paper-tick|servo-period|learn COUNT`. The difference of two counts divided by the difference of their
//! instructions leaves out what starting and ending a process costs.

#![expect(clippy::unwrap_used, reason = "an example that only the recipe calls")]

#[path = "../benches/rig.rs"]
mod rig;

use feedwright_control::window::Register;
use feedwright_control::contour_error::Estimator;
use feedwright_control::{Knot, Measured, Reference, Window};

fn main() {
    let mut arguments = std::env::args().skip(1);
    let (work, count) = (arguments.next().unwrap(), arguments.next().unwrap().parse::<u32>().unwrap());
    match work.as_str() {
        "paper-tick" => paper_tick(count),
        "servo-period" => {
            let mut rig = rig::Rig::<2>::new();
            (0..count).for_each(|_| _ = std::hint::black_box(rig.servo_period()));
        }
        "learn" => {
            let (mut net, inputs) = rig::network::<2>();
            (0..count).for_each(|_| _ = std::hint::black_box(net.learn(&inputs, [0.2, -0.1], 0.01)));
        }
        other => eprintln!("no work called {other}"),
    }
}

fn paper_tick(count: u32) {
    let mut register = Register::<2>::default();
    for i in 0..300 {
        register.push(rig::Circle.knot(f64::from(i) * 0.001));
    }
    let preview = [rig::Circle.knot(0.299), rig::Circle.knot(0.309)];
    let tool: Knot<2> = rig::Circle.knot(0.279);
    let contour = Estimator::default().estimate(&register, [tool.position_mm[0] + 0.02, tool.position_mm[1]]);
    let measured = Measured { position_mm: tool.position_mm, contour };
    let mut controller = rig::paper();
    for _ in 0..count {
        let window = Window { register: &register, preview: &preview, feed_period_s: 0.01, offset_mm: [0.0; 2] };
        std::hint::black_box(rig::decide(&mut controller, &window, &measured));
    }
}
