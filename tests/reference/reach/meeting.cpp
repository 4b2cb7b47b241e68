// SPDX-License-Identifier: BSD-3-Clause
#include "tests/reference/reach/meeting.hpp"

#include <algorithm>

namespace jink::reach {
namespace {

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

}  // namespace jink::reach
