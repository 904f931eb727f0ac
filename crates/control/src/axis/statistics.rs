//! Noise of an axis: the statistics of its random parts, and the amplitude and phase of the parts
//! that depend on the angle of the motor.
//!
//! The random numbers themselves remain unknown to a controller. Symbols and spectra follow
//! `docs/machine-file.md`.

/// Noise statistics of an axis at the motor shaft. Zero omits a part.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct AxisStatistics {
    /// RMS of the encoder's white noise, rad.
    pub encoder_noise_rad: f64,
    /// Step of the encoder, rad.
    pub encoder_step_rad: f64,
    /// Amplitude of the encoder's error within a signal period, rad.
    pub interpolation_rad: f64,
    /// Phase of that error at angle zero, rad.
    pub interpolation_phase_rad: f64,
    /// Signal periods in a radian, times 2 pi.
    pub signal_per_rad: f64,
    /// RMS of the broadband torque, N m.
    pub torque_noise_nm: f64,
    /// Correlation time of the broadband torque, s.
    pub torque_noise_s: f64,
    /// Amplitude of the disturbance, N m.
    pub disturbance_nm: f64,
    /// Frequency of the disturbance, rad/s.
    pub disturbance_rad_s: f64,
    /// RMS variation of that frequency, as a part of it.
    pub disturbance_wander: f64,
    /// Amplitude of the cogging torque, N m.
    pub cogging_nm: f64,
    /// Phase of the cogging torque at angle zero, rad.
    pub cogging_phase_rad: f64,
    /// Periods of the cogging torque in a turn.
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
