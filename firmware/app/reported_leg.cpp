// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/reported_leg.hpp"

#include <algorithm>

#include "core/world/conflict.hpp"
#include "firmware/app/motion_estimate.hpp"

namespace jink::app {
namespace {

/// A reported leg this far from the one before is another one [m].
constexpr float kOtherLeg = 0.5F;
/// Cosines: within 30 degrees the motion agrees with a direction, beyond 40 degrees it contradicts.
constexpr float kAlong = 0.866F;
constexpr float kAstray = 0.766F;
/// Off the leg by more than `kOffLeg` [m], and getting further off by this share of the speed, contradicts.
constexpr float kOffLeg = 2.0F;
constexpr float kDeparting = 0.25F;

/// The leg as the vehicle sees it.
struct Seen {
    Vec3 forward = Vec3::Zero();  ///< unit vector along the leg; zero for a point
    Vec3 off = Vec3::Zero();      ///< from the nearest point of the leg to the vehicle [m]
    Vec3 back = Vec3::Zero();     ///< to the point of the leg that a way back to it aims at [m]
    float left = 0.0F;            ///< distance from the end of the leg [m]
};

Seen seen_of(const world::Leg& leg, const Vec3& position) noexcept
{
    const world::Reference reference(leg);
    const path::RouteView route = reference.route();
    const float length = route.length();
    const path::Abeam abeam = route.abeam_of(position);
    Seen seen;
    seen.forward = length > 0.0F ? abeam.point.along : Vec3(Vec3::Zero());
    seen.off = position - abeam.point.position;
    seen.back = route.at(std::min(abeam.arc_length + world::kRejoinLookahead, length)).position - position;
    seen.left = (leg.end - position).norm();
    return seen;
}

float cosine(const Vec3& velocity, const Vec3& direction) noexcept
{
    const float size = velocity.norm() * direction.norm();
    return size > 1e-6F ? velocity.dot(direction) / size : -1.0F;
}

/// Along the leg, back to it, or on its nearest side towards it.
bool agrees(const Vec3& velocity, const Seen& seen, float least) noexcept
{
    const bool to_leg = seen.off.norm() > kOffLeg && cosine(velocity, -seen.off) >= least;
    return cosine(velocity, seen.forward) >= least || cosine(velocity, seen.back) >= least || to_leg;
}

bool contradicts(const Vec3& velocity, const Seen& seen) noexcept
{
    const float off = seen.off.norm();
    const bool departs = off > kOffLeg && velocity.dot(seen.off) > kDeparting * off * velocity.norm();
    return departs || !agrees(velocity, seen, kAstray);
}

}  // namespace

void ReportedLeg::take(const world::Leg* leg) noexcept
{
    const bool is_known = leg != nullptr;
    const bool another = is_known && (!known_ || (leg->start - leg_.start).norm() > kOtherLeg ||
                                      (leg->end - leg_.end).norm() > kOtherLeg);
    if (another) {
        believe();
    }
    known_ = is_known;
    leg_ = is_known ? *leg : leg_;
}

void ReportedLeg::judge(const vehicle::VehicleState& own, float steady_speed) noexcept
{
    const Seconds dt = std::clamp(own.stamp - judged_, 0.0F, 0.1F);
    const float speed = own.velocity.norm();
    if (!known_ || speed < MotionEstimate::kMoving) {
        pass_over(own.stamp);
        return;
    }
    judged_ = own.stamp;
    const Seen seen = seen_of(leg_, own.position);
    const bool turns_soon = seen.left < kCornerTime * speed;
    const bool contradicted = contradicts(own.velocity, seen);
    disagreeing_ = contradicted && !turns_soon ? disagreeing_ + dt : 0.0F;
    agreeing_ = !contradicted && agrees(own.velocity, seen, kAlong) ? agreeing_ + dt : 0.0F;
    if (believed_ && disagreeing_ >= kContradicted) {
        believed_ = false;
        ++doubted_;
    } else if (!believed_ && agreeing_ >= kAgreed) {
        believed_ = true;
    }
    const bool along = cosine(own.velocity, seen.forward) >= kAlong;
    steady_ = along && believed_ && steady_speed > 0.0F ? steady_speed : steady_;
}

void ReportedLeg::pass_over(TimePoint now) noexcept
{
    disagreeing_ = agreeing_ = 0.0F;
    judged_ = now;
}

void ReportedLeg::believe() noexcept
{
    disagreeing_ = agreeing_ = 0.0F;
    believed_ = true;
}

world::Reference ReportedLeg::reference(const vehicle::VehicleState& own, const vehicle::VehicleLimits& limits,
                                        float steady_speed, bool in_control) const noexcept
{
    const float meant = leg_.speed > 0.0F ? leg_.speed : steady_ > 0.0F ? steady_ : limits.cruise_speed;
    const float speed = own.velocity.norm();
    const bool along = !in_control && speed > MotionEstimate::kMoving &&
                       cosine(own.velocity, seen_of(leg_, own.position).forward) >= kAlong;
    world::Reference reference(leg_);
    reference.speed = along ? std::max(steady_speed > 0.0F ? steady_speed : meant, speed) : meant;
    return reference;
}

}  // namespace jink::app
