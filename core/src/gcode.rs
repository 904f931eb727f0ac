//! G-code: text to canonical motions and events, in millimetres and seconds.

pub mod canon;
