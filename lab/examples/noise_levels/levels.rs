//! Kinds of noise, and machines: `tnv40` with one kind at one level each.

use feedwright_sim::{Machine, MachineError};

/// The machine to which noise is added: it has none of its own but the 25 Hz of its disturbance.
pub(crate) const BASE: &str = "tnv40";
/// Levels of each kind.
pub(crate) const LEVELS: usize = 5;

/// A kind of noise.
pub(crate) struct NoiseKind {
    /// Name of its figure, and first part of the names of its machines.
    pub(crate) name: &'static str,
    /// Quantity that the level sets.
    pub(crate) level: &'static str,
    /// Its unit.
    pub(crate) unit: &'static str,
    /// Key of an axis that is the level.
    key: &'static str,
    /// Other keys that the axis needs.
    more: &'static str,
    /// The levels, in powers of about three.
    pub(crate) levels: [f64; LEVELS],
}

/// All kinds. The values of examples/03_realism/machines, where reasons stand beside them, lie
/// within the levels.
pub(crate) const KINDS: [NoiseKind; 6] = [
    NoiseKind {
        name: "white",
        level: "white encoder noise, RMS",
        unit: "µm",
        key: "encoder_noise_um",
        more: "",
        levels: [0.03, 0.1, 0.3, 1.0, 3.0],
    },
    NoiseKind {
        name: "steps",
        level: "encoder step",
        unit: "µm",
        key: "encoder_step_um",
        more: "",
        levels: [0.1, 0.3, 1.0, 3.0, 10.0],
    },
    NoiseKind {
        name: "interpolation",
        level: "interpolation error of the encoder, amplitude",
        unit: "µm",
        key: "interpolation_error_um",
        more: "signal_period_um = 20\n",
        levels: [0.03, 0.1, 0.3, 1.0, 3.0],
    },
    NoiseKind {
        name: "torque",
        level: "broadband torque up to 100 Hz, RMS",
        unit: "N m",
        key: "torque_noise_nm",
        more: "torque_noise_s = 0.0015915494309189536\n",
        levels: [0.01, 0.03, 0.1, 0.3, 1.0],
    },
    NoiseKind {
        name: "cogging",
        level: "cogging, amplitude",
        unit: "N m",
        key: "cogging_nm",
        more: "cogging_per_rev = 24\n",
        levels: [0.01, 0.03, 0.1, 0.3, 1.0],
    },
    NoiseKind {
        name: "wander",
        level: "wander of the 25 Hz of the disturbance, RMS, part of it",
        unit: "1",
        key: "disturbance_wander",
        more: "",
        levels: [0.005, 0.015, 0.05, 0.15, 0.5],
    },
];

impl NoiseKind {
    /// Name of the machine with a level of it.
    pub(crate) fn machine_name(&self, level: f64) -> String {
        format!("{}_{level}", self.name)
    }

    /// The machine with a level of it on both axes.
    pub(crate) fn machine(&self, level: f64) -> Result<Machine, MachineError> {
        let Self {
            key, more, unit, ..
        } = self;
        let name = self.machine_name(level);
        let [x, y] = ["x", "y"].map(|axis| format!("[axis.{axis}]\n{key} = {level:?}\n{more}"));
        let text = format!(
            "base = \"{BASE}\"\nname = \"{name}\"\ndescription = \"{BASE} with {}: {level} {unit}\"\nsource = \"levels of a study\"\n{x}{y}",
            self.level
        );
        Machine::parse(&format!("{name}.toml"), &text)
    }
}
