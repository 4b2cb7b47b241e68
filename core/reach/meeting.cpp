// SPDX-License-Identifier: BSD-3-Clause
#include "core/reach/meeting.hpp"

#include <algorithm>
#include <cmath>

#include "core/reach/predictor.hpp"

namespace jink::reach {
namespace {

/// Of the distances in a closest approach: more than single precision loses.
constexpr float kApproachSlack = 2e-6F;

Pose<float> pose_of(const ReachSet& set, std::size_t node) noexcept
{
    Pose<float> pose;
    pose.position = set.position_of(node);
    pose.pitch = static_cast<float>(set.attitude[2 * node]) * set.step.pitch;
    pose.yaw = static_cast<float>(set.attitude[2 * node + 1]) * set.step.yaw;
    return pose;
}

void widen(Stay& stay, const Stay& by) noexcept
{
    stay.from = std::min(stay.from, by.from);
    stay.to = std::max(stay.to, by.to);
}

}  // namespace

std::optional<CellStay> stay_of(const ReachSet& set, std::size_t node, std::size_t sample, float period) noexcept
{
    const float samples = static_cast<float>(set.samples);
    const Pose<float> there = at_share(pose_of(set, set.parent[node]), static_cast<Movement>(set.movement[node]),
                                       static_cast<float>(sample) / samples, set.step);
    const Located at = set.grid.locate(there.position);
    if (at.status != LocateStatus::inside) {
        return std::nullopt;
    }
    const float begin = static_cast<float>(set.depth[node] - 1);
    const float number = static_cast<float>(sample);
    return CellStay{set.grid.index(at.place),
                    {(begin + (number - 1.0F) / samples) * period, (begin + (number + 1.0F) / samples) * period}};
}

void cell_times(const ReachSet& set, float period, std::span<Stay> out) noexcept
{
    std::ranges::fill(out, kNever);
    for (std::size_t node = 1; node < set.nodes(); ++node) {
        for (std::size_t sample = 1; sample <= set.samples; ++sample) {
            if (const std::optional<CellStay> stay = stay_of(set, node, sample, period)) {
                widen(out[stay->cell], stay->stay);
            }
        }
    }
}

void fill_meetings(const CombinedModel& model, std::span<const CellBall> balls, std::span<Stay> out) noexcept
{
    for (std::size_t cell = 0; cell < out.size(); ++cell) {
        out[cell] = model.in(static_cast<CellIndex>(cell), balls[cell], std::nullopt).stay.value_or(kNever);
    }
}

bool meets_in_cells(const ReachSet& set, std::size_t node, float period, std::span<const Stay> table) noexcept
{
    const std::size_t cells = set.grid.cells();
    for (std::size_t sample = 1; node > 0 && sample <= set.samples; ++sample) {
        const std::optional<CellStay> own = stay_of(set, node, sample, period);
        if (!own) {
            continue;
        }
        for (std::size_t at = own->cell; at < table.size(); at += cells) {
            if (meet(own->stay, table[at])) {
                return true;
            }
        }
    }
    return false;
}

float growth_of(const Intruder& intruder, float t) noexcept
{
    const float spread = std::min(std::max(intruder.horizontal, intruder.vertical), kMostSpread);
    return (std::tan(spread) + intruder.speed_share) * intruder.velocity.norm() * t;
}

bool meets(const Vec3& from, const Vec3& to, float t_from, float t_to, const Intruder& intruder, float margin) noexcept
{
    const Vec3 first = from - (intruder.position + t_from * intruder.velocity);
    const Vec3 last = to - (intruder.position + t_to * intruder.velocity);
    const Vec3 along = last - first;
    const float length = along.squaredNorm();
    const float share = length > 0.0F ? std::clamp(-first.dot(along) / length, 0.0F, 1.0F) : 0.0F;
    const float least = (first + share * along).norm();
    const float slack =
        kApproachSlack * (from.norm() + to.norm() + intruder.position.norm() + t_to * intruder.velocity.norm());
    // The other way round what is not a number would be clear.
    return !(least > intruder.radius + margin + growth_of(intruder, t_to) + slack);
}

bool meets(const ReachSet& set, std::size_t node, float period, const Intruder& intruder, float margin) noexcept
{
    if (node == 0) {
        return false;
    }
    // Half a unit along each axis, and what sums of float positions lose.
    constexpr float kStoredError = kPositionUnit;
    const float begin = static_cast<float>(set.depth[node] - 1);
    const float aside = chord_deviation(set.step, static_cast<Movement>(set.movement[node])) + kStoredError;
    return meets(set.position_of(set.parent[node]), set.position_of(node), begin * period, (begin + 1.0F) * period,
                 intruder, margin + aside);
}

}  // namespace jink::reach
