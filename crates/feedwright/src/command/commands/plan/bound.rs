//! The search for the bound of the motion, which has its time.

use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use feedwright_gcode::{Program, Settings};
use feedwright_plan::Constraints;
use feedwright_sim::cycle_time::bound_of_motion;
use feedwright_sim::{Cancelled, Watch, path_steps};
use miette::Result;

use crate::command::progress::Bar;

/// Longest search for the bound, s.
pub(super) const MOST_BOUND_S: u64 = 60;

/// The bound of the motion, as far as it was found in [`MOST_BOUND_S`].
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Bound {
    /// Time of the motion with each path from rest to rest planned as a whole, s.
    pub(super) time_s: f64,
    /// Motions of the program that this is for.
    pub(super) motions: u64,
    /// True if the bound covers all motions of the program.
    pub(super) is_whole: bool,
}

/// Looks for the bound. One long path is one step of that, which nothing ends from outside: it is
/// left to itself when the time is over.
pub(super) fn bound(
    program: &Program,
    settings: &Settings,
    constraints: Constraints,
    bar: &Bar,
) -> Result<Bound> {
    bar.begin("planning each path as a whole", 1);
    let (sender, receiver) = mpsc::channel();
    let (program, settings) = (program.clone(), settings.clone());
    std::thread::spawn(move || {
        let mut so_far = Bound::default();
        let steps = || {
            Ok(path_steps(
                program
                    .reader(settings.clone())?
                    .map_while(std::result::Result::ok),
            ))
        };
        let all = bound_of_motion(&constraints, steps, |phase| {
            so_far = Bound {
                time_s: so_far.time_s + phase.duration_s,
                motions: phase.piece + 1,
                is_whole: false,
            };
            // Nobody listens any more: the time is over.
            sender.send(Ok(so_far)).map_err(|_| Cancelled)
        });
        let _ = sender.send(all.map(|()| Bound {
            is_whole: true,
            ..so_far
        }));
    });
    let mut found = Bound::default();
    let until = bar.clock() + Duration::from_secs(MOST_BOUND_S);
    while !found.is_whole && bar.clock() < until {
        bar.check()?;
        match receiver.recv_timeout(Duration::from_millis(100)) {
            Ok(next) => found = next?,
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    Ok(found)
}
