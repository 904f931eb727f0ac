/* What feedwright computes between a position command and the drives, and a simulated machine: the library of ../hal, of which this file is made.
 * Lengths in mm, times in s. Nothing here allocates: `_new` is for before the thread runs, `_step` for each servo period. */

#ifndef FEEDWRIGHT_H
#define FEEDWRIGHT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// The amplifiers are on.
#define FEEDWRIGHT_POWERED 1

// The correction is wanted.
#define FEEDWRIGHT_ENABLED 2

// No delay is wanted.
#define FEEDWRIGHT_DIRECT 4

// A spindle is about to be followed.
#define FEEDWRIGHT_SPINDLE 8

// This motion cuts.
#define FEEDWRIGHT_CUTTING 16

// A controller that changes the feedrate leaves the geometry on the path.
#define FEEDWRIGHT_SPEED_ALONE 32

// This motion probes.
#define FEEDWRIGHT_PROBING 64

// The geometry of the model is to be compensated.
#define FEEDWRIGHT_GEOMETRY 128

// Every corrected joint is homed, so that its motor offset says where it is.
#define FEEDWRIGHT_HOMED 256

// Values that pass through at the most.
#define FEEDWRIGHT_CHANNELS 6

// What a channel carries, in four bits of `carries` for each, the first in the lowest: this for a joint, this and 1 + n for a second motor of the
// corrected joint n, 0 for a signal.
#define FEEDWRIGHT_JOINT 1

// What [`feedwright_servo_new`] returns where it made nothing.
#define FEEDWRIGHT_NOT_MADE 255

// The fault of a link that failed: known to the caller alone.
#define FEEDWRIGHT_FAILED 14

// The simulated machine.
typedef struct feedwright_plant feedwright_plant;

// The link between command and drives.
typedef struct feedwright_servo feedwright_servo;

// What comes from the control and the drives in a servo period.
typedef struct {
    // Position commands.
    double command_mm[3];
    // Actual positions.
    double actual_mm[3];
    // Motor offsets: motor position less position of the joint.
    double offset_mm[3];
    // Delay of the command, 0.008 to 0.015. A setting out of its range is refused; the last good one stays in force.
    double delay_s;
    // Largest distance of the drive's command from the path.
    double deviation_mm;
    // Highest speed of the machine.
    double speed_mm_s;
    // Acceleration of an offset that fades; 0 is without limit.
    double correction_mm_s2;
    // Acceleration of an offset in the loop; 0 is without limit. A correction that needs more leaves the loop.
    double engaged_mm_s2;
    // What 1 of the requested feedrate stands for, 0.1 to 1.
    double adaptive_scale;
    // Commands that are delayed and not corrected.
    double through[FEEDWRIGHT_CHANNELS];
    // Their actual positions; of a signal its command.
    double through_actual[FEEDWRIGHT_CHANNELS];
    // The sum of FEEDWRIGHT_POWERED and so on.
    uint32_t flags;
    // What the channels carry.
    uint32_t carries;
} feedwright_inputs;

// What goes to the drives and the control.
typedef struct {
    // Position commands of the drives.
    double drive_mm[3];
    // What the control takes for the actual positions.
    double feedback_mm[3];
    // Offsets of the drives' commands from the path.
    double correction_mm[3];
    // Offsets of the joints' commands from those of the control, by the geometry.
    double geometry_mm[3];
    // Commands of the drives of what passes through, and what the control takes for the actual positions.
    double through_drive[FEEDWRIGHT_CHANNELS];
    double through_feedback[FEEDWRIGHT_CHANNELS];
    // Distance of the actual position from the path.
    double contour_error_mm;
    // The same without the correction, by the model.
    double without_mm;
    // Feedrate that the control is asked for, as a multiple of its own in the scale that is set, 0 to 1.
    double adaptive_feed;
    // What the supervisor found when it took the correction out of the loop last, and what it may be; 0 where nothing was compared.
    double found_mm;
    double limit_mm;
    // 0 amplifiers off, 1 without delay, 2 delayed, 3 the correction fades, 4 it is in the loop.
    uint32_t state;
    // Why there is no correction, 0 for nothing; faults.h has words for it.
    uint32_t fault;
    // Whether a limit holds the correction.
    uint32_t saturated;
    // Servo periods of delay.
    uint32_t delay_periods;
    // Whether the control is to hold its feed.
    uint32_t holds_feed;
    // Whether a motion that follows a spindle would be without delay.
    uint32_t is_settled;
    // How often the supervisor has taken the correction out of the loop since the delay was taken up.
    uint32_t times_out;
    // Joints that are corrected by what was learned while they moved: 1, 2 and 4.
    uint32_t learned;
    // Whether the geometry is compensated, and nothing of it fades.
    uint32_t compensates;
    // Whether the correction stays out until it is reset.
    uint32_t latched;
} feedwright_outputs;

