//! One file per command.

pub(crate) mod compare;
pub(crate) mod export_contour;
pub(crate) mod ball_bar;
pub(crate) mod held_out;
pub(crate) mod never_worse;
pub(crate) mod mismatch;
pub(crate) mod independent;
pub(crate) mod paper;
