//! What takes part in a run and was made elsewhere.

use feedwright_sim::Mechanism;

use crate::controllers::Make;

/// A [`feedwright_sim::PlantMaker`] for cuts on several threads.
pub(super) type SharedPlantMaker<'a> = &'a (dyn Fn([f64; 3], u64) -> Box<dyn Mechanism> + Sync);

/// Substitutes for components of a job in its cuts. The part stays the job's own.
///
/// The search for a plan that holds a tolerance, and the band of other machines, take the job's own
/// controller.
#[derive(Clone, Copy, Default)]
pub struct Guests<'a> {
    /// Makes the requested controller.
    pub controller: Option<&'a dyn Make>,
    /// Feedrates of the motions of the program in its order, mm/s, in the cut of the requested
    /// controller: a planner's. Feedrates of rapids are not used. A motion without one keeps its
    /// own. The limits of the machine hold as always.
    pub feeds_mm_s: Option<&'a [f64]>,
    /// Makes the plant of every cut.
    pub plant: Option<SharedPlantMaker<'a>>,
}
