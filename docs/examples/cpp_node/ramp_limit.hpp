// A traction control that lets torques grow only so fast, and no further than a limit. No ROS, no stack: the law alone,
// which own_asr.cpp puts into a node and ../c_library/ramp_limit.cpp into a shared library.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

struct RampLimit {
    double limit;  // N m, of a wheel
    double rate;   // N m/s

    // The torques of one period [N m]; `last` are those of the period before, and become those of this one.
    void step(double period, const std::array<double, 4> &asked, std::array<double, 4> &last) const {
        for (std::size_t wheel = 0; wheel < asked.size(); ++wheel) {
            const double highest = std::min(last[wheel] + rate * period, limit);
            last[wheel] = std::min(asked[wheel], highest);
        }
    }
};
