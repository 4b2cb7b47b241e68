// SPDX-License-Identifier: BSD-3-Clause
#include "core/orca/bias.hpp"

#include <algorithm>

#include "core/world/passing_side.hpp"

namespace jink::orca {
namespace {

/// The vertical bias grows to its whole within this time after its start.
constexpr Seconds kVerticalRise = 1.0F;

const BiasNeighbour* nearest_ahead(std::span<const BiasNeighbour> neighbours, const Vec3& preferred,
                                   float within) noexcept
{
    const BiasNeighbour* nearest = nullptr;
    float least = within * within;
    for (const BiasNeighbour& neighbour : neighbours) {
        const float distance = neighbour.offset.squaredNorm();
        if (distance < least && neighbour.offset.dot(preferred) > 0.0F) {
            least = distance;
            nearest = &neighbour;
        }
    }
    return nearest;
}

}  // namespace

Biased Bias::apply(std::uint32_t own, const Vec3& preferred, const Vec3& velocity,
                   std::span<const BiasNeighbour> neighbours, Seconds period) noexcept
{
    const float speed = preferred.norm();
    const bool stalls = velocity.norm() < settings_.stalled_below * speed;
    stalled_ = std::clamp(stalls ? stalled_ + period : stalled_ - period, 0.0F, 2.0F * settings_.blocked);

    Biased biased{preferred, stalled_ > settings_.blocked};
    const BiasNeighbour* const neighbour = nearest_ahead(neighbours, preferred, settings_.near);
    if (neighbour == nullptr) {
        return biased;
    }
    biased.preferred += settings_.sideways * speed * neighbour->side;
    if (stalled_ > settings_.stall) {
        const float risen = std::min(1.0F, (stalled_ - settings_.stall) / kVerticalRise);
        const float climb = settings_.vertical * risen * speed;
        biased.preferred.z() += world::climbs(own, neighbour->id) ? climb : -climb;
    }
    return biased;
}

float SlowDown::update(float nearest, Seconds period) noexcept
{
    const float wanted = std::clamp(nearest, kMin, 1.0F);
    const float most = kRate * period;
    factor_ += std::clamp(wanted - factor_, -most, most);
    return factor_;
}

}  // namespace jink::orca
