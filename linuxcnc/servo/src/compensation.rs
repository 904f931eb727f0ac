//! The geometry of the machine between the control and the link: the control has the tool, the link
//! has the joints.
//!
//! ```text
//! t = m - z                    tool that the control asks for, from its motor command m and the motor offset z of homing
//! q = J(t) + r                 joints; J is the inverse map of the geometry in force, and the identity where none is in force
//! o = q - t                    what the link's command is beside the motor command
//! f' = T(f - z - r) + z        feedback of the link f as the control gets it; T is the map itself
//! ```
//!
//! Command and feedback always have the same map, so a joint that follows its command also appears
//! to the control at the commanded place. The following error stays the same as in the joints, up
//! to the stretch of the geometry. A geometry comes into force while the position of every axis is
//! known: before homing, the place of an axis on its screw is unknown. Where the geometry comes
//! into force or leaves, and where homing changes z, r takes over the old o, with its speed, and
//! fades to zero within an acceleration. With the amplifiers off nothing moves, and nothing fades.
//!
//! The second motor of an axis gets the o of its axis, and its feedback is corrected by the same
//! amount as the feedback of its axis.

use feedwright_control::KnownGeometry;
use feedwright_control::vector::{add_scaled, norm, scale, sub};

use crate::fading::Fading;
use crate::limits::LinkLimits;
use crate::servo::LinkInputs;
use crate::through::{CHANNELS, Carries, PassedThrough, Through};

/// Knowledge of the positions in a servo period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MachinePlace<const N: usize> {
    /// Motor offset of each joint, mm: motor position less position of the joint.
    pub zero_mm: [f64; N],
    /// True if every joint is homed.
    pub is_known: bool,
    /// True if the geometry is to be compensated.
    pub is_wanted: bool,
}

/// The geometry that is compensated, and how far it is in force.
#[derive(Debug, Clone)]
pub struct Compensation<const N: usize> {
    geometry: Option<KnownGeometry<N>>,
    servo_s: f64,
    limits: LinkLimits,
    is_in_force: bool,
    /// r.
    fading: Fading<N>,
    zero_mm: [f64; N],
    command_mm: [f64; N],
    /// o of this servo period, and of the one before.
    offset_mm: [f64; N],
    before_mm: [f64; N],
}

impl<const N: usize> Compensation<N> {
    /// Compensates this geometry. Without one, commands and feedback pass unchanged to the bit.
    pub fn new(geometry: Option<KnownGeometry<N>>) -> Self {
        Self {
            geometry,
            servo_s: 0.001,
            limits: LinkLimits::DEFAULT,
            is_in_force: false,
            fading: Fading::NONE,
            zero_mm: [0.0; N],
            command_mm: [0.0; N],
            offset_mm: [0.0; N],
            before_mm: [0.0; N],
        }
    }

    /// The servo period of the thread, s, before the first one.
    pub fn runs_at(&mut self, servo_s: f64) {
        self.servo_s = servo_s;
    }

    /// Compensates nothing from here on, before the first servo period.
    pub fn refuse(&mut self) {
        self.geometry = None;
    }

    /// The inputs of the link in a servo period: the commands are those of the joints.
    pub fn joints(
        &mut self,
        inputs: &LinkInputs<N>,
        place: &MachinePlace<N>,
        limits: &LinkLimits,
    ) -> LinkInputs<N> {
        if self.geometry.is_none() {
            return *inputs;
        }
        self.limits.take_over(limits);
        if norm(inputs.command_mm).is_finite() {
            self.advance(inputs, place);
        }
        let offset = |i: usize| match inputs.through.carries[i] {
            Carries::Tandem(axis) => self.offset_mm.get(axis).copied(),
            Carries::Signal | Carries::Joint => None,
        };
        let through = inputs.through.command;
        let command: [f64; CHANNELS] = core::array::from_fn(|i| {
            offset(i).map_or(through[i], |offset_mm| through[i] + offset_mm)
        });
        LinkInputs {
            command_mm: add_scaled(inputs.command_mm, 1.0, self.offset_mm),
            through: Through {
                command,
                ..inputs.through
            },
            ..*inputs
        }
    }

    /// Goes on to the command of this servo period.
    fn advance(&mut self, inputs: &LinkInputs<N>, place: &MachinePlace<N>) {
        let has_zero = norm(place.zero_mm).is_finite();
        let zero_mm = if has_zero {
            place.zero_mm
        } else {
            self.zero_mm
        };
        let is_in_force = place.is_known && place.is_wanted && has_zero;
        let changes = is_in_force != self.is_in_force || zero_mm != self.zero_mm;
        (self.is_in_force, self.zero_mm) = (is_in_force, zero_mm);
        let wanted_mm = self.wanted_mm(inputs.command_mm);
        if !inputs.powered {
            self.fading = Fading::NONE;
        } else if changes {
            let per_s = 1.0 / self.servo_s;
            let goes_mm = sub(self.offset_mm, self.before_mm);
            let would_go_mm = sub(wanted_mm, self.wanted_mm(self.command_mm));
            let goes_on_mm = sub(add_scaled(self.offset_mm, 1.0, goes_mm), wanted_mm);
            self.fading = Fading::from(goes_on_mm, scale(per_s, sub(goes_mm, would_go_mm)));
        } else {
            self.fading.step(self.servo_s, self.limits.correction_mm_s2);
        }
        let offset_mm = add_scaled(wanted_mm, 1.0, self.fading.value_mm());
        // Without power nothing is on its way.
        self.before_mm = if inputs.powered {
            self.offset_mm
        } else {
            offset_mm
        };
        (self.offset_mm, self.command_mm) = (offset_mm, inputs.command_mm);
    }

    /// J(t) - t of a motor command.
    fn wanted_mm(&self, command_mm: [f64; N]) -> [f64; N] {
        match &self.geometry {
            Some(geometry) if self.is_in_force => {
                let tool_mm = sub(command_mm, self.zero_mm);
                sub(geometry.joints_mm(tool_mm), tool_mm)
            }
            _ => [0.0; N],
        }
    }

    /// Returns the feedback of the link as the control gets it, and the feedback of the channels.
    pub fn tool(
        &self,
        feedback_mm: [f64; N],
        mut through: PassedThrough,
        carries: &[Carries; CHANNELS],
    ) -> ([f64; N], PassedThrough) {
        let Some(geometry) = &self.geometry else {
            return (feedback_mm, through);
        };
        let plain_mm = sub(feedback_mm, self.fading.value_mm());
        let tool_mm = if self.is_in_force {
            add_scaled(
                geometry.tool_mm(sub(plain_mm, self.zero_mm)),
                1.0,
                self.zero_mm,
            )
        } else {
            plain_mm
        };
        for (feedback, carries) in through.feedback.iter_mut().zip(carries) {
            if let Carries::Tandem(axis) = carries
                && let (Some(joint_mm), Some(tool_mm)) =
                    (feedback_mm.get(*axis), tool_mm.get(*axis))
            {
                *feedback -= joint_mm - tool_mm;
            }
        }
        (tool_mm, through)
    }

    /// Returns the offset of each joint command from the command of the control, mm.
    pub fn offset_mm(&self) -> [f64; N] {
        self.offset_mm
    }

    /// Returns true if the geometry is in force and nothing fades.
    pub fn compensates(&self) -> bool {
        self.geometry.is_some() && self.is_in_force && self.fading == Fading::NONE
    }
}
