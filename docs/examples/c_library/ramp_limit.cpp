// The law of ../cpp_node/ramp_limit.hpp as a shared library, in C++.
#include "../cpp_node/ramp_limit.hpp"

#include <cmath>
#include <cstring>

#include "ev_laws.h"

namespace {

const ev_parameter parameters[] = {
    {"limit", "N m", "largest drive torque of a wheel", 1000.0, 0.0, 10000.0},
    {"rate", "N m/s", "fastest growth of a drive torque", 2000.0, 0.0, INFINITY},
};

int32_t step(const ev_asr_inputs *in, ev_asr_outputs *out, double *state, const ev_given *given) {
    const ev_wheels &drive = in->torque_request.drive;
    const RampLimit law{given->parameters[0], given->parameters[1]};
    std::array<double, 4> last{};
    std::memcpy(last.data(), state, sizeof(last));
    law.step(given->period, {drive.front_left, drive.front_right, drive.rear_left, drive.rear_right}, last);
    std::memcpy(state, last.data(), sizeof(last));
    out->torque_command.drive = {last[0], last[1], last[2], last[3]};
    out->torque_command.brake = in->torque_request.brake;
    return 0;
}

}  // namespace

const ev_asr_law ev_asr = {
    EV_ASR, "Lets drive torques grow only so fast, in C++.", EV_READS_TORQUE_REQUEST, 2, parameters, 4, nullptr, step,
};
