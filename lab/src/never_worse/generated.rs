//! Generated work: random programs on random machines.

use std::sync::Arc;

use feedwright::JobError;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::SweepJob;
use super::program::{Length, SweepProgram};
use crate::held_out::machines::{self, Class};
use crate::held_out::{Variant, programs};

/// Machining time of a program beyond which the rest is left out, s: a feedrate of 100 mm/min makes
/// a long path last.
pub(crate) const LIMIT_S: f64 = 30.0;
/// Seeds of programs and machines are below this, so that people can read them out.
const SEEDS: u64 = 1_000_000_000;

/// A generated job and what it was made of.
#[derive(Debug, Clone)]
pub struct Generated {
    /// Text of the program.
    pub text: String,
    /// The machine.
    pub variant: Variant,
    /// The same, ready to be cut.
    pub job: SweepJob,
}

/// Draws `count` jobs from a seed, with `for_each` programs for each machine, because identifying a
/// machine takes as long as several cuts. The first jobs of a seed are the same for every `count`.
///
/// # Errors
/// Fails if a generated program is rejected, which is a fault of the generator.
pub fn draw(
    seed: u64,
    count: usize,
    for_each: usize,
    class: Class,
) -> Result<Vec<Generated>, JobError> {
    let mut seeds = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut all = Vec::with_capacity(count);
    while all.len() < count {
        let variant = machines::machine(seeds.random_range(0..SEEDS), class);
        let machine = Arc::new(variant.machine().expect("only valid machines are drawn"));
        for _ in 0..for_each {
            let drawn = programs::program(seeds.random_range(0..SEEDS));
            let length = Length(&machine, LIMIT_S);
            let program = SweepProgram::from_text(&drawn.name, &drawn.text, length)?;
            let job = SweepJob {
                program: Arc::new(program),
                machine: machine.clone(),
                model: machine.clone(),
            };
            all.push(Generated {
                text: drawn.text,
                variant: variant.clone(),
                job,
            });
        }
    }
    all.truncate(count);
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jobs_of_a_seed_are_the_same_however_many_and_follow_each_other_by_machine() {
        let few = draw(3, 5, 2, Class::Any).expect("programs");
        let many = draw(3, 8, 2, Class::Any).expect("programs");
        for (a, b) in few.iter().zip(&many) {
            assert_eq!(
                (&a.text, &a.variant, &a.job.program.key),
                (&b.text, &b.variant, &b.job.program.key)
            );
        }
        assert!(Arc::ptr_eq(&few[0].job.machine, &few[1].job.machine));
        assert_ne!(few[1].job.machine, few[2].job.machine);
        assert!(
            many.iter()
                .all(|made| made.job.program.machining_s <= 2.0 * LIMIT_S)
        );
    }
}
