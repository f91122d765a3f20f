/* A traction control with one thing wrong, by -D. */
#include <math.h>
#include <stddef.h>

#include "ev_laws.h"

#ifndef LOW
#define LOW 0.0
#endif
#ifndef NEWER
#define NEWER 0
#endif
#ifndef STATUS
#define STATUS 0
#endif
#ifndef ANSWER
#define ANSWER in->torque_request.drive.front_left
#endif
#ifndef BRAKE
#define BRAKE 0.0
#endif

#ifndef NAME
#define NAME "limit"
#endif
#ifdef TWICE
#define COUNT 2
#else
#define COUNT 1
#endif

#ifndef PARAMETERS
#define PARAMETERS parameters
#endif

static const ev_parameter parameters[] = {{NAME, "N m", "unused", 1.0, LOW, INFINITY},
                                          {NAME, "N m", "unused", 1.0, LOW, INFINITY}};

static void start(double *state, const ev_given *given) { state[0] = given->parameters[0]; }

static int32_t step(const ev_asr_inputs *in, ev_asr_outputs *out, double *state, const ev_given *given) {
    (void)given;
    state[0] += 1.0;
    out->torque_command.drive.front_left = ANSWER;
    out->torque_command.brake.rear_left = BRAKE;
    return in->time > 0.025 ? STATUS : 0;
}

#ifndef NO_LAW
const ev_asr_law ev_asr = {EV_VERSION, EV_LAYOUT + NEWER, sizeof(ev_asr_inputs), sizeof(ev_asr_outputs),
                           sizeof(ev_given), "Lets one torque through.", EV_READS_TORQUE_REQUEST, COUNT, PARAMETERS, 1,
                           start, step};
#endif
