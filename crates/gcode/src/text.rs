//! A line of text as words with values, and what is said of one that cannot be read.

pub mod suggestion;
pub(crate) mod visible;
pub(crate) mod diagnostic;
pub(crate) mod read_error;
pub(crate) mod characters;
pub mod input;
pub(crate) mod source;
pub(crate) mod lexer;
pub(crate) mod expression;
pub(crate) mod codes;
mod foreign;
pub(crate) mod block;
