/* Reading a model file where a component is loaded: before the thread runs, and outside of it. */
#ifndef FEEDWRIGHT_LOAD_H
#define FEEDWRIGHT_LOAD_H

#include <errno.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "feedwright.h"

/* A model of three axes has 1,800 bytes at the most, its geometry with nine tables of 256 points 37,100. */
#define FEEDWRIGHT_MODEL_BYTES 40960

static size_t read_model(const char *component, const char *path, uint8_t *bytes)
{
    size_t length = 0;
    FILE *file = path && *path ? fopen(path, "rb") : NULL;
    if (file) {
        length = fread(bytes, 1, FEEDWRIGHT_MODEL_BYTES, file);
        fclose(file);
    } else if (path && *path) {
        rtapi_print_msg(RTAPI_MSG_ERR, "%s: %s: %s\n", component, path, strerror(errno));
    }
    return length;
}

/* Memory for the library, aligned for whatever it holds. */
static void *library_memory(size_t bytes)
{
    void *memory = NULL;
    return posix_memalign(&memory, 64, bytes) == 0 ? memset(memory, 0, bytes) : NULL;
}

/* Where a panic ends: behind the call that panicked, with a result that says so. The library has nothing to clean up. */
static jmp_buf panic_exit;

_Noreturn void feedwright_panicked(void)
{
    longjmp(panic_exit, 1);
}

#define CONTAINED(call) (_setjmp(panic_exit) == 0 ? ((call), true) : false)

#endif
