//! The keys of a geometry file that are numbers and texts; see [`crate::toml_file::key`].

use super::observation::MeasuredSet;
use super::{AxisGeometry, GeometryOrigin, MeasuredSquareness};
use crate::toml_file::Key;
use crate::toml_file::key::key;

/// Keys at the top of the file.
pub(crate) const ORIGIN: &[Key<GeometryOrigin>] = &[
    key!(optional text written_by),
    key!(text source),
    key!(optional text date),
];

/// Keys of `[axis.x]`, `[axis.y]` and `[axis.z]`. The ranges of values are the same as in machine
/// files.
pub(crate) const AXIS: &[Key<AxisGeometry>] = &[
    key!(scale_um_m or zero, "um/m", -1e4, 1e4),
    key!(scale_std_um_m or zero, "um/m", 0.0, 1e4),
    key!(pitch_error_um or zero, "um", 0.0, 1e3),
    key!(pitch_error_std_um or zero, "um", 0.0, 1e3),
    key!(pitch_phase_deg or zero, "degrees", -360.0, 360.0),
    key!(pitch_phase_std_deg or zero, "degrees", 0.0, 360.0),
    key!(lead_mm_per_rev or zero, "mm/rev", 0.01, 1e3),
    key!(backlash_um or zero, "um", -1e4, 1e4),
    key!(backlash_std_um or zero, "um", 0.0, 1e4),
    key!(from_mm or zero, "mm", -1e5, 1e5),
    key!(to_mm or zero, "mm", -1e5, 1e5),
    key!(table_std_um or zero, "um", 0.0, 1e4),
    key!(straightness_std_um or zero, "um", 0.0, 1e4),
];

/// Keys of `[geometry]`.
pub(crate) const SQUARENESS: &[Key<MeasuredSquareness>] = &[
    key!(squareness_xy_urad or zero, "urad", -1e4, 1e4),
    key!(squareness_xy_std_urad or zero, "urad", 0.0, 1e4),
    key!(squareness_xz_urad or zero, "urad", -1e4, 1e4),
    key!(squareness_xz_std_urad or zero, "urad", 0.0, 1e4),
    key!(squareness_yz_urad or zero, "urad", -1e4, 1e4),
    key!(squareness_yz_std_urad or zero, "urad", 0.0, 1e4),
];

/// Keys of a table below `[measured.set]`.
pub(crate) const SET: &[Key<MeasuredSet>] = &[
    key!(text kind),
    key!(text axes),
    key!(optional text source),
    key!(optional text date),
    key!(flag calibrated),
    key!(x_mm or zero, "mm", -1e5, 1e5),
    key!(y_mm or zero, "mm", -1e5, 1e5),
    key!(z_mm or zero, "mm", -1e5, 1e5),
    key!(radius_mm or zero, "mm", 0.1, 1e4),
    key!(noise_um, "um", 1e-6, 1e4),
    key!(left_um, "um", 0.0, 1e6),
];
