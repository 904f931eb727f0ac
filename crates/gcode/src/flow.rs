//! Which line comes next, and carrying it out.
//!
//! A definition is stepped over when the flow meets it and entered by a call. Branches not taken
//! are skipped line by line, so that nothing of a program has to be kept in memory except the
//! places of its subroutines. What a line asks for, `execute` carries out in RS-274's order, with
//! what `motion` and `dialects` offer; `reader` hands out what comes of it.

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
