//! Generated work: random programs on random machines, and the smallest case of each failure.

use std::sync::Arc;

use feedwright::JobError;
use feedwright_sim::{Cancelled, Watch};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::cut::{Cutter, SweepRow};
use super::program::{Length, SweepProgram};
use super::verdict::Failure;
use super::{SweepJob, SweepOptions};
use crate::held_out::machines::{self, Class};
use crate::held_out::{Case, Change, programs, shrink};

/// Machining time of a program beyond which the rest is left out, s: a feedrate of 100 mm/min makes a long path last.
pub const LIMIT_S: f64 = 30.0;
/// Seeds of programs and machines are below this, so that people can read them out.
const SEEDS: u64 = 1_000_000_000;

/// A generated job and what it was made of.
#[derive(Debug, Clone)]
pub struct Generated {
    /// Program and machine as text.
    pub case: Case,
    /// The same, ready to be cut.
    pub job: SweepJob,
}

/// Draws `count` jobs from a seed, with `for_each` programs for each machine, because identifying a
/// machine takes as long as several cuts. The first jobs of a seed are the same for every `count`.
///
/// # Errors
/// Fails if a generated program is rejected, which is a fault of the generator.
pub fn draw(seed: u64, count: usize, for_each: usize, class: Class) -> Result<Vec<Generated>, JobError> {
    let mut seeds = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut all = Vec::with_capacity(count);
    while all.len() < count {
        let variant = machines::machine(seeds.random_range(0..SEEDS), class);
        let machine = Arc::new(variant.machine().expect("only valid machines are drawn"));
        for _ in 0..for_each {
            let drawn = programs::program(seeds.random_range(0..SEEDS));
            let length = Length { machine: &machine, limit_s: LIMIT_S };
            let program = Arc::new(SweepProgram::from_text(&drawn.name, &drawn.text, length)?);
            let case = Case::new(&drawn.text, variant.clone());
            all.push(Generated { case, job: SweepJob { program, machine: machine.clone(), model: machine.clone() } });
        }
    }
    all.truncate(count);
    Ok(all)
}

/// Cuts cases, and keeps the controller as long as the machine stays the same.
pub struct Trials<'a> {
    options: &'a SweepOptions,
    watch: &'a dyn Watch,
    cutter: Option<(Vec<Change>, Cutter)>,
}

impl<'a> Trials<'a> {
    /// None yet.
    pub const fn new(options: &'a SweepOptions, watch: &'a dyn Watch) -> Self {
        Self { options, watch, cutter: None }
    }

    /// What a case comes to; nothing where it is no program, no stable machine, or ended from outside.
    pub fn row(&mut self, case: &Case) -> Option<SweepRow> {
        let machine = Arc::new(case.machine.machine().ok().filter(machines::is_stable)?);
        let length = Length { machine: &machine, limit_s: LIMIT_S };
        let program = SweepProgram::from_text("smallest", &case.text(), length).ok()?;
        let is_other = self.cutter.as_ref().is_none_or(|(changes, _)| *changes != case.machine.changes);
        if is_other {
            self.cutter = Some((case.machine.changes.clone(), Cutter::new(&machine, self.options)));
        }
        self.cutter.as_mut()?.1.rows(&program, &machine, self.watch).ok()?.into_iter().next()
    }
}

/// Shrinks `case` in at most `trials` trials. Returns the smallest case found that fails in one of
/// the ways in `faults`, and its row.
///
/// # Errors
/// Fails if `watch` cancels.
pub fn smallest(
    case: &Case,
    faults: &[Failure],
    options: &SweepOptions,
    trials: u32,
    watch: &dyn Watch,
) -> Result<(Case, Option<SweepRow>), Cancelled> {
    let mut made = Trials::new(options, watch);
    let mut fails = |case: &Case| {
        let found = made.row(case).map(|row| row.faults()).unwrap_or_default();
        found.iter().any(|fault| faults.contains(fault))
    };
    let small = shrink(case.clone(), trials, &mut fails);
    let row = made.row(&small);
    watch.check()?;
    Ok((small, row))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jobs_of_a_seed_are_the_same_however_many_and_follow_each_other_by_machine() {
        let few = draw(3, 5, 2, Class::Any).expect("programs");
        let many = draw(3, 8, 2, Class::Any).expect("programs");
        for (a, b) in few.iter().zip(&many) {
            assert_eq!((&a.case, &a.job.program.key), (&b.case, &b.job.program.key));
        }
        assert!(Arc::ptr_eq(&few[0].job.machine, &few[1].job.machine));
        assert_ne!(few[1].job.machine, few[2].job.machine);
        assert!(many.iter().all(|made| made.job.program.machining_s <= 2.0 * LIMIT_S));
    }
}
