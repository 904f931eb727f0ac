//! One file per command.

pub(crate) mod advise;
pub(crate) mod block;
pub(crate) mod canon;
pub(crate) mod check;
pub(crate) mod compare;
pub(crate) mod completions;
pub(crate) mod correct;
pub(crate) mod excite;
pub(crate) mod export_contour;
pub(crate) mod held_out;
pub(crate) mod identify;
pub(crate) mod list;
pub(crate) mod man;
pub(crate) mod never_worse;
pub(crate) mod paper;
pub(crate) mod plan;
pub(crate) mod run;
