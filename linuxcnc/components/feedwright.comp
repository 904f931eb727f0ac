component feedwright "Contouring correction between the position command and the drives";

description """
Corrects the position commands of two or three linear joints so that the tool is nearer to the commanded path. It stands between
joint.N.motor-pos-cmd and the drives, and knows of each axis what a model file has: its loops, inertia, friction and noise.

With a model of axes ('feedwright identify --controller lqg-identified') the geometry of the command is corrected in every servo period. With one for the
controllers of Lee, Cho and Jeon (two-dimensional, magnitude-only) it is corrected every 10 ms, and the feedrate through \\fBadaptive-feed\\fR;
the delay is then no less than 13 ms.

The command is delayed by \\fBdelay\\fR, so that the correction sees ahead, and the drive gets the delayed command and an offset. What goes
back to joint.N.motor-pos-fb is the command now and the following error of the drive, so that FERROR and MIN_FERROR keep their meaning.

There is no delay and no correction while the machine jogs, homes or probes, while a spindle is followed (G33, G33.1, G76), and
wherever \\fBdirect\\fR is set. The delay is taken up and given up where the command rests. So that it is given up before a program probes
or follows a spindle, connect \\fBfeed-inhibit\\fR to motion.feed-inhibit and \\fBspindle-at-speed\\fR to spindle.0.at-speed.

Other joints and signals pass through: \\fBthrough-drive-N\\fR is \\fBthrough-command-N\\fR with the delay of the corrected joints, to the bit, and
\\fBthrough-feedback-N\\fR goes back to joint.N.motor-pos-fb. Rotary joints and the second motors of gantries belong there: \\fBtandem\\fR
names the corrected joint whose correction a second motor gets as well. The delay is taken up and given up only where these joints rest too.
\\fBsignal-out-N\\fR is \\fBsignal-in-N\\fR with the same delay, such as the power of a laser; a signal may change while the joints rest.

While \\fBpowered\\fR is off, drives and LinuxCNC get the actual position.

After the amplifiers were off, a model of axes first has to show that it is of this machine: 20 ms of motion that changes its speed do, such as the rapid
before a cut. What the model gets wrong (gains, feedforward, delay, inertia, friction) is then learned while the machine moves; \\fBlearned-0\\fR to
\\fBlearned-2\\fR tell which joints go by that.

A correction that fails is faded out, and comes back when its predictions have held for a while in motion: until then the machine cuts as without it.
Where the same cause takes it out again, \\fBlatched\\fR comes on and it stays out, until \\fBenable\\fR goes from 0 to 1 or the amplifiers were off.
A lost position does not latch. \\fBtimes-out\\fR counts how often it was taken out, and \\fBfound\\fR and \\fBallowed\\fR tell what was
measured and from where on it is too much. \\fBenable\\fR fades the correction in and out in motion as well, within \\fBcorrection-acceleration\\fR.

The model may state the geometry of the machine: scale, pitch, tables and squareness, which no encoder sees. Where all of \\fBhomed-N\\fR are on and
\\fBgeometry\\fR is on, the joints go where the tool is then at LinuxCNC's command, while it jogs and probes, too, and \\fBfeedback-N\\fR tells where the
tool is. It fades in and out within \\fBcorrection-acceleration\\fR. Connect \\fBoffset-N\\fR to joint.N.motor-offset: it says where on its screw an axis is.

.B loadrt feedwright model=\\fIFILE.fwmodel\\fB [joints=2|3] [mm_per_unit=\\fIMM\\fB] [through=\\fI0..6\\fB tandem=\\fIJ,J...\\fB] [signals=\\fI0..6\\fB] [max_velocity=\\fIV,V,V\\fB max_acceleration=\\fIA,A,A\\fB max_ferror=\\fIF,F,F\\fB min_ferror=\\fIM,M,M\\fB] [record=\\fISECONDS\\fB recording=\\fIFILE\\fB]

\\fBmodel\\fR is written by 'feedwright block'. A file that is missing, damaged, or for another machine raises \\fBfault\\fR; commands are
then passed on as they are. Where LINEAR_UNITS is inch, \\fBmm_per_unit\\fR is 25.4: then commands, positions and limits of joints are in inches,
and everything else is in mm. \\fBrecord\\fR keeps the inputs and outputs of the first seconds in memory and writes them to
\\fBrecording\\fR when the component is unloaded; 'feedwright-replay' computes them again.""";