// What the control allows a joint.
typedef struct {
    // MAX_VELOCITY.
    double speed_mm_s;
    // MAX_ACCELERATION, mm/s2.
    double acceleration_mm_s2;
    // FERROR.
    double ferror_mm;
} feedwright_joint;

// The caller's: where a panic ends. It must not return.
extern void feedwright_panicked(void) __attribute__((noreturn));

// Bytes that a link needs.
size_t feedwright_servo_bytes(void);

// Sizes of inputs and outputs, for the caller to compare with its own.
size_t feedwright_servo_layout(void);

// A new link of two or three joints, with or without a model; the fault that it begins with, or [`FEEDWRIGHT_NOT_MADE`] where the memory is
// none for it.
//
// # Safety
// There are so many bytes at `memory`, which nobody else uses, and so many at `bytes`.
uint32_t feedwright_servo_new(feedwright_servo *memory, size_t memory_bytes, uint32_t joints, const uint8_t *bytes, size_t length);

// Tells the servo period of the thread, before the first step; the fault that there is then.
//
// # Safety
// `servo` was made by [`feedwright_servo_new`].
uint32_t feedwright_servo_runs_at(feedwright_servo *servo, double servo_s);

// One servo period.
//
// # Safety
// `servo` was made by [`feedwright_servo_new`]; the others are what they are declared to be.
void feedwright_servo_step(feedwright_servo *servo, const feedwright_inputs *inputs, feedwright_outputs *outputs);

// One servo period in place of [`feedwright_servo_step`], once that has panicked: plays out its delay, without a correction.
//
// # Safety
// `servo` was made by [`feedwright_servo_new`]; the others are what they are declared to be.
void feedwright_servo_play_out(feedwright_servo *servo, const feedwright_inputs *inputs, feedwright_outputs *outputs);

// Bytes that a machine needs.
size_t feedwright_plant_bytes(void);

// A new machine of two or three joints; whether there is one.
//
// # Safety
// There are so many bytes at `memory`, which nobody else uses, and so many at `bytes`.
bool feedwright_plant_new(feedwright_plant *memory,
                          size_t memory_bytes,
                          uint32_t joints,
                          const uint8_t *bytes,
                          size_t length,
                          uint64_t seed);

// One servo period under a command; tool, measured position and torque at its end.
//
// # Safety
// `plant` was made by [`feedwright_plant_new`]; the others are what they are declared to be.
void feedwright_plant_step(feedwright_plant *plant,
                           const double (*command_mm)[3],
                           bool powered,
                           double inertia,
                           double (*tool_mm)[3],
                           double (*measured_mm)[3],
                           double (*torque_nm)[3]);

// The least MIN_FERROR of each joint with the longest delay, by a model; 0 where it has no axes, or a
// joint no limits. Before the thread runs.
//
// # Safety
// There are so many bytes at `bytes`; the others are what they are declared to be.
void feedwright_min_ferror(const uint8_t *bytes,
                           size_t length,
                           uint32_t joints,
                           const feedwright_joint (*limits)[3],
                           double (*min_ferror_mm)[3]);

#endif  /* FEEDWRIGHT_H */
