// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/threat.hpp"

#include <algorithm>
#include <cmath>

namespace jink::sim {
namespace {

/// Vector from the nearest point of the threat's axis to `point`.
Vec from_axis(const Threat& threat, const Vec& centre, const Vec& point) noexcept
{
    Vec gap = point - centre;
    gap.z() -= std::clamp(gap.z(), -threat.half_height, threat.half_height);
    return gap;
}

/// Distance to a body from the excess beyond its faces in independent directions; inside, to the nearest face.
template <int N>
double beyond_faces(const Eigen::Matrix<double, N, 1>& beyond) noexcept
{
    return beyond.cwiseMax(0.0).norm() + std::min(0.0, beyond.maxCoeff());
}

}  // namespace

std::string_view to_string(SensedBy by) noexcept
{
    switch (by) {
    case SensedBy::traffic: return "traffic";
    case SensedBy::point: return "point";
    case SensedBy::lidar: return "lidar";
    case SensedBy::scan: break;
    }
    return "scan";
}

std::string_view to_string(Form form) noexcept
{
    switch (form) {
    case Form::cylinder: return "cylinder";
    case Form::box: return "box";
    case Form::sphere: break;
    }
    return "sphere";
}

Vec Threat::position_at(double t) const noexcept
{
    Vec at = position;
    Vec moving = velocity;
    double since = 0.0;
    for (const Turn& turn : turns) {
        if (t <= turn.at) {
            break;
        }
        at += moving * (turn.at - since);
        moving = turn.velocity;
        since = turn.at;
    }
    return at + moving * (t - since);
}

Vec Threat::velocity_at(double t) const noexcept
{
    Vec moving = velocity;
    for (const Turn& turn : turns) {
        if (t <= turn.at) {
            break;
        }
        moving = turn.velocity;
    }
    return moving;
}

bool Threat::at_rest() const noexcept
{
    return velocity.norm() == 0.0 &&
           std::all_of(turns.begin(), turns.end(), [](const Turn& turn) { return turn.velocity.norm() == 0.0; });
}

double surface_distance(const Threat& threat, const Vec& centre, const Vec& point) noexcept
{
    const Vec gap = (point - centre).cwiseAbs();
    switch (threat.form) {
    case Form::box: return beyond_faces<3>(gap - threat.half_extents);
    case Form::cylinder: return beyond_faces<2>({gap.head<2>().norm() - threat.radius, gap.z() - threat.half_height});
    case Form::sphere: break;
    }
    return from_axis(threat, centre, point).norm() - threat.radius;
}

double box_distance(const Threat& threat, const Vec& centre, const Vec& point, const Vec& half) noexcept
{
    Vec gap = (centre - point).cwiseAbs();
    if (threat.form == Form::box) {
        return (gap - half - threat.half_extents).cwiseMax(0.0).norm();
    }
    gap.z() -= threat.half_height;
    if (threat.form == Form::cylinder) {
        const double level = (gap - half).head<2>().cwiseMax(0.0).norm() - threat.radius;
        return std::hypot(std::max(0.0, level), std::max(0.0, gap.z() - half.z()));
    }
    return std::max(0.0, (gap - half).cwiseMax(0.0).norm() - threat.radius);
}

Nearest nearest_in_step(const Threat& threat, const Vec& centre_from, const Vec& centre_to, const Vec& from,
                        const Vec& to) noexcept
{
    const double at_start = surface_distance(threat, centre_from, from);
    const double at_end = surface_distance(threat, centre_to, to);
    Nearest nearest = at_end < at_start ? Nearest{at_end, 1.0} : Nearest{at_start, 0.0};
    if (threat.form != Form::sphere || threat.half_height > 0.0) {
        return nearest;
    }
    const Vec gap = from - centre_from;
    const Vec motion = (to - from) - (centre_to - centre_from);
    const double length2 = motion.squaredNorm();
    if (length2 > 0.0) {
        const double share = std::clamp(-gap.dot(motion) / length2, 0.0, 1.0);
        const double distance = (gap + motion * share).norm() - threat.radius;
        if (distance < nearest.distance) {
            nearest = {distance, share};
        }
    }
    return nearest;
}

}  // namespace jink::sim
