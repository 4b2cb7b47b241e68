// SPDX-License-Identifier: BSD-3-Clause
// Which moving threats come nearest to the leg.
#include <algorithm>
#include <array>
#include <limits>

#include "core/geometric/run.hpp"

namespace jink::geometric::detail {
namespace {

/// Gap between a threat's surface and a point that flies from the world's origin at `velocity`, at the closest approach
/// of the centres within `horizon` [m].
float closest_gap(const Vec3& velocity, const Vec3& start, const AtStart& threat, Seconds horizon) noexcept
{
    const Vec3 apart = threat.motion.position - start;
    const Vec3 closing = threat.motion.velocity - velocity;
    const float squared = closing.squaredNorm();
    const Seconds t = squared > 0.0F ? std::clamp(-apart.dot(closing) / squared, 0.0F, horizon) : 0.0F;
    return (apart + t * closing).norm() - threat.growth.at(t);
}

}  // namespace

/// The moving threats but for the nearest ones; of equally near ones the first is nearer. None where all count.
/// O(threats * threats).
Selection Run::far_threats(Seconds longest) noexcept
{
    Selection far{};
    if (settings_.moving_nearest == 0) {
        return far;
    }
    constexpr float kNotThere = -std::numeric_limits<float>::infinity();
    std::array<float, kMaxTracks> gap{};
    std::size_t moving = 0;
    const std::span tracks = world::of_kind(problem_.threats, world::ThreatKind::track);
    const auto first = static_cast<std::size_t>(tracks.data() - problem_.threats.data());
    for (std::size_t i = 0; i < tracks.size(); ++i) {
        gap[i] = kNotThere;
        if (is_moving(tracks[i])) {
            ++moving;
            gap[i] = i == problem_.main ? std::numeric_limits<float>::lowest()
                                        : closest_gap(problem_.speed * along_, problem_.frame.origin,
                                                      at_start(problem_, tracks[i]), longest);
        }
    }
    static_cast<void>(budget_.spend(units::kFarItem * static_cast<std::uint32_t>(tracks.size())));
    for (; moving > settings_.moving_nearest; --moving) {
        // The last of the farthest.
        std::size_t farthest = 0;
        for (std::size_t i = 1; i < tracks.size(); ++i) {
            farthest = gap[i] >= gap[farthest] ? i : farthest;
        }
        far[first + farthest] = true;
        gap[farthest] = kNotThere;
    }
    return far;
}

}  // namespace jink::geometric::detail
