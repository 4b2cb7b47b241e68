// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/motion_path.hpp"

#include <array>
#include <cmath>

#include "core/base/angle.hpp"

namespace jink::app {
namespace {

/// Level motion may climb by so much: an arc lies level [m/s].
constexpr float kMaxLevelClimb = 0.3F;
/// Ends of the legs of a turn that climbs: after 60, 120 and 180 degrees.
constexpr std::array<SineCosine, 3> kTurnLegs = {{{0.866025404F, 0.5F}, {0.866025404F, -0.5F}, {0.0F, -1.0F}}};

}  // namespace

/// A turn from where the vehicle is: an arc, or legs where it climbs or descends; then straight on. False where there
/// is none, or where a route has too few segments (kMaxRouteSegments).
bool MotionPath::add_turn(const vehicle::VehicleState& own, float turn_rate) noexcept
{
    const Vec3 level(own.velocity.x(), own.velocity.y(), 0.0F);
    const float speed = level.norm();
    const float radius = speed / std::abs(turn_rate);
    if (turn_rate == 0.0F || radius < path::Route::kMinRadius || radius > path::Route::kLargestRadius) {
        return false;
    }
    const float sense = std::copysign(1.0F, turn_rate);
    const Vec3 left = Vec3(-level.y(), level.x(), 0.0F) / speed;
    const Vec3 centre = own.position + sense * radius * left;
    const float climb = own.velocity.z();
    if (std::abs(climb) <= kMaxLevelClimb) {
        if (route_.add_arc(own.position, centre, Vec3::UnitZ(), sense * kPi) != path::RouteStatus::ok) {
            return false;
        }
    } else {
        Vec3 at = own.position;
        const float rise = climb * (kPi / static_cast<float>(kTurnLegs.size())) / std::abs(turn_rate);
        for (const SineCosine& turned : kTurnLegs) {
            const Vec3 on_circle = centre + radius * (turned.sine * level / speed - turned.cosine * sense * left);
            const Vec3 next(on_circle.x(), on_circle.y(), at.z() + rise);
            if (route_.add_leg(at, next) != path::RouteStatus::ok) {
                return false;
            }
            at = next;
        }
    }
    const path::RoutePoint end = route_.at(route_.length());
    const Vec3 on(-own.velocity.x(), -own.velocity.y(), climb);
    return route_.add_leg(end.position, end.position + kAhead * on) == path::RouteStatus::ok;
}

void MotionPath::extrapolate(const vehicle::VehicleState& own, float turn_rate,
                             const vehicle::VehicleLimits& limits) noexcept
{
    const float speed = own.velocity.norm();
    if (!(speed >= kStanding)) {
        stay(own.position, limits);
        return;
    }
    route_.clear();
    if (add_turn(own, turn_rate)) {
        reference_ = world::Reference(route_, speed);
    } else {
        route_.clear();
        reference_ = world::Reference({own.position, own.position + own.velocity * kAhead, speed});
    }
    reference_.measured = true;
}

void MotionPath::stay(const Vec3& place, const vehicle::VehicleLimits& limits) noexcept
{
    route_.clear();
    reference_ = world::Reference({place, place, limits.cruise_speed});
}

void MotionPath::copy_from(const MotionPath& other) noexcept
{
    route_.clear();
    reference_ = other.reference_.moved_to(route_);
}

void MotionPath::progress_to(const Vec3& position) noexcept
{
    reference_.segment = reference_.route().abeam_of(position, reference_.segment).segment;
}

}  // namespace jink::app
