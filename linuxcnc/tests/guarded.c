/* guarded MODEL.fwmodel: what components/guarded.h does where the library cannot make a link, or fails in the cut.
 *
 * Linked with --wrap for the two functions of the library that fail here. Prints a line for each case; exit
 * code 1 where one is not as it should be. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define RTAPI_MSG_ERR 1
static void rtapi_print_msg(int level, const char *format, const char *component, const char *path, const char *why)
{
    (void)level;
    fprintf(stderr, format, component, path, why);
}

#include "guarded.h"

enum { CUTS = 400, FAILS = 700, PERIODS = 2000, NEVER = -1 };
/* Servo period, s, and the speed and acceleration of the commands, mm/s and mm/s2. */
static const double T = 0.001, SPEED = 50, ACCELERATION = 2000;
/* Farthest that the drive's command goes in a servo period, mm: the command, and as much again for a correction. A lost delay is 0.5 mm. */
static const double MOST_STEP_MM = 0.1;

static bool is_made = true, is_number = true;
static int fails_at = NEVER, period;

uint32_t __real_feedwright_servo_new(feedwright_servo *, size_t, uint32_t, const uint8_t *, size_t);
uint32_t __wrap_feedwright_servo_new(feedwright_servo *servo, size_t bytes, uint32_t joints, const uint8_t *model, size_t length)
{
    /* Memory that is too small for a link. */
    return __real_feedwright_servo_new(servo, is_made ? bytes : 16, joints, model, length);
}

void __real_feedwright_servo_step(feedwright_servo *, const feedwright_inputs *, feedwright_outputs *);
void __wrap_feedwright_servo_step(feedwright_servo *servo, const feedwright_inputs *in, feedwright_outputs *out)
{
    if (period == fails_at)
        feedwright_panicked();
    __real_feedwright_servo_step(servo, in, out);
    if (!is_number)
        out->drive_mm[0] = NAN;
}

/* From rest to 30 mm, and rest. */
static double command_mm(int n)
{
    double t = (n - CUTS) * T, ramp = SPEED / ACCELERATION, whole = 30 / SPEED + ramp;
    t = fmin(fmax(t, 0), whole);
    if (t < ramp)
        return ACCELERATION * t * t / 2;
    return t < whole - ramp ? SPEED * (t - ramp / 2) : 30 - ACCELERATION * (whole - t) * (whole - t) / 2;
}

/* Runs a cut; false where it was not as it should be. */
static bool cut(const char *name, const uint8_t *model, size_t length, bool failed, int first_fault)
{
    size_t bytes = feedwright_servo_bytes();
    guarded g = { .servo = library_memory(bytes) };
    feedwright_outputs out = { 0 };
    double last_mm = 0, last_through_mm = 0, actual_mm = 0, step_mm = 0, delayed_mm = 0, through_mm = 0;
    int told = NEVER;
    bool numbers = true, passed = true;
    if (!g.servo)
        return false;
    guarded_new(&g, bytes, 3, model, length);
    guarded_begin(&g, T);
    for (period = 0; period < PERIODS; period++) {
        feedwright_inputs in = { .command_mm = { command_mm(period), 0, 0 }, .actual_mm = { actual_mm, 0, 0 }, .delay_s = 0.01, .deviation_mm = 0.5,
                                 .speed_mm_s = 400, .correction_mm_s2 = 400, .adaptive_scale = 1, .through = { command_mm(period) }, .through_actual = { actual_mm },
                                 .carries = FEEDWRIGHT_JOINT, .flags = FEEDWRIGHT_POWERED | FEEDWRIGHT_CUTTING };
        guarded_step(&g, &in, &out);
        numbers = numbers && isfinite(out.drive_mm[0]) && isfinite(out.feedback_mm[0]);
        step_mm = fmax(step_mm, fmax(fabs(out.drive_mm[0] - last_mm), fabs(out.through_drive[0] - last_through_mm)));
        through_mm = fmax(through_mm, fabs(out.through_drive[0] - out.drive_mm[0] + out.correction_mm[0]));
        last_through_mm = out.through_drive[0];
        passed = passed && out.drive_mm[0] == command_mm(period);
        last_mm = out.drive_mm[0];
        delayed_mm = fmax(delayed_mm, command_mm(period) - last_mm);
        /* A drive with a time constant of 20 ms. */
        actual_mm += (last_mm - actual_mm) * T / 0.02;
        if (out.fault == FEEDWRIGHT_FAILED && told == NEVER)
            told = period;
    }
    free(g.servo);
    printf("%-24s fault 14 %s %d; steps of %.3f mm; behind by %.3f mm, at the end by %.6f mm\n", name,
           told == NEVER ? "in no servo period up to" : "from servo period", told == NEVER ? PERIODS : told, step_mm, delayed_mm,
           command_mm(PERIODS) - last_mm);
    if (is_number && through_mm > 1e-9) {
        fprintf(stderr, "%s: what passes through is out of step by %.9f mm\n", name, through_mm);
        return false;
    }
    return numbers && told == first_fault && step_mm < MOST_STEP_MM && (!failed || passed) &&
           (!is_number || fabs(command_mm(PERIODS) - last_mm) < 1e-6);
}

int main(int argc, char **argv)
{
    static uint8_t model[FEEDWRIGHT_MODEL_BYTES];
    size_t length = read_model("guarded", argc == 2 ? argv[1] : "", model);
    bool good = length > 0;
    good = cut("as it should be", model, length, false, NEVER) && good;
    fails_at = FAILS;
    good = cut("fails in the cut", model, length, false, FAILS) && good;
    fails_at = NEVER;
    is_made = false;
    good = cut("could not be made", model, length, true, 0) && good;
    is_made = true;
    is_number = false;
    good = cut("drive's command is none", model, length, false, 0) && good;
    if (!good)
        fputs("the link is not guarded\n", stderr);
    return !good;
}
