//! Which line comes next, and carrying it out: O-words, subroutines, macros, the reader.

mod owords;
mod statements;
mod program;
mod labels;
mod loops;
mod subroutines;
mod lines;
mod macros;
mod profiles;
mod variables;
mod machine_codes;
mod modes;
mod unused_words;
mod non_modal;
mod execute;
mod faults;
pub(crate) mod reader;
pub(crate) mod summary;
