/* The identifier's network, 10-12-2, in FANN (Debian: libfann-dev): checked, timed, or run for counting instructions.
 *
 *   fann_bench FILE check             outputs for the first sample, then all weights but the biases' after one step
 *   fann_bench FILE time              median ns of a forward pass and of a training step
 *   fann_bench FILE forward|learn N   N of them
 *
 * FILE, by lab/benches/fann.rs: 120 weights [input][hidden], 24 weights [output][hidden], then samples of ten inputs
 * and two targets. -DSINGLE takes float FANN instead of double FANN. FANN cannot leave out the bias neurons: it has
 * 144 + 14 connections; the biases' weights start at 0, so that one pass and one step are those of 144. */

#define _POSIX_C_SOURCE 200809L

#ifdef SINGLE
#include <floatfann.h>
#else
#include <doublefann.h>
#endif
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* These are the same in lab/benches/fann.rs. */
enum { INPUTS = 10, HIDDEN = 12, OUTPUTS = 2, SAMPLES = 64, BATCHES = 101, BATCH = 4096 };
#define LEARNING_STEP 0.015625f

/* FANN numbers neurons layer by layer, the bias last in its layer. */
enum { INPUT_BIAS = INPUTS, FIRST_HIDDEN, HIDDEN_BIAS = FIRST_HIDDEN + HIDDEN, FIRST_OUTPUT };

static fann_type inputs[SAMPLES][INPUTS];
static fann_type targets[SAMPLES][OUTPUTS];

static void fail(const char *message) {
    fprintf(stderr, "fann_bench: %s\n", message);
    exit(1);
}

static fann_type next_of(FILE *file) {
    double value;
    if (fscanf(file, "%lf", &value) != 1) {
        fail("the file ends early");
    }
    return (fann_type)value;
}

static struct fann *network_of(const char *path) {
    FILE *file = fopen(path, "r");
    struct fann *net = fann_create_standard(3, INPUTS, HIDDEN, OUTPUTS);
    if (file == NULL || net == NULL) {
        fail("no file or no memory");
    }
    /* tanh(steepness * x): with 1/2 the bipolar sigmoid of the identifier. */
    fann_set_activation_function_hidden(net, FANN_SIGMOID_SYMMETRIC);
    fann_set_activation_function_output(net, FANN_SIGMOID_SYMMETRIC);
    fann_set_activation_steepness_hidden(net, (fann_type)0.5);
    fann_set_activation_steepness_output(net, (fann_type)0.5);
    fann_set_training_algorithm(net, FANN_TRAIN_INCREMENTAL);
    fann_set_train_error_function(net, FANN_ERRORFUNC_LINEAR);
    fann_set_learning_momentum(net, 0.0f);
    /* FANN halves the error of a symmetric output before it goes back. */
    fann_set_learning_rate(net, 2.0f * LEARNING_STEP);
    for (int i = 0; i < INPUTS; i++) {
        for (int j = 0; j < HIDDEN; j++) {
            fann_set_weight(net, i, FIRST_HIDDEN + j, next_of(file));
        }
    }
    for (int o = 0; o < OUTPUTS; o++) {
        for (int j = 0; j < HIDDEN; j++) {
            fann_set_weight(net, FIRST_HIDDEN + j, FIRST_OUTPUT + o, next_of(file));
        }
    }
    for (int j = 0; j < HIDDEN; j++) {
        fann_set_weight(net, INPUT_BIAS, FIRST_HIDDEN + j, 0);
    }
    for (int o = 0; o < OUTPUTS; o++) {
        fann_set_weight(net, HIDDEN_BIAS, FIRST_OUTPUT + o, 0);
    }
    for (int s = 0; s < SAMPLES; s++) {
        for (int i = 0; i < INPUTS; i++) {
            inputs[s][i] = next_of(file);
        }
        for (int o = 0; o < OUTPUTS; o++) {
            targets[s][o] = next_of(file);
        }
    }
    fclose(file);
    return net;
}

static void work(struct fann *net, int learn, long count) {
    for (long n = 0; n < count; n++) {
        if (learn) {
            fann_train(net, inputs[n % SAMPLES], targets[n % SAMPLES]);
        } else {
            fann_run(net, inputs[n % SAMPLES]);
        }
    }
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The median over the batches of what one costs, ns. */
static double time_ns(struct fann *net, int learn) {
    double each_ns[BATCHES];
    for (int b = 0; b < BATCHES; b++) {
        struct timespec start, end;
        clock_gettime(CLOCK_MONOTONIC, &start);
        work(net, learn, BATCH);
        clock_gettime(CLOCK_MONOTONIC, &end);
        each_ns[b] = ((double)(end.tv_sec - start.tv_sec) * 1e9 + (double)(end.tv_nsec - start.tv_nsec)) / BATCH;
    }
    qsort(each_ns, BATCHES, sizeof each_ns[0], ascending);
    return each_ns[BATCHES / 2];
}

static void check(struct fann *net) {
    fann_type *output = fann_run(net, inputs[0]);
    printf("%.17g %.17g\n", (double)output[0], (double)output[1]);
    fann_train(net, inputs[0], targets[0]);
    unsigned count = fann_get_total_connections(net);
    struct fann_connection *all = calloc(count, sizeof *all);
    if (all == NULL) {
        fail("no memory");
    }
    fann_get_connection_array(net, all);
    fann_type weight[FIRST_OUTPUT + OUTPUTS][FIRST_OUTPUT + OUTPUTS];
    for (unsigned c = 0; c < count; c++) {
        weight[all[c].from_neuron][all[c].to_neuron] = all[c].weight;
    }
    free(all);
    for (int i = 0; i < INPUTS; i++) {
        for (int j = 0; j < HIDDEN; j++) {
            printf("%.17g\n", (double)weight[i][FIRST_HIDDEN + j]);
        }
    }
    for (int o = 0; o < OUTPUTS; o++) {
        for (int j = 0; j < HIDDEN; j++) {
            printf("%.17g\n", (double)weight[FIRST_HIDDEN + j][FIRST_OUTPUT + o]);
        }
    }
}

int main(int argc, char **argv) {
    if (argc < 3) {
        fail("usage: fann_bench FILE check|time|forward|learn [N]");
    }
    struct fann *net = network_of(argv[1]);
    if (strcmp(argv[2], "check") == 0) {
        check(net);
    } else if (strcmp(argv[2], "time") == 0) {
        double forward_ns = time_ns(net, 0);
        printf("%.2f %.2f\n", forward_ns, time_ns(net, 1));
    } else if (argc == 4) {
        work(net, strcmp(argv[2], "learn") == 0, atol(argv[3]));
    } else {
        fail("forward and learn need a count");
    }
    fann_destroy(net);
    return 0;
}
