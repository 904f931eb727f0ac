/* What the faults of feedwright_outputs are, in words. */
#ifndef FEEDWRIGHT_FAULTS_H
#define FEEDWRIGHT_FAULTS_H

#include <stdint.h>

#include "feedwright.h"

/* A fault in words. */
static inline const char *feedwright_fault(uint32_t fault)
{
    static const char *const words[] = {
        "none",
        "the file is no model: make it with 'feedwright block'",
        "the model is of another format than this component reads",
        "the model is of a controller that is not there live: identify with --controller lqg-identified, two-dimensional or magnitude-only",
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
        "the component failed inside: it plays out its delay and passes commands on",
        "acceleration-limit is not 0, or within 1 and 1,000,000 mm/s^2: the last good one stays",
        "delay is not within 0.008 and 0.015 s: the last good one stays",
        "deviation-limit is not within 0 and 10 mm: the last good one stays",
        "speed-limit is not within 1 and 10,000 mm/s: the last good one stays",
        "correction-acceleration is not 0, or within 1 and 1,000,000 mm/s^2: the last good one stays",
        "adaptive-scale is not within 0.1 and 1: the last good one stays",
        "a motion that probes or follows a spindle is delayed: connect feed-inhibit and spindle-at-speed",
        "the geometry of the model cannot be compensated: its errors grow by more than 5 % of the travel, or its numbers are none",
    };
    return fault < sizeof words / sizeof words[0] ? words[fault] : "unknown";
}

#endif
