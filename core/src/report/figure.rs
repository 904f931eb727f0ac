//! Figures for print.
