// SPDX-License-Identifier: BSD-3-Clause
#include "core/orca/prediction.hpp"

#include <algorithm>
#include <cstdint>

#include "core/base/exponential.hpp"

namespace jink::orca {
namespace {

/// `command` acting for `dt` > 0: a velocity error fades exponentially (G-ORCA 11.3).
void fly_command(Predicted& state, const Vec3& command, Seconds dt, Seconds lag) noexcept
{
    const Vec3 error = state.velocity - command;
    if (lag <= 0.0F) {
        state.position += command * dt;
        state.velocity = command;
        return;
    }
    const float faded = faded_share(dt / lag);
    state.position += command * dt + error * (lag * faded);
    state.velocity -= error * faded;
}

}  // namespace

Predicted predict(const vehicle::VehicleState& measured, const CommandRing& issued, const VelocityLoop& loop,
                  TimePoint at) noexcept
{
    Predicted state{measured.position, measured.velocity, false};
    TimePoint t = measured.stamp;
    if (at <= t) {
        state.position += measured.velocity * (at - t);
        return state;
    }
    const std::int64_t act = (TimePoint{} + loop.act).us;
    const auto acts = [&](std::size_t i) { return TimePoint{issued[i].issued.us + act}; };
    const std::size_t n = issued.size();
    std::size_t next = 0;
    while (next < n && acts(next) <= t) {
        ++next;
    }
    if (next == 0) {
        const TimePoint end = n > 0 ? std::min(at, acts(0)) : at;
        state.position += measured.velocity * (end - t);
        state.clipped = true;
        t = end;
    } else {
        --next;  // acts at t
    }
    for (; next < n && t < at; ++next) {
        const TimePoint end = next + 1 < n ? std::min(at, acts(next + 1)) : at;
        fly_command(state, issued[next].velocity, end - t, loop.lag);
        t = end;
    }
    return state;
}

}  // namespace jink::orca
