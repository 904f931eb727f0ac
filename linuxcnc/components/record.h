/* Keeping a recording: in memory that is there before the thread runs, written when the component is unloaded. */
#ifndef FEEDWRIGHT_RECORD_H
#define FEEDWRIGHT_RECORD_H

#include "recording.h"

/* The fastest thread of which seconds are kept whole, Hz. */
#define RECORD_HZ 1000
/* Ten minutes are 264 MB. */
#define RECORD_SECONDS 600

static recorded *recorded_periods;
static uint64_t record_room, record_count;
static int64_t record_period_ns;

static bool record_start(int seconds)
{
    if (seconds <= 0)
        return true;
    record_room = (uint64_t)(seconds < RECORD_SECONDS ? seconds : RECORD_SECONDS) * RECORD_HZ;
    recorded_periods = malloc(record_room * sizeof *recorded_periods);
    if (!recorded_periods)
        return false;
    /* The pages are there before the thread needs them. */
    memset(recorded_periods, 0, record_room * sizeof *recorded_periods);
    return true;
}

static void record_period(long period_ns)
{
    record_period_ns = period_ns;
}

static void record_period_of(const feedwright_inputs *in, const feedwright_outputs *out)
{
    if (record_count < record_room)
        recorded_periods[record_count++] = (recorded){ .in = *in, .out = *out };
}

static void record_write(const char *path, int joints, const uint8_t *model, size_t length)
{
    record_header header = { RECORDING_MAGIC, (uint32_t)joints, (uint32_t)length, record_period_ns, record_count };
    FILE *file = record_count && path && *path ? fopen(path, "wb") : NULL;
    if (file) {
        bool written = fwrite(&header, sizeof header, 1, file) == 1 && fwrite(model, 1, length, file) == length &&
                       fwrite(recorded_periods, sizeof *recorded_periods, record_count, file) == record_count;
        if (fclose(file) != 0 || !written)
            rtapi_print_msg(RTAPI_MSG_ERR, "feedwright: %s: the recording is not whole\n", path);
    } else if (record_count) {
        rtapi_print_msg(RTAPI_MSG_ERR, "feedwright: %s: the recording cannot be written: %s\n", path ? path : "", strerror(errno));
    }
    free(recorded_periods);
}

#endif