examples """
.nf
loadrt feedwright model=/home/me/linuxcnc/mill.fwmodel
addf motion-command-handler servo-thread
addf motion-controller      servo-thread
addf feedwright             servo-thread
net x-cmd joint.0.motor-pos-cmd => feedwright.command-0
net x-drive feedwright.drive-0  => drive.x.position-cmd
net x-actual drive.x.position-fb => feedwright.actual-0
net x-fb feedwright.feedback-0  => joint.0.motor-pos-fb
.fi

and so on for each joint; feedwright.hal has all of it.""";

see_also """\\fBfeedwright_plant\\fR(9), \\fBmotion\\fR(9)""";

pin in float command-#[3] "Position command, from joint.N.motor-pos-cmd, in units of the joints";
pin in float actual-#[3] "Actual position, from the drive or encoder, in units of the joints";
pin out float drive-#[3] "Position command of the drive, in units of the joints";
pin out float feedback-#[3] "To joint.N.motor-pos-fb, in units of the joints";
pin out float correction-#[3] "Offset of the drive's command from the path of the joints, mm";
pin in float offset-#[3] "Motor offset of the joint, from joint.N.motor-offset, in units of the joints";
pin in bit homed-#[3] "Whether the joint is homed, from joint.N.homed: until all are, no geometry is compensated";
pin in bit geometry = 1 "Whether the geometry that the model states is to be compensated";
pin out bit compensates "The geometry is compensated, and nothing of it fades";
pin out float geometry-offset-#[3] "By how much the joint is commanded beside LinuxCNC's command, so that the tool is there, mm";

pin in float through-command-#[6 : personality & 15] "Position command of a joint that is delayed and not corrected, from joint.N.motor-pos-cmd";
pin in float through-actual-#[6 : personality & 15] "Its actual position, from the drive or encoder";
pin out float through-drive-#[6 : personality & 15] "Position command of its drive";
pin out float through-feedback-#[6 : personality & 15] "To its joint.N.motor-pos-fb";
pin in float signal-in-#[6 : personality >> 4] "A number that is delayed with the commands";
pin out float signal-out-#[6 : personality >> 4] "The same, later by the delay";

pin in bit powered "Whether the amplifiers are on, from joint.0.amp-enable-out";
pin in bit enable "Whether the correction is wanted";
pin in bit coordinated = 1 "Whether a program or MDI moves the machine, from motion.coord-mode; otherwise there is no delay";
pin in s32 motion-type "From motion.motion-type: a rapid is not corrected for harm, a probing motion is not delayed";
pin in bit at_speed = 1 "Whether the spindle is at speed, for \\fBspindle-at-speed\\fR";
pin out bit spindle_at_speed "To spindle.0.at-speed: \\fBat-speed\\fR, once a motion that follows the spindle would be without delay";
pin out bit feed_inhibit "To motion.feed-inhibit: holds a probing motion until the delay is given up, 0.02 s, and the motion behind it until it is taken up, 0.1 s";
pin in bit spindle-index "From spindle.0.index-enable: the motion behind it is not delayed";
pin in bit direct "No delay and no correction, from outside";
pin in bit speed_alone "With a model for the paper's controllers: the feedrate alone is changed, the geometry stays on the path; taken over where the command rests";

pin in float delay = 0.010 "Delay of the command, 0.008 to 0.015 s; taken over where the command rests";
pin in float deviation-limit = 0.5 "Largest distance of the drive's command from the path, 0 to 10 mm; a change takes effect within 0.2 s, also in the cut";
pin in float speed-limit = 400 "Highest speed of the machine, 1 to 10,000 mm/s: actual positions that leap by more are no positions";
pin in float correction-acceleration = 400 "Acceleration with which an offset fades, 1 to 1,000,000 mm/s^2; 0 is without limit";
pin in float acceleration-limit = 0 "Acceleration of the correction in the loop, of each joint, 1 to 1,000,000 mm/s^2; of one that needs more, less is commanded; 0 is without limit";

