/* feedwright-replay FILE.fwreplay: what the component computed, computed again by the same library.
 *
 * Prints the size of the state, the deepest stack and the time of a servo period. Exit code 0 where every output is the same to the last bit,
 * 1 where one is not, 2 where the file cannot be read. */
#include <inttypes.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "recording.h"

enum { STACK_BYTES = 1 << 20, PAINT = 0xA5 };

static record_header header;
static uint8_t *model;
static recorded *periods;
static int64_t *times_ns;
static uint64_t differ, first_different;

_Noreturn void feedwright_panicked(void)
{
    fputs("the library panicked\n", stderr);
    abort();
}

static int64_t now_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

static void *again(void *memory)
{
    feedwright_servo *servo = memory;
    for (uint64_t i = 0; i < header.count; i++) {
        feedwright_outputs out;
        int64_t start = now_ns();
        feedwright_servo_step(servo, &periods[i].in, &out);
        times_ns[i] = now_ns() - start;
        if (memcmp(&out, &periods[i].out, sizeof out) != 0 && differ++ == 0)
            first_different = i;
    }
    return NULL;
}

static int by_size(const void *a, const void *b)
{
    int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

static int is_read(const char *path)
{
    FILE *file = fopen(path, "rb");
    int whole = 0;
    if (file && fread(&header, sizeof header, 1, file) == 1 && memcmp(header.magic, RECORDING_MAGIC, sizeof header.magic) == 0 &&
        header.model_bytes < 1 << 16 && header.count > 0 && header.count < UINT64_C(1) << 32) {
        model = malloc(header.model_bytes + 1);
        periods = malloc(header.count * sizeof *periods);
        times_ns = malloc(header.count * sizeof *times_ns);
        whole = model && periods && times_ns && fread(model, 1, header.model_bytes, file) == header.model_bytes &&
                fread(periods, sizeof *periods, header.count, file) == header.count;
    }
    if (file)
        fclose(file);
    return whole;
}

int main(int argc, char **argv)
{
    void *memory = NULL, *stack = NULL;
    size_t bytes = feedwright_servo_bytes(), used = 0;
    pthread_attr_t attributes;
    pthread_t thread;
    if (argc != 2) {
        fprintf(stderr, "usage: feedwright-replay FILE.fwreplay\n");
        return 2;
    }
    if (!is_read(argv[1])) {
        fprintf(stderr, "%s: no recording, or not a whole one\n", argv[1]);
        return 2;
    }
    if (posix_memalign(&memory, 64, bytes) != 0 || posix_memalign(&stack, 4096, STACK_BYTES) != 0)
        return 2;
    feedwright_servo_new(memory, bytes, header.joints, model, header.model_bytes);
    feedwright_servo_runs_at(memory, (double)header.period_ns * 1e-9);
    memset(stack, PAINT, STACK_BYTES);
    pthread_attr_init(&attributes);
    if (pthread_attr_setstack(&attributes, stack, STACK_BYTES) != 0 || pthread_create(&thread, &attributes, again, memory) != 0)
        return 2;
    pthread_join(thread, NULL);
    while (used < STACK_BYTES && ((uint8_t *)stack)[used] == PAINT)
        used++;
    qsort(times_ns, header.count, sizeof *times_ns, by_size);
    printf("%" PRIu64 " servo periods of %" PRIu32 " joints: %" PRIu64 " differ", header.count, header.joints, differ);
    if (differ)
        printf(", the first is number %" PRIu64, first_different);
    printf("\nstate %zu bytes, stack %zu bytes\n", bytes, STACK_BYTES - used);
    printf("servo period: median %.1f us, p99.9 %.1f us\n", (double)times_ns[header.count / 2] * 1e-3,
           (double)times_ns[header.count - 1 - header.count / 1000] * 1e-3);
    return differ ? 1 : 0;
}
