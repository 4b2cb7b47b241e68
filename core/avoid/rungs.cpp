// SPDX-License-Identifier: BSD-3-Clause
#include "core/avoid/rungs.hpp"

#include <algorithm>

namespace jink::avoid {

std::size_t count_near(const world::Situation& situation, float radius) noexcept
{
    const Vec3& own = situation.own.position;
    const auto tracks = std::count_if(situation.tracks.begin(), situation.tracks.end(), [&](const world::Track& track) {
        const Vec3 nearest = world::nearest_in_height(track, track.position, own.z());
        return (nearest - own).norm() <= radius + world::threat_radius(situation, track, 0.0F);
    });
    const auto obstacles =
        std::count_if(situation.obstacles.begin(), situation.obstacles.end(), [&](const world::Obstacle& obstacle) {
            return (obstacle.shape.centre - own).norm() <= radius + geometry::bounding_radius(obstacle.shape);
        });
    return static_cast<std::size_t>(tracks + obstacles);
}

Rungs rungs_of(std::size_t methods, const world::Situation& situation, const Settings& settings) noexcept
{
    const std::size_t last = methods - 1;
    switch (settings.order) {
    case LadderOrder::first: return {0, 1, false};
    case LadderOrder::last: return {last, 1, false};
    case LadderOrder::reversed: return {last, methods, true};
    case LadderOrder::as_given: break;
    }
    const bool cluttered =
        methods > 1 && settings.clutter > 0 && count_near(situation, settings.clutter_radius) >= settings.clutter;
    return cluttered ? Rungs{last, methods, true} : Rungs{0, methods, false};
}

}  // namespace jink::avoid
