//! One file per command.

pub(crate) mod canon;
pub(crate) mod check;
pub(crate) mod compare;
pub(crate) mod list;
pub(crate) mod paper;
pub(crate) mod run;
