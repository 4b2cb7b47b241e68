// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <optional>
#include <string_view>

#include "tests/unit/app/step_bench.hpp"

namespace jink::app::test {

/// Flies, follows modes and set-points, and sends a HEARTBEAT every second and on request.
struct StepFlight : StepBench {
    using StepBench::StepBench;

    StepReport tick()
    {
        if (ticks_++ % 50 == 0 || answer_due_) {
            link::AutopilotReport& r = hear_autopilot();
            r.mode = mode;
            r.custom_mode = static_cast<std::uint32_t>(mode) + 10;
            r.fixed_wing = fixed_wing;
            r.steerable = steerable;
            answer_due_ = false;
        }
        hear_own();
        if (mast && ticks_ % 10 == 1) {
            hear_mast(1, *mast);
        }
        if (intruder) {
            *intruder += 0.02F * intruder_velocity;
        }
        if (intruder && ticks_ % 10 == 1) {
            hear_track(2, *intruder).velocity = intruder_velocity;
        }
        const std::size_t asked = wire.requests.size();
        step();
        Vec3 wanted = mode == link::FlightMode::mission ? Vec3(0.0F, 5.0F, 0.0F) : Vec3(Vec3::Zero());
        if (mode == link::FlightMode::external && !wire.velocities.empty()) {
            wanted = deaf ? Vec3(0.0F, 5.0F, 0.0F) : wire.velocities.back();
        }
        velocity += (wanted - velocity) * (0.02F / 0.25F);
        position += velocity * 0.02F;
        for (std::size_t i = asked; i < wire.requests.size(); ++i) {
            const std::string& r = wire.requests[i];
            if (r == "heartbeat") {
                answer_due_ = answers;
            } else if (obeys) {
                mode = r == "external" ? link::FlightMode::external
                       : r == "hold"   ? link::FlightMode::hold
                                       : link::FlightMode::mission;
            }
        }
        return last;
    }
    template <class Done>
    bool until(Done done, int limit = 600)
    {
        for (int i = 0; i < limit; ++i) {
            if (done(tick())) {
                return true;
            }
        }
        return false;
    }
    [[nodiscard]] int asked_for(std::string_view what) const
    {
        return static_cast<int>(std::count(wire.requests.begin(), wire.requests.end(), what));
    }
    static bool ours(const StepReport& r) { return r.control == Control::ours; }

    link::FlightMode mode = link::FlightMode::mission;
    std::optional<Vec3> mast;      ///< static at this position
    std::optional<Vec3> intruder;  ///< present position
    Vec3 intruder_velocity = Vec3::Zero();
    bool fixed_wing = false;
    bool steerable = true;
    bool obeys = true;
    bool answers = true;
    bool deaf = false;

private:
    bool answer_due_ = false;
    int ticks_ = 0;
};

}  // namespace jink::app::test
