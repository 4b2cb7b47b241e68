// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>

#include "core/geometric/offsets.hpp"
#include "core/geometric/run.hpp"

// The candidates of a run, and what they may meet.

namespace jink::geometric::detail {
namespace {

float angle_of(int plane, int planes) noexcept { return kPi * static_cast<float>(plane) / static_cast<float>(planes); }

}  // namespace

Wait Run::waiting(float share, Seconds until) const noexcept
{
    Wait wait;
    wait.length = curve_length_x(Family::wait, scale_of(problem_));
    wait.speed = vehicle::clamped_velocity(along_, problem_.speed, limits_).norm();
    wait.start_speed = std::clamp(problem_.start_velocity.dot(along_), 0.0F, wait.speed);
    wait.share = share;
    wait.until = until;
    const float level = std::sqrt(std::max(0.0F, 1.0F - along_.z() * along_.z()));
    const float steep = std::abs(along_.z());
    wait.acceleration =
        kWaitAcceleration / std::max(level / limits_.max_acceleration, steep / limits_.max_vertical_acceleration);
    return wait;
}

void Run::build(const CandidateShape& shape) noexcept
{
    if (shape.family != Family::wait) {
        make_candidate(unit_[static_cast<std::size_t>(shape.family)], problem_, limits_, side_of(shape), shape.offset,
                       base_, curve_);
        return;
    }
    const bool is_straight = problem_.ahead.route.empty();
    const Wait wait = waiting(shape.share, shape.until);
    make_waiting_curve(wait, is_straight ? along_ : Vec3(Vec3::UnitX()), settings_.waypoints, curve_);
    if (!is_straight) {
        bend_along(ReferenceAhead(problem_, limits_, wait.length), curve_);
    }
}

/// `seen`: the problem itself, or what it looks like at the collision point.
void Run::generate_curves(Family family, const Problem& seen) noexcept
{
    const bool is_straight = &seen == &problem_;
    unit_[static_cast<std::size_t>(family)] =
        make_unit_curve(family, settings_.waypoints, problem_.ends_at_top ? 1.0F : curve_length_x(family, 1.0F));
    const int planes = settings_.extra_planes + 1;
    for (int i = 0; i < planes; ++i) {
        Candidate candidate;
        candidate.shape.family = family;
        candidate.shape.plane = angle_of(i, planes);
        const Vec3 side = side_of(candidate.shape);
        candidate.sin_alpha = std::min(std::sqrt(along_.z() * along_.z() + side.z() * side.z()), 1.0F);
        Offsets offsets;
        offsets_of_plane(seen, settings_, family, limits_.half_extents,
                         is_straight ? side : plane_direction(seen.frame, candidate.shape.plane),
                         extents_[static_cast<std::size_t>(i)], offsets);
        for (const float offset : offsets) {
            candidate.shape.offset = offset;
            result_.candidates.unchecked_push_back(candidate);  // is_valid(Settings) has counted them
        }
    }
}

void Run::generate_waits() noexcept
{
    const Seconds arrival = problem_.distance / problem_.speed;
    for (const float share : kWaitShares) {
        for (const float times : kWaitTimes) {
            Candidate candidate;
            candidate.shape.family = Family::wait;
            candidate.shape.share = share;
            candidate.shape.until = times * arrival;
            result_.candidates.unchecked_push_back(candidate);  // is_valid(Settings) has counted them
        }
    }
}

void Run::generate_curves(const Problem& seen) noexcept
{
    if (settings_.offset_rule == OffsetRule::clearing) {
        const MainExtent along = extent_along(seen);
        const int planes = settings_.extra_planes + 1;
        for (int i = 0; i < planes; ++i) {
            extents_[static_cast<std::size_t>(i)] =
                with_sides(seen, plane_direction(seen.frame, angle_of(i, planes)), along);
        }
    }
    for (const Family family : kCurves) {
        if (settings_.*flag_of(family)) {
            generate_curves(family, seen);
        }
    }
}

void Run::generate() noexcept
{
    const int planes = settings_.extra_planes + 1;
    for (int i = 0; i < planes; ++i) {
        sides_[static_cast<std::size_t>(i)] = plane_direction(problem_.frame, angle_of(i, planes));
    }
    if (problem_.ahead.route.empty()) {
        generate_curves(problem_);
    } else {
        generate_curves(seen_at_collision(problem_, limits_));
    }
    if (settings_.wait && limits_.kind == vehicle::VehicleKind::multirotor) {
        generate_waits();
    }
}

void Run::prepare() noexcept
{
    float widest = 0.0F;
    for (const Candidate& candidate : result_.candidates) {
        widest = std::max(widest, std::abs(candidate.shape.offset));
    }
    const bool mirrored = settings_.symmetric || settings_.smooth || settings_.plateau;
    float length = curve_length_x(mirrored ? Family::symmetric : Family::simple, scale_of(problem_));
    const float slowest = std::min({problem_.speed, limits_.max_climb, limits_.max_descent});
    Seconds longest = (length + 2.0F * widest) / slowest;
    if (settings_.wait) {
        const Wait wait = waiting(0.0F, kWaitTimes.back() * problem_.distance / problem_.speed);
        const Seconds change = wait.speed / wait.acceleration;
        length = std::max(length, wait.speed * wait.until) + wait.speed * change;
        longest = std::max(longest, wait.until + change + wait.length / wait.speed);
    }
    const Vec3 end = length * along_;
    const Vec3 aside = Vec3::Constant(widest);
    far_ = far_threats(longest);
    if (!settings_.evaluate_all) {
        clearance_.defer(far_);
        flown_.defer(far_);
    }
    Extent reach{end.cwiseMin(0.0F) - aside, end.cwiseMax(0.0F) + aside};
    if (!problem_.ahead.route.empty()) {
        static_cast<void>(budget_.spend(units::kRoute));
        reach_along(problem_, length, widest, slowest, reach, longest);
    }
    clearance_.collect(reach, longest, budget_);
    if (settings_.security == SecurityMode::swept || settings_.closeness == cost::ClosenessMethod::swept) {
        for (const Candidate& candidate : result_.candidates) {
            if (!budget_.spend(units_of_curve())) {
                return;
            }
            build(candidate.shape);
            longest_ = std::max(longest_, curve_.duration());
        }
        clearance_.sweep_until(longest_);
    }
    list_moving();
}

/// Motion about the start, and size there; a solid as the sphere about it, which does not grow.
AtStart Run::about_start(const world::Threat& threat) const noexcept
{
    AtStart start = at_start(problem_, threat);
    start.motion.position -= problem_.frame.origin;
    if (threat.form == world::ThreatForm::solid) {
        start.growth.radius = geometry::bounding_radius(*threat.solid) + threat.growth.radius;
    }
    return start;
}

void Run::list_moving() noexcept
{
    std::array<float, kMaxMoving> distance{};
    for (std::size_t i = 0; i < problem_.threats.size(); ++i) {
        const world::Threat& threat = problem_.threats[i];
        const bool is_near_track = threat.ref.kind == world::ThreatKind::track && !far_[i];
        const bool is_solid = threat.ref.kind == world::ThreatKind::obstacle;
        if ((is_near_track && threat.velocity.squaredNorm() > 0.0F) || (is_solid && is_moving(threat))) {
            const AtStart start = about_start(threat);
            distance[moving_.size()] = start.motion.position.norm() - start.growth.radius;
            moving_.unchecked_push_back(static_cast<std::uint16_t>(i));
        }
    }
    while (settings_.closeness_nearest > 0 && moving_.size() > settings_.closeness_nearest) {
        const auto count = static_cast<std::ptrdiff_t>(moving_.size());
        const auto farthest =
            static_cast<std::size_t>(std::max_element(distance.begin(), distance.begin() + count) - distance.begin());
        distance[farthest] = distance[moving_.size() - 1];
        moving_.swap_erase(farthest);
    }
}

}  // namespace jink::geometric::detail