pin out float contour-error "Distance of the actual position from the path, mm";
pin out float contour-error-without "What it would be without the correction, by a model of axes, mm";
pin out float adaptive-feed = 1 """To motion.adaptive-feed, which heeds it in programs with M52 P1: \\fBadaptive-scale\\fR times the feedrate that a controller asks for,
as a multiple of that of now; within 0 and 1. The paper's controllers ask for 0.5 to 1.2, lqg-identified for 1""";
param rw float adaptive-scale = 1 "0.1 to 1: 0.5 where the feed override stands at 200 %: LinuxCNC takes no more than 1, and only so a cut can be sooner than programmed";
pin out bit saturated "A limit holds the correction";
pin out u32 state "0 amplifiers off, 1 without delay, 2 delayed, without correction, 3 the correction fades, 4 it is in the loop";
pin out bit fault "There is no correction, or a setting is refused, for the reason in \\fBcause\\fR; it clears itself";
pin out u32 cause """What was wrong last: 1 to 7 and 22 model file, 8 servo period, 9 the correction was not a number, 10 actual position
lost, 11 predictions wrong, 12 contour error larger, 13 command not a number, 14 failed inside; out of range, so that the last good value stays in force and the correction goes on:
15 acceleration-limit, 16 delay, 17 deviation-limit, 18 speed-limit, 19 correction-acceleration, 20 adaptive-scale; 21 a motion that probes or follows a spindle is delayed""";
pin out bit latched "The same \\fBcause\\fR took the correction out twice, and it stays out: set \\fBenable\\fR to 0 and to 1 again, or switch the amplifiers off";
pin out u32 faults "How often there was a fault";
pin out u32 times-out "How often the correction was taken out of the loop since the delay was taken up";
pin out float found "What was measured when it was taken out last: contour error or wrong prediction, mm; 0 where nothing is compared";
pin out float allowed "From where on that is too much, mm";
pin out bit learned-#[3] "The joint is corrected by what was learned while it moved";
pin out u32 delay-periods "Servo periods of delay now";
pin out bit heartbeat "Changes in each servo period";
pin out s32 tick-time "Time of the last servo period in this component, ns";
param rw s32 tick-max "Longest of them, ns";

modparam dummy model """Model file""";
modparam dummy joints """Number of joints, 2 or 3 (default: 3)""";
modparam dummy mm_per_unit """mm in one unit of the joints, 25.4 for inches (default: 1)""";
modparam dummy through """Number of joints that pass through, delayed and not corrected (default: 0)""";
modparam dummy tandem """For each of them, the corrected joint of which it is the second motor, or -1, separated by commas (default: -1)""";
modparam dummy signals """Number of signals that pass through; with the joints six at the most (default: 0)""";
modparam dummy max_velocity """MAX_VELOCITY of each joint, mm/s, separated by commas: with the following three, a MIN_FERROR that is too small is told at start""";
modparam dummy max_acceleration """MAX_ACCELERATION of each joint, mm/s^2""";
modparam dummy max_ferror """FERROR of each joint, mm""";
modparam dummy min_ferror """MIN_FERROR of each joint, mm""";
modparam dummy record """Seconds of which inputs and outputs are kept (default: 0)""";
modparam dummy recording """File that they are written to when the component is unloaded""";

option singleton yes;
option extra_setup yes;
option extra_cleanup yes;
option no_convenience_defines yes;

function _ fp;

license "MIT OR Apache-2.0";
author "The feedwright contributors";
;;

#include "guarded.h"
#include "record.h"

static char *model = "";
RTAPI_MP_STRING(model, "model file");
static int joints = 3;
RTAPI_MP_INT(joints, "number of joints, 2 or 3");
static char *mm_per_unit = "1";
RTAPI_MP_STRING(mm_per_unit, "mm in one unit of the joints");
static int through = 0, signals = 0;
RTAPI_MP_INT(through, "number of joints that pass through");
RTAPI_MP_INT(signals, "number of signals that pass through");
static char *tandem = "";
RTAPI_MP_STRING(tandem, "corrected joint of each second motor, or -1");
static char *max_velocity = "", *max_acceleration = "", *max_ferror = "", *min_ferror = "";
RTAPI_MP_STRING(max_velocity, "MAX_VELOCITY of each joint");
RTAPI_MP_STRING(max_acceleration, "MAX_ACCELERATION of each joint");
RTAPI_MP_STRING(max_ferror, "FERROR of each joint");
RTAPI_MP_STRING(min_ferror, "MIN_FERROR of each joint");
static int record = 0;
RTAPI_MP_INT(record, "seconds of which inputs and outputs are kept");
static char *recording = "";
RTAPI_MP_STRING(recording, "file that they are written to");

static guarded link_;
static uint8_t model_bytes[FEEDWRIGHT_MODEL_BYTES];
static size_t model_length;
static bool begun;
/* mm in one unit of the joints. */
static double unit_mm = 1;
static uint32_t carries;

/* The next number of a list, or another one where it ends. */
static double next_or(char **list, double otherwise)
{
    char *end;
    double number = strtod(*list, &end);
    number = end == *list ? otherwise : number;
    *list = *end == ',' ? end + 1 : end;
    return number;
}

