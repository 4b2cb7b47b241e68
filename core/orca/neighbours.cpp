// SPDX-License-Identifier: BSD-3-Clause
#include "core/orca/neighbours.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/finite.hpp"
#include "core/base/work_units.hpp"

namespace jink::orca {

namespace {

/// One that may be met.
struct Candidate {
    std::uint16_t index = 0;
    std::uint32_t id = 0;
    float urgency = 0.0F;  // (distance - radius) / horizon, less the speed of those that do not give way [m/s]
    float cap = 0.0F;      // own speed if it is left out [m/s]
    bool stale = false;

    [[nodiscard]] bool before(const Candidate& other) const noexcept
    {
        return urgency < other.urgency || (urgency == other.urgency && id < other.id);
    }
};

bool is_sound(const Neighbour& n) noexcept
{
    return is_finite(n.position) && is_finite(n.velocity) && is_not_negative(n.half_width) &&
           is_not_negative(n.half_height) && is_not_negative(n.max_speed) && is_not_negative(n.acceleration) &&
           is_not_negative(n.age);
}

bool gives_way(const NeighbourSettings& settings, const Neighbour& n) noexcept
{
    return n.cooperative && n.age <= settings.stale;
}

/// False for one that can not be met, or is beyond the range: then `horizon` is what is left of it.
bool weigh(const NeighbourSettings& settings, const Neighbour& n, Candidate& out, float& horizon) noexcept
{
    const Pair pair = pair_of(settings, Vec3::Zero(), n, 0);
    const float stretch = pair.across / pair.upright;
    const float steep = std::max(stretch, 1.0F);
    const float distance = Vec3(n.position.x(), n.position.y(), n.position.z() * stretch).norm();
    // Its own word on its top speed may be older than its velocity.
    const float speed = std::max(n.max_speed, n.velocity.norm());
    if (distance >= reach(pair.across, settings.horizon, settings.max_speed, speed, stretch)) {
        return false;
    }
    if (distance > settings.range) {
        horizon = std::min(horizon, effective_horizon(settings.range, pair.across, settings.horizon, settings.max_speed,
                                                      speed, stretch));
        return false;
    }
    const bool alone = !gives_way(settings, n);
    out.id = n.id;
    out.stale = n.age > settings.stale;
    out.urgency = (distance - pair.across) / settings.horizon - (alone ? speed * steep : 0.0F);
    const float gap = std::max(distance - pair.across * settings.cap_ratio, 0.0F);
    const float rate = gap / (settings.cap_horizon * steep);
    out.cap = rate > speed ? rate - speed : alone ? 0.0F : 0.5F * rate;
    return true;
}

}  // namespace

Pair pair_of(const NeighbourSettings& settings, const Vec3& own_velocity, const Neighbour& other,
             std::uint16_t source) noexcept
{
    Pair pair;
    pair.position = other.position;
    pair.own_velocity = own_velocity;
    pair.other_velocity = other.velocity;
    pair.across = settings.cover * (settings.half_width + other.half_width);
    pair.upright = settings.cover * (settings.half_height + other.half_height);
    pair.weights = gives_way(settings, other) ? kShared : kAlone;
    pair.above = world::climbs(settings.own_id, other.id);
    pair.source = source;
    // Each of both may have changed its velocity by so much since the other heard of it. A stale one too still passes
    // on its side.
    constexpr float kBoth = 2.0F;
    constexpr float kCoincident2 = 1e-12F;  // [m2], below which there is no side
    if (other.position.squaredNorm() > kCoincident2) {
        pair.lean = kBoth * other.acceleration * other.age * side(other.position);
    }
    return pair;
}

Selection select(const NeighbourSettings& settings, std::span<const Neighbour> all, WorkBudget& budget) noexcept
{
    Selection out;
    out.horizon = settings.horizon;
    std::array<Candidate, kMaxOrcaNeighbours> kept{};
    std::size_t size = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (!budget.spend(units::kOrcaSelect)) {
            out.exhausted = true;
            out.speed_cap = 0.0F;
            break;
        }
        const Neighbour& n = all[i];
        if (!is_sound(n)) {
            ++out.refused;
            continue;
        }
        Candidate next;
        next.index = static_cast<std::uint16_t>(i);
        if (!weigh(settings, n, next, out.horizon)) {
            continue;
        }
        if (size == kept.size()) {
            if (!next.before(kept.back())) {
                out.speed_cap = std::min(out.speed_cap, next.cap);
                ++out.truncated;
                continue;
            }
            out.speed_cap = std::min(out.speed_cap, kept.back().cap);
            ++out.truncated;
            --size;
        }
        std::size_t place = size++;
        for (; place > 0 && next.before(kept[place - 1]); --place) {
            kept[place] = kept[place - 1];
        }
        kept[place] = next;
    }
    for (std::size_t k = 0; k < size; ++k) {
        out.chosen.unchecked_push_back(kept[k].index);
        out.stale = static_cast<std::uint16_t>(out.stale + (kept[k].stale ? 1U : 0U));
    }
    return out;
}

}  // namespace jink::orca
