//! Noise of an axis: the statistics of its random parts, and the amplitude and phase of the parts
//! that depend on the angle of the motor.
//!
//! The random numbers themselves remain unknown to a controller. Symbols and spectra follow
//! `docs/machine-file.md`.

/// What is true of an axis; at the motor shaft, zero is without.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct AxisStatistics {
    /// RMS of the encoder's white noise, rad.
    pub encoder_noise_rad: f64,
    /// Its step, rad.
    pub encoder_step_rad: f64,
    /// Amplitude of its error within a signal period, rad.
    pub interpolation_rad: f64,
    /// Phase of that where the angle is zero, rad.
    pub interpolation_phase_rad: f64,
    /// Turns of the signal in a radian, times 2 pi.
    pub signal_per_rad: f64,
    /// RMS of the broadband torque, N m, and its correlation time, s.
    pub torque_noise_nm: f64,
    /// See above.
    pub torque_noise_s: f64,
    /// Amplitude of the disturbance, N m.
    pub disturbance_nm: f64,
    /// Its frequency, rad/s.
    pub disturbance_rad_s: f64,
    /// RMS by which that wanders, a part of it.
    pub disturbance_wander: f64,
    /// Amplitude of the cogging torque, N m.
    pub cogging_nm: f64,
    /// Its phase where the angle is zero, rad.
    pub cogging_phase_rad: f64,
    /// Its periods in a turn.
    pub cogging_per_rev: f64,
}

impl AxisStatistics {
    /// No noise.
    pub const NOTHING: Self = Self {
        encoder_noise_rad: 0.0,
        encoder_step_rad: 0.0,
        interpolation_rad: 0.0,
        interpolation_phase_rad: 0.0,
        signal_per_rad: 0.0,
        torque_noise_nm: 0.0,
        torque_noise_s: 0.0,
        disturbance_nm: 0.0,
        disturbance_rad_s: 0.0,
        disturbance_wander: 0.0,
        cogging_nm: 0.0,
        cogging_phase_rad: 0.0,
        cogging_per_rev: 0.0,
    };
}
