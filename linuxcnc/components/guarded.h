/* The link, with what stands in for it where it could not be made, or failed. */
#ifndef FEEDWRIGHT_GUARDED_H
#define FEEDWRIGHT_GUARDED_H

#include <math.h>

#include "faults.h"
#include "load.h"

typedef struct {
    feedwright_servo *servo;
    /* Whether there is a link, and whether it runs. */
    bool made, runs;
    /* The last outputs. */
    feedwright_outputs last;
} guarded;

/* Makes the link in memory that is there; the fault that it begins with. */
static uint32_t guarded_new(guarded *g, size_t bytes, uint32_t joints, const uint8_t *model, size_t length)
{
    uint32_t fault = FEEDWRIGHT_NOT_MADE;
    g->made = CONTAINED(fault = feedwright_servo_new(g->servo, bytes, joints, model, length)) && fault != FEEDWRIGHT_NOT_MADE;
    g->runs = g->made;
    return g->made ? fault : FEEDWRIGHT_FAILED;
}

/* The period of the thread is known in its first servo period. */
static void guarded_begin(guarded *g, double servo_s)
{
    if (g->runs && !CONTAINED(feedwright_servo_runs_at(g->servo, servo_s)))
        g->runs = false;
}

/* Commands as they are: there never was a delay. */
static void guarded_pass(const feedwright_inputs *in, feedwright_outputs *out)
{
    bool powered = (in->flags & FEEDWRIGHT_POWERED) != 0;
    *out = (feedwright_outputs){ .fault = FEEDWRIGHT_FAILED, .state = powered, .adaptive_feed = 1, .is_settled = 1 };
    for (int i = 0; i < 3; i++) {
        out->drive_mm[i] = powered ? in->command_mm[i] : in->actual_mm[i];
        out->feedback_mm[i] = in->actual_mm[i];
    }
    for (int i = 0; i < FEEDWRIGHT_CHANNELS; i++) {
        out->through_drive[i] = powered ? in->through[i] : in->through_actual[i];
        out->through_feedback[i] = in->through_actual[i];
    }
}

/* Holds the last one of what is not a number; whether all were numbers. */
static bool held(double *numbers, const double *last, int count)
{
    bool all = true;
    for (int i = 0; i < count; i++) {
        if (!isfinite(numbers[i])) {
            numbers[i] = last[i];
            all = false;
        }
    }
    return all;
}

/* One servo period. What goes to drives and LinuxCNC is always a number. */
static void guarded_step(guarded *g, const feedwright_inputs *in, feedwright_outputs *out)
{
    if (g->runs && !CONTAINED(feedwright_servo_step(g->servo, in, out)))
        g->runs = false;
    if (!g->runs && !(g->made && CONTAINED(feedwright_servo_play_out(g->servo, in, out)))) {
        g->made = false;
        guarded_pass(in, out);
    }
    if (!(held(out->drive_mm, g->last.drive_mm, 3) && held(out->through_drive, g->last.through_drive, FEEDWRIGHT_CHANNELS)))
        out->fault = FEEDWRIGHT_FAILED;
    held(out->feedback_mm, g->last.feedback_mm, 3);
    held(out->through_feedback, g->last.through_feedback, FEEDWRIGHT_CHANNELS);
    g->last = *out;
}

#endif
