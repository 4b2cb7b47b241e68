// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/item_pilot.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace jink::sim {
namespace {

/// Look-ahead distance along a leg [m].
constexpr double kCarrot = 6.0;
/// Approach of a place where the vehicle stops [1/s].
constexpr double kApproach = 0.8;
/// LAND and RETURN_TO_LAUNCH: rate of descent [m/s], and distance to the place at which the descent begins [m].
constexpr double kDescent = 1.5;
constexpr double kAbove = 1.0;
/// Circles: gain towards the circle [1/m], and tolerance of being on the circle [m].
constexpr double kPull = 0.3;
constexpr double kOnCircle = 3.0;
/// A take-off is done within this distance below its height [m].
constexpr double kClimbed = 0.8;

}  // namespace

ItemPilot::ItemPilot(const Scenario& scenario)
    : scenario_(scenario), items_(scenario.flight->items), from_(scenario.start_position),
      speed_(scenario.vehicle.cruise), jumps_(items_.size(), 0)
{
    tangent_ = scenario.start_velocity;
    skip_commands();
}

void ItemPilot::resume(const Truth& own)
{
    from_ = own.position;
    tangent_ = own.velocity;
    share_ = 0.0;
}

void ItemPilot::take(const std::vector<Item>& items)
{
    items_ = items;
    jumps_.assign(items_.size(), 0);
    index_ = std::min(index_, items_.size() - 1);
}

void ItemPilot::replace(const std::vector<Item>& items, const Truth& own)
{
    take(items);
    resume(own);
}

/// Commands between flown items take no time.
void ItemPilot::skip_commands()
{
    for (std::size_t i = 0; i < 4 * items_.size(); ++i) {
        const Item& item = items_[index_];
        const bool more = index_ + 1 < items_.size();
        if (item.kind == ItemKind::speed && more) {
            speed_ = item.value;
            ++index_;
        } else if (item.kind == ItemKind::jump && jumps_[index_] < item.count) {
            ++jumps_[index_];
            index_ = static_cast<std::size_t>(item.value);
        } else if (item.kind == ItemKind::jump && more) {
            ++index_;
        } else {
            return;
        }
    }
}

void ItemPilot::go_on(const Vec& from)
{
    tangent_ = from - from_;
    from_ = from;
    share_ = turned_ = waited_ = 0.0;
    ++index_;
    skip_commands();
}

bool ItemPilot::is_done(const Truth& own) const
{
    const Item& item = items_[index_];
    switch (item.kind) {
    case ItemKind::waypoint: return (own.position - item.place).norm() < scenario_.reached;
    case ItemKind::spline: return share_ >= 1.0;
    case ItemKind::turns: return turned_ >= 2.0 * std::numbers::pi * item.count;
    case ItemKind::wait: return waited_ >= item.value;
    case ItemKind::take_off: return own.position.z() > item.place.z() - kClimbed;
    default: return false;
    }
}

const Item* ItemPilot::next_place() const
{
    for (std::size_t i = index_ + 1; i < items_.size(); ++i) {
        if (items_[i].kind == ItemKind::waypoint || items_[i].kind == ItemKind::spline) {
            return &items_[i];
        }
    }
    return nullptr;
}

/// Along the line from the item's start.
Vec ItemPilot::towards(const Vec& goal, const Truth& own, bool stops) const
{
    const Vec span = goal - from_;
    const double length = span.norm();
    const Vec left = goal - own.position;
    const double speed = stops ? std::min(speed_, kApproach * left.norm()) : speed_;
    if (length < 0.1) {
        return along(left, speed, scenario_.vehicle);
    }
    const double s = std::clamp((own.position - from_).dot(span) / length + kCarrot, 0.0, length);
    return along(from_ + span * (s / length) - own.position, speed, scenario_.vehicle);
}

