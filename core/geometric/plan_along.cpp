// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "core/geometric/along_reference.hpp"
#include "core/geometric/run.hpp"

// What plans and runs do otherwise along a reference that is not straight.

namespace jink::geometric::detail {
namespace {

/// Farthest end of a curve in D: twice the scale, with the farthest apex of all attempts.
constexpr float kFarthestEnd =
    kSymmetricLength * std::max_element(kAttempts.begin(), kAttempts.end(), [](const Attempt& a, const Attempt& b) {
                           return a.apex_share < b.apex_share;
                       })->apex_share;

}  // namespace

void follow_route(const world::Situation& situation, const world::Way& way, const world::Conflict& conflict,
                  Problem& problem) noexcept
{
    if (way.ahead.joined_at >= way.ahead.route.length()) {
        return;  // straight to the route's end, past which curves go on straight
    }
    if (way.ahead.straight >= kFarthestEnd * conflict.way_at_closest) {
        problem.straight = way.ahead.straight;
        return;
    }
    if (is_leg(way.ahead.route)) {
        problem.frame = make_path_frame(way.origin, conflict.own_at_closest - way.origin);
        return;
    }
    problem.ahead = way.ahead;
    problem.distance = conflict.way_at_closest;
    problem.speed = situation.reference.speed;
    problem.main_centre_offset = conflict.threat_at_closest - collision_point(problem);
}

bool move_start_along(const world::Situation& situation, const Vec3& by, float least, Problem& problem) noexcept
{
    const Vec3 start = problem.frame.origin + by;
    const world::Way way = world::way_from(situation, start);
    const Vec3 threat = collision_point(problem) + problem.main_centre_offset;
    const float on_route = problem.distance - problem.ahead.straight + problem.ahead.joined_at;
    const float distance = on_route >= way.ahead.joined_at ? way.ahead.straight + (on_route - way.ahead.joined_at)
                                                           : (collision_point(problem) - start).dot(way.direction);
    if (!(distance >= least)) {
        return false;
    }
    problem.frame = make_path_frame(start, way.direction);
    problem.ahead = way.ahead;
    problem.distance = distance;
    problem.main_centre_offset = threat - collision_point(problem);
    return true;
}

/// A wait along a bend turns while it slows down, and may climb where the way does not at its start.
bool Run::is_wait_flyable(const CandidateShape& shape) const noexcept
{
    if (problem_.ahead.route.empty()) {
        return true;  // it is made of what the vehicle can do
    }
    constexpr float kRounding = 1.01F;
    for (std::size_t i = 0; i + 1 < curve_.points; ++i) {
        const float rise = curve_.z[i + 1] - curve_.z[i];
        const Seconds time = kRounding * (curve_.t[i + 1] - curve_.t[i]);
        if (rise > limits_.max_climb * time || -rise > limits_.max_descent * time) {
            return false;
        }
    }
    const Wait wait = waiting(shape.share, shape.until);
    const Vec3 rejoin =
        path::point_of(problem_.ahead, problem_.frame.origin, along_, curve_length_x(Family::wait, scale_of(problem_)))
            .along;
    return is_flyable(curve_, along_ * wait.start_speed, rejoin, limits_);
}

}  // namespace jink::geometric::detail
