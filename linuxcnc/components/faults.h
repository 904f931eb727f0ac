/* What the faults of feedwright_outputs are, in words. */
#ifndef FEEDWRIGHT_FAULTS_H
#define FEEDWRIGHT_FAULTS_H

#include <stdint.h>

/* The library panicked: known here alone. */
#define FEEDWRIGHT_FAILED 14u

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
        "the component failed inside and passes commands on",
        "the machine does not move as the model says: identify it anew",
    };
    return fault < sizeof words / sizeof words[0] ? words[fault] : "unknown";
}

#endif