/* What passes through, as of feedwright.h; false where that cannot be. */
static bool read_through(const char *prefix)
{
    int i;
    if (through < 0 || signals < 0 || through > FEEDWRIGHT_CHANNELS || signals > FEEDWRIGHT_CHANNELS - through) {
        rtapi_print_msg(RTAPI_MSG_ERR, "%s: through=%d signals=%d: no more than %d pass through together\n", prefix, through, signals, FEEDWRIGHT_CHANNELS);
        return false;
    }
    for (i = 0; i < through; i++) {
        double master = next_or(&tandem, -1);
        if (!(master >= -1 && master < joints && master == floor(master))) {
            rtapi_print_msg(RTAPI_MSG_ERR, "%s: tandem: %g is no corrected joint: 0 to %d, or -1\n", prefix, master, joints - 1);
            return false;
        }
        carries |= (uint32_t)(FEEDWRIGHT_JOINT + 1 + (int)master) << 4 * i;
    }
    if (*tandem) {
        rtapi_print_msg(RTAPI_MSG_ERR, "%s: tandem has more than the %d joints that pass through: '%s' is left\n", prefix, through, tandem);
        return false;
    }
    return true;
}

/* Tells which joints LinuxCNC will stop with a following error. */
static void check_ferror(const char *prefix)
{
    feedwright_joint limits[3] = { 0 };
    double given_mm[3] = { 0 }, least_mm[3] = { 0 };
    int i;
    for (i = 0; i < joints; i++) {
        limits[i] = (feedwright_joint){ unit_mm * next_or(&max_velocity, 0), unit_mm * next_or(&max_acceleration, 0), unit_mm * next_or(&max_ferror, 0) };
        given_mm[i] = unit_mm * next_or(&min_ferror, 0);
    }
    if (!CONTAINED(feedwright_min_ferror(model_bytes, model_length, (uint32_t)joints, &limits, &least_mm)))
        return;
    for (i = 0; i < joints; i++)
        if (given_mm[i] > 0 && given_mm[i] < least_mm[i])
            rtapi_print_msg(RTAPI_MSG_ERR, "%s: MIN_FERROR of joint %d is %.2f mm: LinuxCNC stops with a following error where it brakes from %.0f mm/s. "
                            "With FERROR = %.4g it has to be %.4g or more in the INI file\n", prefix, i, given_mm[i], limits[i].speed_mm_s,
                            limits[i].ferror_mm / unit_mm, ceil(1000 * ceil(100 * least_mm[i]) / 100 / unit_mm) / 1000);
}

static int extra_setup(struct __comp_state *__comp_inst, char *prefix, long extra_arg)
{
    size_t bytes = feedwright_servo_bytes();
    uint32_t fault;
    (void)extra_arg;
    if (joints != 2 && joints != 3) {
        rtapi_print_msg(RTAPI_MSG_ERR, "%s: joints=%d: 2 or 3 can be corrected\n", prefix, joints);
        return -EINVAL;
    }
    if (!read_through(prefix))
        return -EINVAL;
    /* How many pins there are. */
    __comp_inst->_personality = through | signals << 4;
    if (feedwright_servo_layout() != (sizeof(feedwright_inputs) << 16 | sizeof(feedwright_outputs))) {
        rtapi_print_msg(RTAPI_MSG_ERR, "%s: the library is of another version than the component\n", prefix);
        return -EINVAL;
    }
    unit_mm = strtod(mm_per_unit, NULL);
    if (!(unit_mm >= 0.001 && unit_mm <= 1000)) {
        rtapi_print_msg(RTAPI_MSG_ERR, "%s: mm_per_unit=%s: 1 for mm, 25.4 for inches\n", prefix, mm_per_unit);
        return -EINVAL;
    }
    link_.servo = library_memory(bytes);
    if (!link_.servo || !record_start(record)) {
        rtapi_print_msg(RTAPI_MSG_ERR, "%s: no memory\n", prefix);
        return -ENOMEM;
    }
    model_length = read_model(prefix, model, model_bytes);
    fault = guarded_new(&link_, bytes, (uint32_t)joints, model_bytes, model_length);
    if (fault)
        rtapi_print_msg(RTAPI_MSG_ERR, "%s: %s: %s; commands are passed on as they are\n", prefix, model, feedwright_fault(fault));
    check_ferror(prefix);
    rtapi_print_msg(RTAPI_MSG_INFO, "%s: state of %lu bytes, model of %lu\n", prefix, (unsigned long)bytes, (unsigned long)model_length);
    return 0;
}

