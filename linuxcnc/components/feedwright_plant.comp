component feedwright_plant "Simulated servo axes in place of drives";

description """
Two or three servo axes as a model file has them: position loop, speed loop, inertia, friction, delays, disturbance, encoder and geometry. It takes
position commands as drives do and shows the tool, so that LinuxCNC cuts on a simulated machine.

.B loadrt feedwright_plant model=\\fIFILE.fwmodel\\fB [joints=2|3] [mm_per_unit=\\fIMM\\fB] [seed=\\fIN\\fB]

The file is one of 'feedwright block', of a machine file or of an identified model. A file that is no model is an error.""";

see_also """\\fBfeedwright\\fR(9)""";

pin in float command-#[3] "Position command, in units of the joints";
pin out float actual-#[3] "Position as it is measured, in units of the joints";
pin out float tool-#[3] "Where the tool is, by the geometry of the model with its zero at the motors' zero, mm";
pin out float torque-#[3] "Motor torque, N m";
pin in bit powered "Whether the drives have power; without, the axes stand";
pin in float inertia = 1 "Times the inertia of the model";
pin in bit wire-broken "The measured position stays as it is";
pin in bit wire-noise "The measured position is not a number";

modparam dummy model """Model file""";
modparam dummy joints """Number of joints, 2 or 3 (default: 3)""";
modparam dummy mm_per_unit """mm in one unit of commands and measured positions, 25.4 for inches (default: 1)""";
modparam dummy seed """Seed of the random numbers (default: 1)""";

option singleton yes;
option extra_setup yes;
option extra_cleanup yes;
option no_convenience_defines yes;

function _ fp;

license "MIT OR Apache-2.0";
author "The feedwright contributors";
;;

#include <math.h>
#include "load.h"

static char *model = "";
RTAPI_MP_STRING(model, "model file");
static int joints = 3;
RTAPI_MP_INT(joints, "number of joints, 2 or 3");
static char *mm_per_unit = "1";
RTAPI_MP_STRING(mm_per_unit, "mm in one unit of commands and measured positions");
static double unit_mm = 1;
static int seed = 1;
RTAPI_MP_INT(seed, "seed of the random numbers");

static feedwright_plant *plant;
static bool failed;

static int extra_setup(struct __comp_state *__comp_inst, char *prefix, long extra_arg)
{
    static uint8_t bytes[FEEDWRIGHT_MODEL_BYTES];
    size_t length = read_model(prefix, model, bytes);
    bool made = false;
    (void)__comp_inst;
    (void)extra_arg;
    unit_mm = strtod(mm_per_unit, NULL);
    if (!(unit_mm >= 0.001 && unit_mm <= 1000)) {
        rtapi_print_msg(RTAPI_MSG_ERR, "%s: mm_per_unit=%s: 1 for mm, 25.4 for inches\n", prefix, mm_per_unit);
        return -EINVAL;
    }
    plant = library_memory(feedwright_plant_bytes());
    if (!plant)
        return -ENOMEM;
    if (!CONTAINED(made = feedwright_plant_new(plant, feedwright_plant_bytes(), (uint32_t)joints, bytes, length, (uint64_t)seed)) || !made) {
        rtapi_print_msg(RTAPI_MSG_ERR, "%s: '%s' is no model of %d axes: make it with 'feedwright block'\n", prefix, model, joints);
        return -EINVAL;
    }
    return 0;
}

static void extra_cleanup(void)
{
    free(plant);
}

#define FUNCTION(name) static void name(struct __comp_state *__comp_inst, long period)
FUNCTION(_)
{
    struct __comp_state *c = __comp_inst;
    double command_mm[3] = { 0 }, tool_mm[3] = { 0 }, measured_mm[3] = { 0 }, torque_nm[3] = { 0 };
    int i;
    (void)period;
    for (i = 0; i < joints; i++)
        command_mm[i] = unit_mm * *c->command[i];
    if (!failed && !CONTAINED(feedwright_plant_step(plant, &command_mm, *c->powered, *c->inertia, &tool_mm, &measured_mm, &torque_nm)))
        failed = true;
    for (i = 0; i < joints && !failed; i++) {
        *c->tool[i] = tool_mm[i];
        *c->torque[i] = torque_nm[i];
        if (*c->wire_noise)
            *c->actual[i] = NAN;
        else if (!*c->wire_broken)
            *c->actual[i] = measured_mm[i] / unit_mm;
    }
}
