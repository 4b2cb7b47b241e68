// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/nominal_paths.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/angle.hpp"
#include "core/world/conflict.hpp"

namespace jink::app {
namespace {

constexpr Seconds kSpacing = 0.09F;  ///< of samples: kSamples of them span the window
constexpr Seconds kGap = 0.5F;       ///< own state that was missing for longer begins anew [s]
/// Speeds within the window closer together than this are one steady speed [m/s].
constexpr float kSteady = 0.5F;
/// A reported leg this far from the one before is another one [m].
constexpr float kOtherLeg = 0.5F;
/// Cosines: within 30 degrees the motion agrees with a direction, beyond 40 degrees it contradicts.
constexpr float kAlong = 0.866F;
constexpr float kAstray = 0.766F;
/// Off the leg by more than `kOffLeg` [m], and getting further off by this share of the speed, contradicts.
constexpr float kOffLeg = 2.0F;
constexpr float kDeparting = 0.25F;
/// The way back aims so far ahead, as world::way_of has it.
constexpr float kBackAhead = world::kRejoinLookahead;
/// Of the cruise speed: slower motion may be the drift of a vehicle that waits.
constexpr float kDriftShare = 0.5F;
/// Level motion may climb by so much: an arc lies level [m/s].
constexpr float kLevel = 0.3F;
/// Ends of the legs of a turn that climbs: after 60, 120 and 180 degrees.
constexpr std::array<SineCosine, 3> kTurnLegs = {{{0.866025404F, 0.5F}, {0.866025404F, -0.5F}, {0.0F, -1.0F}}};

/// Of the level parts, counter-clockwise from `a` to `b`, within half a turn either way [rad].
float level_angle(const Vec3& a, const Vec3& b) noexcept
{
    return direction_angle(a.x() * b.y() - a.y() * b.x(), a.x() * b.x() + a.y() * b.y());
}

/// The leg as the vehicle sees it.
struct Seen {
    Vec3 forward = Vec3::Zero();  ///< unit vector along the leg; zero for a point
    Vec3 off = Vec3::Zero();      ///< from the nearest point of the leg to the vehicle [m]
    Vec3 back = Vec3::Zero();     ///< to where the way back to the leg aims [m]
    float left = 0.0F;            ///< to the end of the leg [m]
};

Seen seen_of(const world::Leg& leg, const Vec3& position) noexcept
{
    const Vec3 span = leg.end - leg.start;
    const float length = span.norm();
    Seen seen;
    seen.forward = length > 1e-3F ? Vec3(span / length) : Vec3(Vec3::Zero());
    const float along = std::clamp((position - leg.start).dot(seen.forward), 0.0F, length);
    seen.off = position - (leg.start + along * seen.forward);
    seen.back = leg.start + std::min(along + kBackAhead, length) * seen.forward - position;
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

void NominalPaths::Motion::copy_from(const Motion& other) noexcept
{
    reference = other.reference;
    route = other.route;
    if (!route.empty()) {
        reference = world::Reference(route, reference.speed, reference.segment);
    }
}

void NominalPaths::reset() noexcept
{
    samples_.clear();
    turn_rate_ = steady_now_ = 0.0F;
    disagreeing_ = agreeing_ = 0.0F;
    believed_ = true;
    outdated_ = true;
}

void NominalPaths::sample(const vehicle::VehicleState& measured) noexcept
{
    const Seconds since = samples_.empty() ? kSpacing : measured.stamp - samples_.back().at;
    if (since < kSpacing) {
        if (since < 0.0F) {
            samples_.clear();  // the clock was set back
        }
        return;
    }
    if (since > kGap) {
        samples_.clear();
    }
    if (samples_.full()) {
        std::move(samples_.begin() + 1, samples_.end(), samples_.begin());
        samples_.pop_back();
    }
    const Vec3& before = samples_.empty() ? measured.velocity : samples_.back().velocity;
    samples_.unchecked_push_back({measured.stamp, level_angle(before, measured.velocity), measured.velocity});
    estimate();
}

/// Turn rate by least squares over the window, and whether the speed is steady.
void NominalPaths::estimate() noexcept
{
    turn_rate_ = steady_now_ = 0.0F;
    const TimePoint last = samples_.back().at;
    float n = 0.0F, t_sum = 0.0F, h_sum = 0.0F, tt = 0.0F, th = 0.0F, oldest = 0.0F, speeds = 0.0F;
    float h = 0.0F;  // heading, less the newest one
    float slowest = samples_.back().velocity.norm();
    float fastest = slowest;
    bool moves = true;
    for (std::size_t i = samples_.size(); i > 0; --i) {
        const Sample& s = samples_[i - 1];
        const Seconds t = s.at - last;
        if (t < -kWindow - 0.5F * kSpacing) {
            break;
        }
        n += 1.0F;
        t_sum += t;
        h_sum += h;
        tt += t * t;
        th += t * h;
        h -= s.turned;
        oldest = std::min(oldest, t);
        const float speed = s.velocity.norm();
        speeds += speed;
        slowest = std::min(slowest, speed);
        fastest = std::max(fastest, speed);
        moves = moves && s.velocity.head<2>().squaredNorm() > kMoving * kMoving;
    }
    const float spread = n * tt - t_sum * t_sum;
    if (oldest > -0.8F * kWindow || !(spread > 0.0F)) {
        return;
    }
    const float rate = (n * th - t_sum * h_sum) / spread;
    turn_rate_ = moves && std::abs(rate) >= kMinTurn ? rate : 0.0F;
    steady_now_ = slowest > kMoving && fastest - slowest < kSteady ? speeds / n : 0.0F;
}

/// Another leg is believed until the motion contradicts it too.
void NominalPaths::take_leg(const world::Leg* leg) noexcept
{
    const bool has = leg != nullptr;
    const bool another =
        has && (!has_leg_ || (leg->start - leg_.start).norm() > kOtherLeg || (leg->end - leg_.end).norm() > kOtherLeg);
    if (another) {
        believed_ = true;
        disagreeing_ = agreeing_ = 0.0F;
    }
    has_leg_ = has;
    leg_ = has ? *leg : leg_;
}

void NominalPaths::judge_leg(const vehicle::VehicleState& own) noexcept
{
    const Seconds dt = std::clamp(own.stamp - judged_, 0.0F, 0.1F);
    judged_ = own.stamp;
    const float speed = own.velocity.norm();
    if (!has_leg_ || speed < kMoving) {
        disagreeing_ = agreeing_ = 0.0F;
        return;
    }
    const Seen seen = seen_of(leg_, own.position);
    const bool turns_soon = seen.left < kCornerTime * std::max(speed, kMoving);
    const bool astray = contradicts(own.velocity, seen) && !turns_soon;
    disagreeing_ = astray ? disagreeing_ + dt : 0.0F;
    agreeing_ = !contradicts(own.velocity, seen) && agrees(own.velocity, seen, kAlong) ? agreeing_ + dt : 0.0F;
    if (believed_ && disagreeing_ >= kContradicted) {
        believed_ = false;
        ++doubted_;
    } else if (!believed_ && agreeing_ >= kAgreed) {
        believed_ = true;
    }
    const bool along = cosine(own.velocity, seen.forward) >= kAlong;
    steady_leg_ = along && believed_ && steady_now_ > 0.0F ? steady_now_ : steady_leg_;
}

void NominalPaths::intend(const vehicle::VehicleState& own, const vehicle::VehicleLimits& limits,
                          bool in_control) noexcept
{
    if (!has_leg_) {
        return;
    }
    intended_ = world::Reference(leg_);
    const float meant = leg_.speed > 0.0F ? leg_.speed : steady_leg_ > 0.0F ? steady_leg_ : limits.cruise_speed;
    const Seen seen = seen_of(leg_, own.position);
    const float speed = own.velocity.norm();
    const bool along = !in_control && speed > kMoving && cosine(own.velocity, seen.forward) >= kAlong;
    const float flown = along && steady_now_ > 0.0F ? steady_now_ : meant;
    intended_.speed = along ? std::max(flown, speed) : meant;
}

/// A turn from where the vehicle is: an arc, or legs where it climbs or descends; then straight on.
bool NominalPaths::add_turn(const vehicle::VehicleState& own) noexcept
{
    const Vec3 level(own.velocity.x(), own.velocity.y(), 0.0F);
    const float speed = level.norm();
    const float radius = speed / std::abs(turn_rate_);
    if (turn_rate_ == 0.0F || radius < path::Route::kMinRadius || radius > path::Route::kLargestRadius) {
        return false;
    }
    const float sense = std::copysign(1.0F, turn_rate_);
    const Vec3 left = Vec3(-level.y(), level.x(), 0.0F) / speed;
    const Vec3 centre = own.position + sense * radius * left;
    path::Route& route = live_.route;
    const float climb = own.velocity.z();
    if (std::abs(climb) <= kLevel) {
        if (route.add_arc(own.position, centre, Vec3::UnitZ(), sense * kPi) != path::RouteStatus::ok) {
            return false;
        }
    } else {
        Vec3 at = own.position;
        const float rise = climb * (kPi / static_cast<float>(kTurnLegs.size())) / std::abs(turn_rate_);
        for (const SineCosine& turned : kTurnLegs) {
            const Vec3 on_circle = centre + radius * (turned.sine * level / speed - turned.cosine * sense * left);
            const Vec3 next(on_circle.x(), on_circle.y(), at.z() + rise);
            if (route.add_leg(at, next) != path::RouteStatus::ok) {
                return false;
            }
            at = next;
        }
    }
    const path::RoutePoint end = route.at(route.length());
    const Vec3 on(-own.velocity.x(), -own.velocity.y(), climb);
    return route.add_leg(end.position, end.position + kAhead * on) == path::RouteStatus::ok;
}

void NominalPaths::extrapolate(const vehicle::VehicleState& own, const vehicle::VehicleLimits& limits) noexcept
{
    const float speed = own.velocity.norm();
    const bool moves = speed >= kStanding;
    live_.route.clear();
    if (moves && add_turn(own)) {
        live_.reference = world::Reference(live_.route, speed);
        return;
    }
    live_.route.clear();
    const Vec3 end = moves ? Vec3(own.position + own.velocity * kAhead) : own.position;
    live_.reference = world::Reference({own.position, end, moves ? speed : limits.cruise_speed});
}

/// What drifts in gusts is going nowhere: its place is kept, not a path that it would be brought back to.
void NominalPaths::keep(const vehicle::VehicleLimits& limits) noexcept
{
    kept_.copy_from(live_);
    if (kept_.reference.speed < std::min(kMoving, kDriftShare * limits.cruise_speed)) {
        const Vec3 place = kept_.reference.route().at(0.0F).position;
        kept_.route.clear();
        kept_.reference = world::Reference({place, place, limits.cruise_speed});
    }
}

/// A turn may come near to itself: what was flown of it is not flown again.
void NominalPaths::progress(const vehicle::VehicleState& own) noexcept
{
    world::Reference& r = kept_.reference;
    r.segment = r.route().abeam_of(own.position, r.segment).segment;
}

const world::Reference* NominalPaths::other() const noexcept
{
    if (!on_motion_) {
        return &live_.reference;  // in control what we fly: it is not handed over heading for something
    }
    return in_control_ && believes_leg() ? &intended_ : nullptr;
}

void NominalPaths::update(const vehicle::VehicleState& measured, const vehicle::VehicleState& own,
                          const world::Leg* leg, const vehicle::VehicleLimits& limits, bool in_control) noexcept
{
    if (in_control && !in_control_) {
        keep(limits);
        on_motion_ = was_on_motion_ || !believes_leg();
    }
    in_control_ = in_control;
    sample(measured);
    take_leg(leg);
    if (in_control) {
        disagreeing_ = agreeing_ = 0.0F;
        judged_ = own.stamp;
    } else {
        judge_leg(own);
        was_on_motion_ = was_on_motion_ && believes_leg();
    }
    intend(own, limits, in_control);
    extrapolate(own, limits);
    if (outdated_) {
        keep(limits);
        outdated_ = false;
    }
    if (in_control) {
        progress(own);
    }
    on_motion_ = in_control ? on_motion_ || !has_leg_ : !believes_leg();
}

void NominalPaths::note(bool has_conflict, bool on_other, bool other_conflict) noexcept
{
    if (!in_control_) {
        was_on_motion_ = has_conflict ? on_other : was_on_motion_;
    } else if (other_conflict && on_motion_ && believes_leg()) {
        on_motion_ = false;  // the motion's own conflict is over: now the leg's is to be solved
    }
}

}  // namespace jink::app
