/* A recording of inputs and outputs: what stands in a .fwreplay file.
 *
 *   header, the model, then inputs and outputs of each servo period as in feedwright.h */
#ifndef FEEDWRIGHT_RECORDING_H
#define FEEDWRIGHT_RECORDING_H

#include "feedwright.h"

#define RECORDING_MAGIC "FWREPLY5"

typedef struct {
    char magic[8];
    uint32_t joints;
    uint32_t model_bytes;
    int64_t period_ns;
    uint64_t count;
} record_header;

typedef struct {
    feedwright_inputs in;
    feedwright_outputs out;
} recorded;

#endif
