/* What feedwright computes between a position command and the drives, and a simulated machine: the library of ../hal, of which this file is made.
 * Lengths in mm, times in s. Nothing here allocates: `_new` is for before the thread runs, `_step` for each servo period. */

#ifndef FEEDWRIGHT_H
#define FEEDWRIGHT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Flag: the amplifiers are on.
#define FEEDWRIGHT_POWERED 1

// Flag: the correction is wanted.
#define FEEDWRIGHT_ENABLED 2

// Flag: no delay is wanted.
#define FEEDWRIGHT_DIRECT 4

// Flag: a motion is about to follow the spindle.
#define FEEDWRIGHT_SPINDLE 8

// Flag: this motion cuts.
#define FEEDWRIGHT_CUTTING 16

// Flag: a controller that changes the feedrate leaves the geometry on the path.
#define FEEDWRIGHT_SPEED_ALONE 32

// Flag: this motion probes.
#define FEEDWRIGHT_PROBING 64

// Flag: the geometry that the model states is to be compensated.
#define FEEDWRIGHT_GEOMETRY 128

// Flag: every corrected joint is homed, so that its motor offset states its position.
#define FEEDWRIGHT_HOMED 256

// Largest number of channels that pass through.
#define FEEDWRIGHT_CHANNELS 6

// Kind of value that a channel carries, in four bits of `carries` for each, the first channel in
// the lowest: this value for a joint, this value plus 1 + n for a second motor of the corrected
// joint n, 0 for a signal.
#define FEEDWRIGHT_JOINT 1

// Result of [`feedwright_servo_new`] if it created no link.
#define FEEDWRIGHT_NOT_MADE 255

// Fault of a link that failed. Only the caller detects the failure.
#define FEEDWRIGHT_FAILED 14

// The simulated machine.
typedef struct feedwright_plant feedwright_plant;

// The link between command and drives.
typedef struct feedwright_servo feedwright_servo;

// Inputs from the control and the drives in a servo period.
typedef struct {
    // Position commands.
    double command_mm[3];
    // Actual positions.
    double actual_mm[3];
    // Motor offsets: motor position minus joint position.
    double offset_mm[3];
    // Delay of the command, 0.008 to 0.015. A setting out of its range is rejected; the last good
    // one stays in force.
    double delay_s;
    // Largest distance of the drive's command from the path.
    double deviation_mm;
    // Highest speed of the machine.
    double speed_mm_s;
    // Acceleration with which an offset fades; 0 is without limit.
    double correction_mm_s2;
    // Acceleration of an offset in the loop; 0 is without limit. If a correction needs more, only
    // a smaller part of it is commanded.
    double engaged_mm_s2;
    // Value of `adaptive_feed` that stands for the present feedrate, 0.1 to 1.
    double adaptive_scale;
    // Commands of the channels that are delayed and not corrected.
    double through[FEEDWRIGHT_CHANNELS];
    // Actual positions of these channels; the command of a signal.
    double through_actual[FEEDWRIGHT_CHANNELS];
    // Sum of the flags FEEDWRIGHT_POWERED and so on.
    uint32_t flags;
    // Kinds of values that the channels carry.
    uint32_t carries;
} feedwright_inputs;

// Outputs to the drives and the control.
typedef struct {
    // Position commands of the drives.
    double drive_mm[3];
    // Actual positions reported to the control.
    double feedback_mm[3];
    // Offsets of the drives' commands from the path.
    double correction_mm[3];
    // Offsets of the joint commands from the commands of the control, due to the geometry.
    double geometry_mm[3];
    // Drive commands of the channels that pass through, and their actual positions reported to the
    // control.
    double through_drive[FEEDWRIGHT_CHANNELS];
    double through_feedback[FEEDWRIGHT_CHANNELS];
    // Distance of the actual position from the path.
    double contour_error_mm;
    // Contour error that the model predicts without the correction.
    double without_mm;
    // Feedrate requested of the control, 0 to 1: multiple of its own feedrate, times
    // `adaptive_scale`.
    double adaptive_feed;
    // Measured error when the supervisor last took the correction out of the loop, and the largest
    // permitted error; 0 if nothing was compared.
    double found_mm;
    double limit_mm;
    // State: 0 amplifiers off, 1 without delay, 2 delayed, 3 the correction fades, 4 it is in the
    // loop.
    uint32_t state;
    // Reason why there is no correction, or 0; faults.h states it in words.
    uint32_t fault;
    // 1 if a limit holds the correction.
    uint32_t saturated;
    // Servo periods of delay.
    uint32_t delay_periods;
    // 1 if the control is to hold its feed.
    uint32_t holds_feed;
    // 1 if a motion that follows a spindle would be without delay.
    uint32_t is_settled;
    // Number of times that the supervisor has taken the correction out of the loop since the delay
    // was taken up.
    uint32_t times_out;
    // Joints that are corrected by a model learned in motion: sum of 1, 2 and 4.
    uint32_t learned;
    // 1 if the geometry is compensated and no part of it fades.
    uint32_t compensates;
    // 1 if the correction stays out until it is reset.
    uint32_t latched;
} feedwright_outputs;

