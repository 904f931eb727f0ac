//! TODO front page

mod average;
mod spectrum;
mod log;
mod excite;
mod identify;
mod model;

pub use average::{median_and_spread, quadratic_mean};
pub use excite::{ExciteError, ExciteOptions, excitation_program};
pub use identify::axes::{AxisRecordings, TrainedAxes, train_axes};
pub use identify::axis_parameters::{AxisEstimate, AxisParameters, DriveSettings, NotIdentified, identify_axis};
pub use identify::axis_statistics::axis_statistics;
pub use identify::contour::{TrainedContour, Training, train_contour};
pub use identify::grey_box::axis_facts::AxisFacts;
pub use identify::grey_box::axis_record::AxisRecord;
pub use identify::grey_box::found_axis::{FoundAxis, NumberSource};
pub use identify::grey_box::free_run_scores::{FreeRunErrors, HORIZONS};
pub use identify::grey_box::terms::LawTerm;
pub use identify::grey_box::verdict::LawVerdict;
pub use identify::grey_box::{
    FoundMachine, GreyBoxOptions, NotFound, SERVO_MECHANICS, identify_machine, servo_period_s,
};
pub use identify::recording::{RecordedKnot, Recording};
pub use identify::servo::{TrainedServo, train_servo};
pub use identify::{Excitation, Rng};
pub use log::columns::{Columns, ColumnsError};
pub use log::error::{Refusal, RefusalReason};
pub use log::{Fitness, Log, LogAxis, LogError, LogFinding, LogFormat, MAX_AXES, TorqueUnit};
pub use model::date::today;
pub use model::exact::exact_block;
pub use model::{Model, Origin, an_identifier, identifier_name};
pub use spectrum::{Spectrum, SpectrumSegments};
