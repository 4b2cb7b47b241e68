// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/plane_item_pilot.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "toolchain/sim/arduplane.hpp"

namespace jink::sim {
namespace {

constexpr double kPi2 = 2.0 * std::numbers::pi;
/// Circles are left within this angle of the course to the next place [rad].
constexpr double kLinedUp = 10.0 / 180.0 * std::numbers::pi;
/// The plane approaches a circle along the leg while the centre is farther than this many radii.
constexpr double kFarAway = 3.0;
/// Climbs from below this height above home are flown at once [m].
constexpr double kLow = 20.0;

double angle_of(const Vec& v) { return std::atan2(v.y(), v.x()); }

/// Past the line through `to` perpendicular to the leg from `from`.
bool is_past(const Vec& here, const Vec& from, const Vec& to)
{
    const Eigen::Vector2d span = (to - from).head<2>();
    return (here - to).head<2>().dot(span) >= 0.0;
}

}  // namespace

PlaneItemPilot::PlaneItemPilot(const Scenario& scenario) : ItemPilot(scenario), course_(scenario.start_velocity) {}

void PlaneItemPilot::begin_item(const Vec& from, bool direct)
{
    begin_from(from);
    direct_ = direct;
    reached_ = false;
    turned_ = waited_ = 0.0;
    lined_up_ = -1.0;
}

void PlaneItemPilot::resume(const Truth& own)
{
    fly_at(scenario().vehicle.cruise);
    course_ = own.velocity;
    begin_item(own.position, true);
}

void PlaneItemPilot::replace(const std::vector<Item>& items, const Truth& own)
{
    const Vec before = item().place;
    take(items);
    begin_item(is_past(own.position, before, item().place) ? own.position : before, false);
}

void PlaneItemPilot::leave()
{
    if (item().kind == ItemKind::land && index() > 0) {
        go_back_to(index() - 1);
    }
}

const Item* PlaneItemPilot::next_item() const
{
    for (std::size_t i = index() + 1; i < items().size(); ++i) {
        const ItemKind kind = items()[i].kind;
        if (kind == ItemKind::jump) {
            return &items()[static_cast<std::size_t>(items()[i].value)];
        }
        if (kind != ItemKind::speed) {
            return &items()[i];
        }
    }
    return nullptr;
}

double PlaneItemPilot::radius() const { return item().kind == ItemKind::turns ? item().value : kPlaneLoiterRadius; }

bool PlaneItemPilot::is_waypoint_done(const Truth& own) const
{
    const Vec& place = item().place;
    const Item* const next = next_item();
    double angle = 0.5 * std::numbers::pi;
    if (next != nullptr) {
        angle = std::abs(std::remainder(angle_of(next->place - place) - angle_of(place - from()), kPi2));
    }
    const double left = (place - own.position).head<2>().norm();
    return left <= turn_distance(own.velocity.head<2>().norm(), angle) || is_past(own.position, from(), place);
}

bool PlaneItemPilot::is_headed_for_next(const Truth& own) const
{
    const Item* const next = next_item();
    if (next == nullptr || (next->place - item().place).head<2>().norm() < 0.99 * radius()) {
        return true;
    }
    const double error = std::remainder(angle_of(next->place - own.position) - angle_of(own.velocity), kPi2);
    return std::abs(error) <= kLinedUp * (1.0 + std::floor((turned_ - lined_up_) / kPi2));
}

bool PlaneItemPilot::is_circle_done(const Truth& own) const { return lined_up_ >= 0.0 && is_headed_for_next(own); }

void PlaneItemPilot::advance(const Truth& own)
{
    bool done = false;
    switch (item().kind) {
    case ItemKind::waypoint: done = is_waypoint_done(own); break;
    case ItemKind::turns:
    case ItemKind::wait: done = is_circle_done(own); break;
    case ItemKind::take_off: done = own.position.z() > item().place.z(); break;
    default: break;
    }
    if (!done || is_last()) {
        return;
    }
    const bool climbed = item().kind == ItemKind::take_off;
    const Vec before = item().place;
    go_on(before);
    // "Resetting previous waypoint": the next waypoint is already behind at the start of its leg.
    const bool from_here = climbed || is_past(own.position, before, item().place);
    begin_item(from_here ? own.position : before, climbed);
}

Vec PlaneItemPilot::along_leg(const Truth& own) const
{
    const Vec& place = item().place;
    Vec course = line_course(own, direct_ ? own.position : from(), place);
    const bool low = own.position.z() - scenario().home.z() < kLow;
    course.z() = climb_to(height_on_the_way(from(), place, own.position, low), own, scenario().vehicle);
    return course;
}

Vec PlaneItemPilot::on_circle(const Truth& own)
{
    const Vec& place = item().place;
    const double distance = (own.position - place).head<2>().norm();
    if (!reached_ && !direct_ && distance > kFarAway * radius()) {
        return along_leg(own);
    }
    const PlaneCircle circle = circle_course(own, place, radius());
    const double angle = angle_of(own.position - place);
    if (reached_) {
        turned_ += std::remainder(angle_ - angle, kPi2);
        waited_ += to_seconds(kStep);
    }
    reached_ = reached_ || circle.reached;
    angle_ = angle;
    const bool met = item().kind == ItemKind::turns ? turned_ > kPi2 * item().count : waited_ > item().value;
    if (reached_ && met && lined_up_ < 0.0 && item().kind != ItemKind::circle) {
        lined_up_ = turned_;
    }
    Vec course = circle.course;
    const double height = reached_ ? place.z() : height_on_the_way(from(), place, own.position, false);
    course.z() = climb_to(height, own, scenario().vehicle);
    return course;
}

Vec PlaneItemPilot::command(const Truth& own)
{
    advance(own);
    switch (item().kind) {
    case ItemKind::turns:
    case ItemKind::wait:
    case ItemKind::circle: return on_circle(own);
    case ItemKind::take_off: return {course_.x(), course_.y(), scenario().vehicle.max_climb};
    default: return along_leg(own);
    }
}

}  // namespace jink::sim
