//! What a block makes of its words: straight motions, arcs, curves, cycles, and the tool beside
//! them.

mod target;
pub(crate) mod feed;
mod surface_speed;
mod line;
mod home;
mod compensation;
mod straight;
mod arc;
mod splines;
mod cycles;
mod threads;
pub(crate) mod lathe;
