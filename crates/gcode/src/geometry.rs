//! Points, lines and arcs of a plane; length and extent of a motion.

pub(crate) mod plane;
pub(crate) mod spiral;
mod length;