// Limits of a joint in the configuration of the control.
typedef struct {
    // MAX_VELOCITY, mm/s.
    double speed_mm_s;
    // MAX_ACCELERATION, mm/s2.
    double acceleration_mm_s2;
    // FERROR, mm.
    double ferror_mm;
} feedwright_joint;

// Function of the caller in which a panic ends. It must not return.
extern void feedwright_panicked(void) __attribute__((noreturn));

// Returns the size of a link, bytes.
size_t feedwright_servo_bytes(void);

// Returns the size of the inputs, shifted left by 16 bits, plus the size of the outputs, for the
// caller to compare with its own.
size_t feedwright_servo_layout(void);

// Creates a link of two or three joints, with or without a model. Returns the fault that it begins
// with, or [`FEEDWRIGHT_NOT_MADE`] if the memory is too small, not aligned or null.
//
// # Safety
// `memory` is null or points to `memory_bytes` bytes that nothing else uses. `bytes` is null or
// points to `length` bytes.
uint32_t feedwright_servo_new(feedwright_servo *memory, size_t memory_bytes, uint32_t joints, const uint8_t *bytes, size_t length);

// Checks the model against the servo period of the thread, before the first step. Returns the
// fault of a rejected model, or 0.
//
// # Safety
// `servo` was made by [`feedwright_servo_new`].
uint32_t feedwright_servo_runs_at(feedwright_servo *servo, double servo_s);

// Computes one servo period of the link.
//
// # Safety
// `servo` was made by [`feedwright_servo_new`]. The other arguments are valid as declared.
void feedwright_servo_step(feedwright_servo *servo, const feedwright_inputs *inputs, feedwright_outputs *outputs);

// Computes one servo period in place of [`feedwright_servo_step`], once that has panicked: plays
// out the delay of the link, without a correction.
//
// # Safety
// `servo` was made by [`feedwright_servo_new`]. The other arguments are valid as declared.
void feedwright_servo_play_out(feedwright_servo *servo, const feedwright_inputs *inputs, feedwright_outputs *outputs);

// Returns the size of a machine, bytes.
size_t feedwright_plant_bytes(void);

// Creates a machine of two or three joints. Returns true if it was created.
//
// # Safety
// `memory` is null or points to `memory_bytes` bytes that nothing else uses. `bytes` is null or
// points to `length` bytes.
bool feedwright_plant_new(feedwright_plant *memory,
                          size_t memory_bytes,
                          uint32_t joints,
                          const uint8_t *bytes,
                          size_t length,
                          uint64_t seed);

// Simulates one servo period under a command. Writes tool position, measured position and torque
// at its end.
//
// # Safety
// `plant` was made by [`feedwright_plant_new`]. The other arguments are valid as declared.
void feedwright_plant_step(feedwright_plant *plant,
                           const double (*command_mm)[3],
                           bool powered,
                           double inertia,
                           double (*tool_mm)[3],
                           double (*measured_mm)[3],
                           double (*torque_nm)[3]);

// Computes the least MIN_FERROR of each joint, mm, with the longest delay, from the model in
// `bytes`. It is 0 for a joint without limits, and for all joints if the model states no axes.
// Call it before the thread runs.
//
// # Safety
// `bytes` is null or points to `length` bytes. The other arguments are valid as declared.
void feedwright_min_ferror(const uint8_t *bytes,
                           size_t length,
                           uint32_t joints,
                           const feedwright_joint (*limits)[3],
                           double (*min_ferror_mm)[3]);

#endif  /* FEEDWRIGHT_H */
