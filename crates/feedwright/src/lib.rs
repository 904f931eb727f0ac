//! feedwright reads a G-code program and a machine file, predicts what the machine will really cut, and corrects the
//! commanded feedrate, speed and geometry, so that the part comes out more accurate and sooner.
//!
//! Millimetres, seconds, radians and newton-metres everywhere; inches and mm/min end in [`gcode`].
//!
//! The modules stand in the order in which data flows; each uses only those above it.

pub use feedwright_control as control;
pub use feedwright_gcode as gcode;
pub use feedwright_ident as ident;
pub use feedwright_plan as plan;
pub use feedwright_sim as sim;

mod output;
mod checked_json;
mod identifier_cache;
mod measured;
mod cycle_time;
mod override_time;
mod fastest;
mod controllers;
mod report;
mod job_error;
mod correct;
mod job;
mod log_job;
#[cfg(feature = "command")]
pub mod command;

pub use checked_json::{checked, with_check};
pub use controllers::{
    ACCELERATION_GAIN, BASELINE, BEST, CONTROLLERS, Choices, Controllers, Entry, FEEDFORWARD, FRICTION_GAIN, HORIZON,
    KNOTS, Knows, LQG_IDENTIFIED, MAGNITUDE_ONLY, Make, Maker, ModelMisfit, NothingIdentified, OPEN_LOOP,
    PLAN_PERIOD_S, Parameter, ParameterKind, RATE_WEIGHT, RECEDING_HORIZON, Setting, SettingError, Setup,
    TWO_DIMENSIONAL, VELOCITY_GAIN, Values, correction_limits, offset_bounds,
};
pub use correct::advise::{Advice, AdviseJob, CutWay, ErrorPlace};
pub use correct::arc_fit::{ArcFit, FitPoint};
pub use correct::exported::{ExportedCut, ExportedFigures};
pub use correct::{CorrectJob, CorrectOutcome, MacroLanguage, TARGETS, TargetControl, deterministic};
pub use cycle_time::{CycleTime, cycle_time, cycle_time_by, cycle_time_within};
pub use fastest::{FastestError, FastestPlan, fastest};
pub use identifier_cache::{folder as cache_folder, identified, key_of, trained};
pub use job::{Job, JobError, MEASURED, Outputs};
pub use log_job::{
    LogIdentified, LogJob, LogJobError, UpdateError, following_figure, informative, machine_text, updated_text,
    write_json, write_page,
};
pub use measured::{MeasuredError, measured};
pub use output::{FileOperation, OutputError, OutputFile, OutputFiles};
pub use report::figure::{
    COLORS, CaptionedFigure, Figure, LineStyle, Panel, Polyline, figure_parts, write_figure_page, write_figure_part,
};
pub use report::harm::{CutErrors, ErrorChange, Harm, MAX_UM, RMS_UM, UNCUT_UM, harm};
pub use report::plain_page::{PagePart, write_foot, write_head, write_table_end, write_table_head};
pub use report::text::{escaped, number};
pub use report::{
    Assumptions, ErrorSpectrum, FullCircle, Histogram, LawKnowledge, LimitBand, ProgramLine, Report, ReportedRun,
    Roundness, RunFacts, RunSummary, Series, SeriesPoint, SpectrumBand, Statistics, TimelineEvent, WorstPlace,
    write_html,
};
