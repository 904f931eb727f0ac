//! Held-out work: machines and programs that were not used for tuning. A seed draws them; the same
//! seed gives the same ones on every platform.
//!
//! | File | What |
//! |---|---|
//! | `held_out/variant.rs` | a machine as what differs from a built-in one, and its file |
//! | `held_out/random.rs` | random numbers |
//! | `held_out/machines.rs` | machines drawn at random |
//! | `held_out/contours.rs` | contours turned and scaled at random |
//! | `held_out/program_writer.rs` | writes a program |
//! | `held_out/programs.rs` | programs drawn at random, by families |

pub mod variant;
pub(crate) mod random;
pub mod machines;
pub mod contours;
mod program_writer;
pub mod programs;

pub use variant::Variant;
