//! Options of a comparison.

use feedwright::{Entry, Setting};
use feedwright_sim::Machine;
use serde::Serialize;

use super::competitor::{Competitor, Knowledge};
use super::tuned::Tuned;
use super::work::Workpiece;

/// Source of the controllers' parameter values.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub enum Tuning {
    /// A search on each machine, the same for all.
    Search,
    /// The defaults.
    Defaults,
    /// An earlier search; a new one for controllers and machines that it does not have.
    Known(Vec<Tuned>),
}

/// Options of a comparison.
#[derive(Debug, Clone)]
pub struct ComparisonOptions {
    /// Contours and parts.
    pub workpieces: Vec<Workpiece>,
    /// The machine on which those are identified that meet the others [unseen](Knowledge::Unseen).
    pub nominal: Machine,
    /// Machines to cut on.
    pub machines: Vec<Machine>,
    /// Controllers, uncorrected among them: the ratios are against it.
    pub controllers: Vec<&'static Entry>,
    /// Knowledge that controllers get of the machines: a row for each kind that suits a controller.
    pub knowledge: Vec<Knowledge>,
    /// Seed of everything random.
    pub seed: u64,
    /// Noise seeds that each workpiece is cut with on a machine that has noise.
    pub noise_seeds: u32,
    /// Values of the controllers' parameters.
    pub tuning: Tuning,
    /// Parameters that are set; the others of such a controller have their defaults.
    pub set: Vec<Setting>,
    /// True if the machining times at equal tolerance are searched too.
    pub at_tolerance: bool,
}

impl ComparisonOptions {
    /// All competitors on a machine, in the order of the table.
    pub fn competitors(&self, machine: &Machine) -> Vec<Competitor> {
        let is_nominal = machine.name == self.nominal.name;
        Competitor::all(&self.controllers, &self.knowledge, is_nominal)
    }

    /// Returns true if parameters of a controller are set.
    pub(super) fn is_set(&self, entry: &Entry) -> bool {
        self.set.iter().any(|set| set.controller == entry.name)
    }

    /// Returns true if a controller runs with values other than its fixed ones.
    pub(super) fn has_values(&self, entry: &Entry) -> bool {
        entry.searched().count() > 0 || self.is_set(entry)
    }

    /// The values of a controller on a machine, where no search is needed for them.
    pub(super) fn given(&self, machine: &Machine, entry: &Entry) -> Option<Tuned> {
        match &self.tuning {
            _ if self.is_set(entry) => Some(Tuned::set(&machine.name, entry, &self.set)),
            Tuning::Search => None,
            Tuning::Defaults => Some(Tuned::defaults(&machine.name, entry)),
            Tuning::Known(known) => {
                let is_it = |it: &&Tuned| it.machine == machine.name && it.controller == entry.name;
                known.iter().find(is_it).cloned()
            }
        }
    }

    /// Controllers and machines whose values have to be searched, by name.
    pub fn to_search(&self) -> Vec<(String, &'static str)> {
        let mut all = Vec::new();
        for machine in &self.machines {
            let with_values = self
                .controllers
                .iter()
                .filter(|entry| self.has_values(entry));
            let open = with_values.filter(|entry| self.given(machine, entry).is_none());
            all.extend(open.map(|entry| (machine.name.clone(), entry.name)));
        }
        all
    }

    /// Returns a fingerprint of everything that the result depends on, apart from the program.
    pub fn fingerprint(&self) -> String {
        let path = |w: &Workpiece| (w.name.clone(), format!("{:?}", w.steps));
        let workpieces: Vec<_> = self.workpieces.iter().map(path).collect();
        let machine = |machine: &Machine| (machine.name.clone(), machine.fingerprint());
        let machines: Vec<_> = self.machines.iter().map(machine).collect();
        let names: Vec<_> = self.controllers.iter().map(|entry| entry.name).collect();
        let known = self
            .machines
            .iter()
            .filter_map(|machine| machine.compensated.as_ref());
        let compensated: Vec<_> = known.map(|known| format!("{known:?}")).collect();
        let content = serde_json::json!([
            workpieces,
            compensated,
            machine(&self.nominal),
            machines,
            names,
            self.knowledge,
            [self.seed, u64::from(self.noise_seeds)],
            self.tuning,
            self.set,
            self.at_tolerance
        ]);
        let hash = blake3::hash(content.to_string().as_bytes());
        hash.to_hex().to_string()
    }
}
