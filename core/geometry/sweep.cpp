// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/sweep.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/geometry/past_box.hpp"

namespace jink::geometry {

namespace {

using detail::Instants;
using detail::PastBox;

/// Added to the radius of a contact test, as a share of the relative coordinates and sizes: eight roundings (2^-24
/// each) cover the chain relative position, relative velocity, instant, position at the instant, distance.
constexpr float kSlackShare = 8.0F * 0x1p-24F;

/// Part of [0, horizon] in which the point lies in the box grown by `reach` on every side; empty when first > last.
/// Outside the interval there is no contact. Inside, no coordinate exceeds the box by more than `reach`, so that no
/// squares of far coordinates cancel.
TimeInterval grown_box_interval(const PastBox& past, float reach, Seconds horizon) noexcept
{
    TimeInterval inside{0.0F, horizon};
    for (int i = 0; i < 3; ++i) {
        const float edge = past.half()[i] + reach;
        const float speed = past.velocity()[i];
        const float x = past.position()[i];
        if (speed > 0.0F) {
            inside.first = std::max(inside.first, (-edge - x) / speed);
            inside.last = std::min(inside.last, (edge - x) / speed);
        } else if (std::abs(x) > edge && speed == 0.0F) {
            return {1.0F, 0.0F};
        }
    }
    return inside;
}

/// Time from the instant `at`, outside by `gap` (squares), until the gap of the piece that holds `within` is zero.
Seconds time_to_contact(const PastBox& past, Seconds at, Seconds within, float gap) noexcept
{
    if (!(gap > 0.0F)) {
        return 0.0F;
    }
    const float slope = past.slope(at);
    const float bend = past.curvature(within);
    return gap / (std::abs(slope) + std::sqrt(std::max(slope * slope - bend * gap, 0.0F)));
}

/// First and last instant at which the distance is at most `reach`, on both sides of the closest one.
TimeInterval around(const PastBox& past, const Instants& t, Seconds closest, float reach) noexcept
{
    const float limit = reach * reach;
    const Instants distance = past.distances_squared(t);
    TimeInterval contact{0.0F, t[7]};
    if (distance[6] > limit) {
        const float before = (distance > limit && t < closest).select(t, 0.0F).maxCoeff();
        const float next = (t > before).select(t, closest).minCoeff();
        const float middle = before + 0.5F * (std::min(next, closest) - before);
        contact.first = before + time_to_contact(past, before, middle, past.distance_squared(before) - limit);
        contact.first = std::min(contact.first, closest);
    }
    if (distance[7] > limit) {
        const float after = (distance > limit && t > closest).select(t, t[7]).minCoeff();
        const float previous = (t < after).select(t, closest).maxCoeff();
        const float middle = after + 0.5F * (std::max(previous, closest) - after);
        contact.last = after - time_to_contact(past, after, middle, past.distance_squared(after) - limit);
        contact.last = std::max(contact.last, closest);
    }
    return contact;
}

}  // namespace

std::optional<TimeInterval> contact_interval(const Vec3& half, const Motion& own, const Motion& threat, float radius,
                                             Seconds horizon) noexcept
{
    assert(!(half.minCoeff() < 0.0F) && !(radius < 0.0F) && horizon >= 0.0F);
    const PastBox whole(half, threat.position - own.position, threat.velocity - own.velocity);
    const float reach = radius + kSlackShare * (whole.position().cwiseAbs().sum() + half.sum() + radius);
    const TimeInterval window = grown_box_interval(whole, reach, horizon);
    if (!(window.first <= window.last)) {
        return std::nullopt;
    }
    const PastBox past = whole.from(window.first);
    const Instants t = past.instants(window.last - window.first);
    const Seconds closest = past.closest(t);
    if (past.distance_squared(closest) > reach * reach) {
        return std::nullopt;
    }
    const TimeInterval contact = around(past, t, closest, reach);
    const Seconds first = std::min(window.first + contact.first, window.last);
    return TimeInterval{first, std::clamp(window.first + contact.last, first, window.last)};
}

std::optional<TimeInterval> contact_interval(const Motion& own, const Motion& threat, float radius,
                                             Seconds horizon) noexcept
{
    assert(!(radius < 0.0F) && horizon >= 0.0F);
    const Vec3 position = threat.position - own.position;
    const Vec3 velocity = threat.velocity - own.velocity;
    const float reach = radius + kSlackShare * (position.cwiseAbs().sum() + radius);
    const float speed_squared = velocity.squaredNorm();
    if (speed_squared < detail::kAtRest * detail::kAtRest) {
        return position.squaredNorm() > reach * reach ? std::nullopt : std::optional<TimeInterval>({0.0F, horizon});
    }
    const Seconds closest = -position.dot(velocity) / speed_squared;
    const float depth = reach * reach - (position + closest * velocity).squaredNorm();
    if (depth < 0.0F) {
        return std::nullopt;
    }
    const Seconds half_time = std::sqrt(depth / speed_squared);
    const TimeInterval contact{std::max(closest - half_time, 0.0F), std::min(closest + half_time, horizon)};
    return contact.first <= contact.last ? std::optional<TimeInterval>(contact) : std::nullopt;
}

Approach least_distance(const Vec3& half, const Motion& own, const Motion& threat, Seconds horizon) noexcept
{
    assert(half.minCoeff() >= 0.0F && horizon >= 0.0F);
    const PastBox past(half, threat.position - own.position, threat.velocity - own.velocity);
    const Seconds when = past.closest(past.instants(horizon));
    return {past.excess(when).norm(), when};
}

float point_segment_distance(const Vec3& p, const Vec3& a, const Vec3& b) noexcept
{
    const Vec3 along = b - a;
    const Vec3 offset = p - a;
    const float length_squared = along.squaredNorm();
    const float share = length_squared > 0.0F ? std::clamp(offset.dot(along) / length_squared, 0.0F, 1.0F) : 0.0F;
    return (offset - share * along).norm();
}

}  // namespace jink::geometry
