// SPDX-License-Identifier: BSD-3-Clause
#include "core/path/timed_path.hpp"

#include <algorithm>

namespace jink::path {
namespace {

/// Two points nearer than this have no reliable direction in float [m].
constexpr float kShortestSegment = 1e-6F;

}  // namespace

PathSample sample(const TimedPath& path, Seconds t) noexcept
{
    const auto& points = path.points;
    if (t <= points.front().time) {
        return {points.front().position, points.front().velocity};
    }
    if (t >= points.back().time) {
        return {points.back().position, points.back().velocity};
    }
    const PathPoint* const next =
        std::upper_bound(points.begin(), points.end(), t, [](Seconds at, const PathPoint& p) { return at < p.time; });
    const PathPoint& from = *(next - 1);
    const float share = (t - from.time) / (next->time - from.time);
    return {from.position + share * (next->position - from.position), from.velocity};
}

float arc_length(const TimedPath& path) noexcept
{
    float length = 0.0F;
    for (std::size_t i = 1; i < path.points.size(); ++i) {
        length += (path.points[i].position - path.points[i - 1].position).norm();
    }
    return length;
}

bool make_timed_path(std::span<const Vec3> positions, float speed, const vehicle::VehicleLimits& limits,
                     TimedPath& out) noexcept
{
    out.points.clear();
    if (positions.size() < 2 || positions.size() > decltype(out.points)::capacity()) {
        return false;
    }
    PathPoint last{positions.front(), Vec3::Zero(), 0.0F};
    for (const Vec3& position : positions.subspan(1)) {
        const Vec3 step = position - last.position;
        const float length = step.norm();
        if (!(length > kShortestSegment)) {
            continue;
        }
        const Vec3 velocity = vehicle::clamped_velocity(step, speed, limits);
        const Seconds arrival = last.time + length / velocity.norm();
        if (!(arrival > last.time)) {
            continue;
        }
        last.velocity = velocity;
        out.points.unchecked_push_back(last);
        last = {position, velocity, arrival};
    }
    if (out.points.empty()) {
        return false;
    }
    out.points.unchecked_push_back(last);
    return true;
}

}  // namespace jink::path
