// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/mission_pilot.hpp"

#include <algorithm>

namespace jink::sim {
namespace {

/// Look-ahead distance along the leg [m].
constexpr double kLegCarrot = 6.0;
/// Look-ahead time of a plane: NAVL1_PERIOD 17, NAVL1_DAMPING 0.75 [s].
constexpr double kPlaneCarrot = 4.06;
/// Approach of the last waypoint [1/s].
constexpr double kHoverGain = 0.8;

}  // namespace

Vec MissionPilot::abeam(const Vec& position, double ahead) const
{
    return abeam(scenario_.mission[target_ - 1], position, ahead);
}

Vec MissionPilot::abeam(const Vec& from, const Vec& position, double ahead) const
{
    const Vec span = scenario_.mission[target_] - from;
    const double length = span.norm();
    if (length == 0.0) {
        return from;
    }
    const double s = std::clamp((position - from).dot(span) / length + ahead, 0.0, length);
    return from + span * (s / length);
}

Vec MissionPilot::command(const Vec& position)
{
    if (target_ + 1 < scenario_.mission.size() && (position - scenario_.mission[target_]).norm() < scenario_.reached) {
        ++target_;
        from_.reset();
    }
    const bool last = target_ + 1 == scenario_.mission.size();
    const double ahead = scenario_.vehicle.min_speed > 0.0 ? kPlaneCarrot * scenario_.vehicle.cruise : kLegCarrot;
    const Vec to_end = scenario_.mission[target_] - position;
    const double speed =
        last ? std::min(scenario_.vehicle.cruise, kHoverGain * to_end.norm()) : scenario_.vehicle.cruise;
    const Vec from = from_.value_or(scenario_.mission[target_ - 1]);
    return along(abeam(from, position, ahead) - position, speed, scenario_.vehicle);
}

double MissionPilot::cross_track(const Vec& position) const { return (position - abeam(position, 0.0)).norm(); }

}  // namespace jink::sim
