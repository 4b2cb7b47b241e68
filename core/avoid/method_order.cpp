// SPDX-License-Identifier: BSD-3-Clause
#include "core/avoid/method_order.hpp"

#include <algorithm>

namespace jink::avoid {

std::size_t count_near(const world::Situation& situation, float radius) noexcept
{
    const Vec3& own = situation.own.position;
    const auto is_near = [&](const world::Threat& threat) {
        switch (threat.ref.kind) {
        case world::ThreatKind::track:
            return (threat.nearest_in_height(0.0F, own.z()) - own).norm() <= radius + threat.radius_at(0.0F);
        case world::ThreatKind::obstacle:
            return (threat.position - own).norm() <= radius + geometry::bounding_radius(*threat.solid);
        default: return false;
        }
    };
    return static_cast<std::size_t>(std::count_if(situation.threats.begin(), situation.threats.end(), is_near));
}

const MethodOrder& order_for(const world::Situation& situation, const Settings& settings) noexcept
{
    const bool may_change = settings.clutter > 0 && !settings.order_in_clutter.empty();
    const bool cluttered = may_change && count_near(situation, settings.clutter_radius) >= settings.clutter;
    return cluttered ? settings.order_in_clutter : settings.order;
}

}  // namespace jink::avoid