/// A cubic that starts in the present direction and ends in the direction to the next place.
Vec ItemPilot::on_curve(const Item& item, const Truth& own)
{
    const double length = (item.place - from_).norm();
    const Item* const next = next_place();
    const Vec out = next == nullptr ? Vec(item.place - from_) : Vec(next->place - from_);
    const Vec m0 = tangent_.norm() > 0.1 ? Vec(tangent_.normalized() * length) : Vec(item.place - from_);
    const Vec m1 = out.norm() > 0.1 ? Vec(out.normalized() * length) : m0;
    const double u = share_;
    const Vec slope = (6.0 * u * u - 6.0 * u) * from_ + (3.0 * u * u - 4.0 * u + 1.0) * m0 +
                      (6.0 * u - 6.0 * u * u) * item.place + (3.0 * u * u - 2.0 * u) * m1;
    const Vec place = (2.0 * u * u * u - 3.0 * u * u + 1.0) * from_ + (u * u * u - 2.0 * u * u + u) * m0 +
                      (3.0 * u * u - 2.0 * u * u * u) * item.place + (u * u * u - u * u) * m1;
    const double rate = slope.norm();
    const Vec behind = place - own.position;
    // The point on the curve waits for a vehicle far off the curve.
    if (behind.norm() < 2.0 * kCarrot) {
        share_ += speed_ * to_seconds(kStep) / std::max(rate, 1.0);
    }
    return along(slope / std::max(rate, 1e-6) * speed_ + kApproach * behind, speed_, scenario_.vehicle);
}

Vec ItemPilot::on_circle(const Item& item, const Truth& own)
{
    Vec out = own.position - item.place;
    const double climb = -out.z();
    out.z() = 0.0;
    const double distance = out.norm();
    const Vec radial = distance > 0.1 ? Vec(out / distance) : Vec(1.0, 0.0, 0.0);
    const Vec clockwise(radial.y(), -radial.x(), 0.0);
    const double off = distance - item.value;
    if (std::abs(off) < kOnCircle) {
        turned_ += std::abs(own.velocity.dot(clockwise)) * to_seconds(kStep) / std::max(distance, 1.0);
    }
    // On the circle the command points inwards to compensate the lag of the velocity loop.
    const double lead = 2.0 * scenario_.vehicle.damping / scenario_.vehicle.omega * speed_ / item.value;
    Vec course = clockwise - radial * (std::clamp(kPull * off, -3.0, 3.0) + lead);
    course = course.normalized() * speed_;
    course.z() = kApproach * climb;
    return along(course, speed_, scenario_.vehicle);
}

Vec ItemPilot::down_at(const Vec& place, const Truth& own) const
{
    const Vec level(place.x() - own.position.x(), place.y() - own.position.y(), 0.0);
    if (level.norm() > kAbove) {
        return along(level, std::min(speed_, kApproach * level.norm()), scenario_.vehicle);
    }
    const bool down = own.position.z() < scenario_.home.z() + 0.2;
    return Vec(kApproach * level.x(), kApproach * level.y(), down ? 0.0 : -kDescent);
}

Vec ItemPilot::command(const Truth& own)
{
    if (index_ + 1 < items_.size() && is_done(own)) {
        const Item& item = items_[index_];
        const bool placed = item.kind == ItemKind::waypoint || item.kind == ItemKind::spline;
        go_on(placed ? item.place : own.position);
    }
    const Item& item = items_[index_];
    switch (item.kind) {
    case ItemKind::spline: return on_curve(item, own);
    case ItemKind::turns: return on_circle(item, own);
    case ItemKind::wait:
        waited_ += (own.position - item.place).norm() < scenario_.reached ? to_seconds(kStep) : 0.0;
        return towards(item.place, own, true);
    case ItemKind::take_off: {
        const Vec up(from_.x() - own.position.x(), from_.y() - own.position.y(), item.place.z() - own.position.z());
        return along(up, std::min(speed_, kApproach * up.norm() + 0.5), scenario_.vehicle);
    }
    case ItemKind::land: return down_at(item.place, own);
    case ItemKind::home: return down_at(scenario_.home, own);
    default: return towards(item.place, own, index_ + 1 == items_.size());
    }
}

}  // namespace jink::sim
