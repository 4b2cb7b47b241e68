// SPDX-License-Identifier: BSD-3-Clause
#include "core/orca/obstacle_way.hpp"

#include <algorithm>
#include <cassert>

#include "core/orca/obstacle_view.hpp"

namespace jink::orca {

namespace {

using detail::ObstacleView;
using detail::Sighting;

struct Way {
    Vec3 position;
    Vec3 velocity;   ///< [m/s]
    Vec3 stretched;  ///< the same in the stretched space
    Seconds length;

    [[nodiscard]] Vec3 at(Seconds t) const noexcept { return position + t * velocity; }
};

struct Advance {
    Seconds until = 0.0F;
    bool clear = false;
    bool bounded = false;
};

/// One obstacle; `sight(point)` -> Sighting.
///
/// What is proven of a place is a plane with all of the obstacle behind it: on the way towards it the margin shrinks no
/// faster than the speed along the plane's normal, and not at all on the way off.
template <class Sight>
Advance advance(const Way& way, float radius, float resolution, const Sight& sight, WorkBudget& budget) noexcept
{
    Advance result;
    float wanted = radius;
    for (std::uint32_t step = 0; step < kMaxWaySteps; ++step) {
        const Sighting seen = sight(way.at(result.until));
        if (budget.exhausted()) {
            result.bounded = true;
            return result;
        }
        if (step == 0) {
            wanted = std::min(radius, seen.distance);
        }
        const float left = seen.distance - wanted;
        const float closing = way.stretched.dot(seen.direction);
        if (closing * (way.length - result.until) <= std::max(left, 0.0F)) {
            return {way.length, true, false};
        }
        if (left <= resolution && step > 0) {
            return result;
        }
        if (left <= 0.0F) {
            return result;
        }
        result.until += left / closing;
    }
    result.bounded = true;
    return result;
}

/// Takes what one obstacle says; the way ends where the first of them does.
void take(const Advance& found, std::uint16_t source, Way& way, WayClearance& out) noexcept
{
    if (found.clear || (!out.clear && found.until >= out.clear_until)) {
        return;
    }
    out = {found.until, source, false, found.bounded};
    way.length = found.until;
}

}  // namespace

WayClearance clearance_along(Obstacles obstacles, const Vec3& position, const Vec3& velocity, Seconds length,
                             const ObstacleSettings& settings, WorkBudget& budget) noexcept
{
    assert(is_valid(settings) && is_finite(position) && is_finite(velocity) && length >= 0.0F);
    const ObstacleView view{obstacles, envelope_of(settings), settings.resolution};
    const float stretch = view.envelope.stretch;
    const float radius = view.envelope.radius;
    Way way{position, velocity, {velocity.x(), velocity.y(), stretch * velocity.z()}, length};
    WayClearance out{length, 0, true, false};
    // All of the way lies within half its length of its middle.
    constexpr float kRoom = 1.0F + 1e-5F;
    const Vec3 middle = way.at(0.5F * length);
    const float reach = kRoom * (radius + 0.5F * length * way.stretched.norm()) + settings.resolution;
    for (std::size_t i = 0; i < obstacles.size(); ++i) {
        if (view.obstacle_bound(i, middle) <= reach) {
            const auto sight = [&](const Vec3& at) { return view.obstacle(i, at, 2.0F * reach, budget); };
            take(advance(way, radius, settings.resolution, sight, budget), static_cast<std::uint16_t>(i), way, out);
        }
    }
    return out;
}

}  // namespace jink::orca
