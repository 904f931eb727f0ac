//! TODO front page

mod watch;
mod number;
pub mod toml_file;
mod kinematics;
mod machine;
mod reference;
mod plant;
mod trace;
mod simulate;
mod pipeline;

pub use kinematics::joints_of;
#[doc(hidden)]
pub use machine::keys as machine_keys;
pub use machine::{
    AXIS_NAMES, Axis, BUILT_IN_MACHINES, DEFAULT_MACHINE, Known, KnownAxis, Limits, Machine, MachineError, Noise,
    Period, Squareness, Transmission, is_machine_path,
};
pub use number::{shown, to_four_digits};
pub use pipeline::{Run, RunError, Stages, path_steps};
pub use plant::{Measurement, Plant};
pub use reference::{Foot, Reference, Sample};
pub use simulate::foot::settled_s;
pub use simulate::uncut::Uncut;
pub use simulate::{JointError, RunResult, Stopped, TickTimes};
pub use trace::csv::{SetpointWriter, TraceWriter};
pub use trace::{Commanded, FadedOut, Outcome, Row, Sink};
pub use watch::{Cancelled, StageSteps, Watch};
