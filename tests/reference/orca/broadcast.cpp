// SPDX-License-Identifier: BSD-3-Clause
#include "tests/reference/orca/broadcast.hpp"

#include <algorithm>

namespace jink::orca {

float inflation_of(Seconds age, float max_speed, float max_acceleration, const AgeRules& rules) noexcept
{
    const Seconds known = std::clamp(age, 0.0F, rules.lost);
    const float grown = std::min(rules.most, rules.velocity_error * known + 0.5F * max_acceleration * known * known);
    return grown + max_speed * std::max(0.0F, age - rules.lost);
}

PredictedNeighbour predict_neighbour(const Broadcast& heard, TimePoint at, const AgeRules& rules, float reach) noexcept
{
    const Seconds age = at - heard.state.stamp;
    const bool is_lost = age > rules.lost;
    const TimePoint until = is_lost ? heard.state.stamp + rules.lost : at;
    CommandRing commands;
    for (const IssuedCommand& command : heard.commands) {
        static_cast<void>(commands.add(command.issued, command.velocity));
    }
    const Predicted there = predict(heard.state, commands, heard.loop, until);

    PredictedNeighbour neighbour;
    neighbour.position = there.position;
    neighbour.velocity = is_lost ? Vec3(Vec3::Zero()) : there.velocity;
    neighbour.inflation = inflation_of(age, heard.max_speed, heard.max_acceleration, rules);
    if (is_lost) {
        neighbour.freshness = neighbour.inflation > reach ? Freshness::gone : Freshness::lost;
    } else {
        neighbour.freshness = age > rules.stale ? Freshness::stale : Freshness::fresh;
    }
    return neighbour;
}

}  // namespace jink::orca
