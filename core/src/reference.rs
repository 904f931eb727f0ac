//! Reference at the servo period.
