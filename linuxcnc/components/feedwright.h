/* What feedwright computes between a position command and a drive, and a simulated machine. The library is hal/ beside this folder; its
 * `#[repr(C)]` types and these are the same, which feedwright_servo_layout() tells at load time. Lengths in mm, times in s.
 *
 * Nothing here allocates. `_new` is for before the thread runs, `_step` for each servo period. */
#ifndef FEEDWRIGHT_H
#define FEEDWRIGHT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    FEEDWRIGHT_POWERED = 1, /* the amplifiers are on */
    FEEDWRIGHT_ENABLED = 2, /* the correction is wanted */
    FEEDWRIGHT_DIRECT = 4,  /* no delay is wanted */
    FEEDWRIGHT_SPINDLE = 8, /* a spindle is about to be followed */
    FEEDWRIGHT_CUTTING = 16 /* this motion cuts */
};

typedef struct {
    double command_mm[3];
    double actual_mm[3];
    double delay_s;          /* of the command, 0.008 to 0.015 */
    double deviation_mm;     /* of the drive's command from the path */
    double speed_mm_s;       /* highest of the machine */
    double correction_mm_s2; /* of an offset that fades; 0 is without limit */
    uint32_t flags;
    uint32_t reserved;
} feedwright_inputs;

typedef struct {
    double drive_mm[3];
    double feedback_mm[3];
    double correction_mm[3];
    double contour_error_mm;
    double without_mm; /* contour error without the correction, by the model */
    uint32_t state;    /* 0 off, 1 without delay, 2 delayed, 3 fading, 4 in the loop */
    uint32_t fault;    /* see feedwright_fault() */
    uint32_t saturated;
    uint32_t delay_periods;
} feedwright_outputs;

typedef struct feedwright_servo feedwright_servo;
typedef struct feedwright_plant feedwright_plant;

size_t feedwright_servo_bytes(void);
size_t feedwright_servo_layout(void); /* sizeof(feedwright_inputs) << 16 | sizeof(feedwright_outputs) */
/* Returns the fault that it begins with, 0 for none, UINT32_MAX where the memory is too small. Without a model it passes commands on. */
uint32_t feedwright_servo_new(feedwright_servo *memory, size_t memory_bytes, uint32_t joints, const uint8_t *model, size_t length);
/* The servo period of the thread, before the first step; returns the fault that there is then. */
uint32_t feedwright_servo_runs_at(feedwright_servo *servo, double servo_s);
void feedwright_servo_step(feedwright_servo *servo, const feedwright_inputs *inputs, feedwright_outputs *outputs);

size_t feedwright_plant_bytes(void);
bool feedwright_plant_new(feedwright_plant *memory, size_t memory_bytes, uint32_t joints, const uint8_t *model, size_t length,
                          uint64_t seed);
void feedwright_plant_step(feedwright_plant *plant, const double command_mm[3], bool powered, double inertia, double position_mm[3],
                           double measured_mm[3], double torque_nm[3]);

/* The caller's: where a panic ends. It must not return. */
_Noreturn void feedwright_panicked(void);

/* A fault in words. */
static inline const char *feedwright_fault(uint32_t fault)
{
    static const char *const words[] = {
        "none",
        "the file is no model: make it with 'feedwright block'",
        "the model is of another format than this component reads",
        "the model is not one of identified axes: identify with --controller lqg-identified",
        "the model is for another number of axes than there are joints",
        "the model is cut off, or has something behind it",
        "the model is damaged: its checksum does not fit",
        "a number of the model is out of its bounds",
        "the model is for another servo period than that of the thread",
        "the correction was not a number",
        "the actual position was lost: not a number, leapt, or stood still under a moving command",
        "the machine does not do what the model predicts",
        "the correction made the contour error larger",
        "the command was not a number",
        "the component failed inside and passes commands on",
    };
    return fault < sizeof words / sizeof words[0] ? words[fault] : "unknown";
}

#define FEEDWRIGHT_FAILED 14u

#endif
