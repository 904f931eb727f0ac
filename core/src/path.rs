//! Path: exact curves by arc length.
