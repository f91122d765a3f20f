/* Power steering by the torque difference of two front drives (Shchur 2019, eq 4): the law of
 * ev_control/electronic_differential/steering_by_drives.py in C, operation by operation, so with the same bits.
 */
#include <math.h>
#include <stddef.h>

#include "ev_laws.h"

enum { GAMMA, STIFFNESS, DAMPING, FRONT_SHARE };

static const ev_parameter parameters[] = {
    [GAMMA] = {"gamma", "1", "amplification of the hand torque", 5.0, 0.0, 50.0},
    [STIFFNESS] = {"k_ck", "N m/rad", "stiffness of the virtual spring", 0.051, 0.0, 10.0},
    [DAMPING] = {"b_ck", "N m s/rad", "virtual damping", 0.062, 0.0, 10.0},
    [FRONT_SHARE] = {"front_share", "1", "share of the brake torque on the front axle", 0.6, 0.0, 1.0},
};

static int32_t step(const ev_electronic_differential_inputs *in, ev_electronic_differential_outputs *out, double *state,
                    const ev_given *given) {
    const ev_driver_command *driver = &in->driver_command;
    const ev_steering_column_state *column = &in->steering_column_state;
    const ev_car *car = &given->car;
    const double *p = given->parameters;
    (void)state;

    const double lever = 2.0 * car->wheel_radius / car->front_track * car->steering_ratio;
    const double difference =
        lever * (p[GAMMA] * column->hand_torque - p[STIFFNESS] * column->angle - p[DAMPING] * column->rate);
    const double equal = driver->drive_torque / car->number_driven, half = difference / 2.0;
    out->torque_request.drive.front_left = car->driven.front_left == 1.0 ? equal - half : 0.0;
    out->torque_request.drive.front_right = car->driven.front_right == 1.0 ? equal + half : 0.0;
    out->torque_request.drive.rear_left = car->driven.rear_left == 1.0 ? equal : 0.0;
    out->torque_request.drive.rear_right = car->driven.rear_right == 1.0 ? equal : 0.0;

    const double front = driver->brake_torque * p[FRONT_SHARE] / 2.0;
    const double rear = driver->brake_torque / 2.0 - front;
    out->torque_request.brake = (ev_wheels){front, front, rear, rear};
    return 0;
}

const ev_electronic_differential_law ev_electronic_differential = {
    .version = EV_VERSION,
    .layout = EV_LAYOUT,
    .inputs_size = sizeof(ev_electronic_differential_inputs),
    .outputs_size = sizeof(ev_electronic_differential_outputs),
    .given_size = sizeof(ev_given),
    .about = "Power steering by the torque difference of two front drives, in C.",
    .reads = EV_READS_DRIVER_COMMAND | EV_READS_STEERING_COLUMN_STATE,
    .number_of_parameters = sizeof(parameters) / sizeof(parameters[0]),
    .parameters = parameters,
    .step = step,
};