static void extra_cleanup(void)
{
    record_write(recording, joints, model_bytes, model_length);
    free(link_.servo);
}

/* mm in one unit of what passes through: the second motor of a corrected joint takes the correction, in mm. */
static double unit_of_through(int i)
{
    return (carries >> 4 * i & 15) > FEEDWRIGHT_JOINT ? unit_mm : 1;
}

static uint32_t flags(const struct __comp_state *c)
{
    bool direct = *c->direct || !*c->coordinated, homed = true;
    for (int i = 0; i < joints; i++)
        homed = homed && *c->homed[i];
    return (*c->powered ? FEEDWRIGHT_POWERED : 0) | (*c->enable ? FEEDWRIGHT_ENABLED : 0) | (direct ? FEEDWRIGHT_DIRECT : 0) |
           (*c->spindle_index ? FEEDWRIGHT_SPINDLE : 0) | (*c->motion_type != 1 ? FEEDWRIGHT_CUTTING : 0) |
           (*c->speed_alone ? FEEDWRIGHT_SPEED_ALONE : 0) | (*c->motion_type == 5 ? FEEDWRIGHT_PROBING : 0) |
           (*c->geometry ? FEEDWRIGHT_GEOMETRY : 0) | (homed ? FEEDWRIGHT_HOMED : 0);
}

#define FUNCTION(name) static void name(struct __comp_state *__comp_inst, long period)
FUNCTION(_)
{
    struct __comp_state *c = __comp_inst;
    long long start = rtapi_get_time();
    feedwright_inputs in = {
        .delay_s = *c->delay,
        .deviation_mm = *c->deviation_limit,
        .speed_mm_s = *c->speed_limit,
        .correction_mm_s2 = *c->correction_acceleration,
        .engaged_mm_s2 = *c->acceleration_limit,
        .adaptive_scale = c->adaptive_scale,
        .flags = flags(c),
        .carries = carries,
    };
    feedwright_outputs out;
    uint32_t last_cause = *c->fault ? *c->cause : 0;
    int i;
    for (i = 0; i < 3; i++) {
        bool there = i < joints;
        in.command_mm[i] = there ? unit_mm * *c->command[i] : 0;
        in.actual_mm[i] = there ? unit_mm * *c->actual[i] : 0;
        in.offset_mm[i] = there ? unit_mm * *c->offset[i] : 0;
    }
    for (i = 0; i < through; i++) {
        in.through[i] = unit_of_through(i) * *c->through_command[i];
        in.through_actual[i] = unit_of_through(i) * *c->through_actual[i];
    }
    for (i = 0; i < signals; i++)
        in.through[through + i] = in.through_actual[through + i] = *c->signal_in[i];
    if (!begun) {
        begun = true;
        guarded_begin(&link_, period * 1e-9);
        record_period(period);
    }
    guarded_step(&link_, &in, &out);
    for (i = 0; i < joints; i++) {
        *c->drive[i] = out.drive_mm[i] / unit_mm;
        *c->feedback[i] = out.feedback_mm[i] / unit_mm;
        *c->correction[i] = out.correction_mm[i];
        *c->geometry_offset[i] = out.geometry_mm[i];
        *c->learned[i] = (out.learned >> i & 1) != 0;
    }
    for (i = 0; i < through; i++) {
        *c->through_drive[i] = out.through_drive[i] / unit_of_through(i);
        *c->through_feedback[i] = out.through_feedback[i] / unit_of_through(i);
    }
    for (i = 0; i < signals; i++)
        *c->signal_out[i] = out.through_drive[through + i];
    *c->contour_error = out.contour_error_mm;
    *c->contour_error_without = out.without_mm;
    *c->adaptive_feed = out.adaptive_feed;
    *c->feed_inhibit = out.holds_feed != 0;
    *c->spindle_at_speed = *c->at_speed && out.is_settled;
    *c->saturated = out.saturated != 0;
    *c->state = out.state;
    *c->fault = out.fault != 0;
    if (out.fault && out.fault != last_cause)
        *c->faults += 1;
    if (out.fault)
        *c->cause = out.fault;
    *c->times_out = out.times_out;
    *c->found = out.found_mm;
    *c->allowed = out.limit_mm;
    *c->latched = out.latched != 0;
    *c->compensates = out.compensates != 0;
    *c->delay_periods = out.delay_periods;
    *c->heartbeat = !*c->heartbeat;
    record_period_of(&in, &out);
    *c->tick_time = (hal_s32_t)(rtapi_get_time() - start);
    if (*c->tick_time > c->tick_max)
        c->tick_max = *c->tick_time;
}
