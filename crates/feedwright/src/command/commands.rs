//! One file per command.

pub(crate) mod advise;
pub(crate) mod block;
pub(crate) mod cache;
pub(crate) mod canon;
pub(crate) mod check;
pub(crate) mod completions;
pub(crate) mod correct;
pub(crate) mod diff;
pub(crate) mod excite;
pub(crate) mod identify;
pub(crate) mod lab;
pub(crate) mod linuxcnc;
pub(crate) mod list;
pub(crate) mod man;
pub(crate) mod merge;
pub(crate) mod open;
pub(crate) mod plan;
pub(crate) mod run;
pub(crate) mod sweep;
