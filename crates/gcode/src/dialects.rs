//! What controls other than LinuxCNC mean by the same words, and whose program it is.

pub(crate) mod fanuc;
mod file_kind;
pub(crate) mod choice;
pub(crate) mod firmware;
