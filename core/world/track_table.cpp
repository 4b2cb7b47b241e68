// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/track_table.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace jink::world {
namespace {

/// Sigmas below this are no measurement's, and their squares would vanish beside others [m, m/s].
constexpr float kLeastSigma = 1e-4F;
/// No aircraft's: larger ones would swell a sphere over everything, or float's range [m/s2].
constexpr float kLargestAcceleration = 1000.0F;

/// Distance at the closest approach from `now` on, both flying straight on [m].
float closest_approach(const Track& track, const vehicle::VehicleState& own, TimePoint now) noexcept
{
    const Vec3 gap = track.position + track.velocity * (now - track.stamp) - own.position;
    const Vec3 closing = track.velocity - own.velocity;
    const float speed2 = closing.squaredNorm();
    const float t = speed2 > 1e-9F ? std::max(0.0F, -gap.dot(closing) / speed2) : 0.0F;
    return (gap + closing * t).norm() - track.radius;
}

std::uint32_t& counter(TrackDiagnostics& d, TrackStatus status) noexcept
{
    switch (status) {
    case TrackStatus::updated: return d.updated;
    case TrackStatus::created: return d.created;
    case TrackStatus::replaced: return d.replaced;
    case TrackStatus::not_finite: return d.not_finite;
    case TrackStatus::out_of_range: return d.out_of_range;
    case TrackStatus::stale: return d.stale;
    case TrackStatus::future: return d.future;
    case TrackStatus::full: break;
    }
    return d.full;
}

bool all_finite(const TrackMeasurement& m) noexcept
{
    return is_finite(m.position) && is_finite(m.velocity) && std::isfinite(m.radius) &&
           std::isfinite(m.sigma_position) && std::isfinite(m.sigma_velocity) && std::isfinite(m.max_acceleration);
}

}  // namespace

TrackStatus TrackTable::admit(const TrackMeasurement& m, const vehicle::VehicleState& own, TimePoint now) const noexcept
{
    if (!all_finite(m)) {
        return TrackStatus::not_finite;
    }
    const auto within = [](float value, float low, float high) { return value >= low && value <= high; };
    const bool sizes_ok = within(m.radius, 0.0F, settings_.max_range) &&
                          within(m.sigma_position, kLeastSigma, settings_.max_range) &&
                          within(m.max_acceleration, 0.0F, kLargestAcceleration) &&
                          (!m.has_velocity || within(m.sigma_velocity, kLeastSigma, settings_.max_speed));
    if (!sizes_ok || !((m.position - own.position).norm() <= settings_.max_range) ||
        !(m.velocity.norm() <= settings_.max_speed)) {
        return TrackStatus::out_of_range;
    }
    const Seconds age = now - m.stamp;
    if (age < -settings_.future_slack) {
        return TrackStatus::future;
    }
    return age > settings_.max_age ? TrackStatus::stale : TrackStatus::updated;
}

TrackTable::Entry TrackTable::start(const TrackMeasurement& m) const noexcept
{
    Entry entry;
    entry.variance_position = m.sigma_position * m.sigma_position;
    const float sigma_velocity = m.has_velocity ? m.sigma_velocity : settings_.first_sigma_velocity;
    entry.variance_velocity = sigma_velocity * sigma_velocity;
    entry.track = {m.id,     m.stamp,          m.position,     m.has_velocity ? m.velocity : Vec3(Vec3::Zero()),
                   m.radius, m.sigma_position, sigma_velocity, m.max_acceleration,
                   m.source, m.cooperative};
    return entry;
}

void TrackTable::move(const Vec3& by) noexcept
{
    for (Entry& entry : entries_) {
        entry.track.position += by;
    }
}

void TrackTable::filter(Entry& e, const TrackMeasurement& m) noexcept
{
    const Seconds dt = m.stamp - e.track.stamp;
    const float q = settings_.process_acceleration * settings_.process_acceleration;
    const Vec3 predicted = e.track.position + e.track.velocity * dt;
    const float ppp =
        e.variance_position + dt * (2.0F * e.covariance + dt * e.variance_velocity) + q * dt * dt * dt / 3.0F;
    const float ppv = e.covariance + dt * e.variance_velocity + 0.5F * q * dt * dt;
    const float pvv = e.variance_velocity + q * dt;

    const float r = m.sigma_position * m.sigma_position;
    const Vec3 innovation = m.position - predicted;
    const Vec3 turn = m.has_velocity ? Vec3(m.velocity - e.track.velocity) : Vec3(Vec3::Zero());
    const float gate2 = settings_.jump_gate * settings_.jump_gate;
    const float rv = m.sigma_velocity * m.sigma_velocity;
    if (innovation.squaredNorm() > gate2 * (ppp + r) || (m.has_velocity && turn.squaredNorm() > gate2 * (pvv + rv))) {
        // It did not do what the filter believes: the newest sighting is the truth.
        ++diagnostics_.jumps;
        e = start(m);
        return;
    }
    const float gain_p = ppp / (ppp + r);
    const float gain_v = ppv / (ppp + r);
    Vec3 position = predicted + innovation * gain_p;
    Vec3 velocity = e.track.velocity + innovation * gain_v;
    float vpp = ppp * (1.0F - gain_p);
    float vpv = ppv * (1.0F - gain_p);
    float vvv = std::max(0.0F, pvv - gain_v * ppv);
    if (m.has_velocity) {
        const float gain_pv = vpv / (vvv + rv);
        const float gain_vv = vvv / (vvv + rv);
        const Vec3 difference = m.velocity - velocity;
        position += difference * gain_pv;
        velocity += difference * gain_vv;
        vpp = std::max(0.0F, vpp - gain_pv * vpv);
        vpv *= 1.0F - gain_vv;
        vvv *= 1.0F - gain_vv;
    }
    e.variance_position = vpp;
    e.covariance = vpv;
    e.variance_velocity = vvv;
    e.track = {m.id,           m.stamp,        position,           velocity, m.radius,
               std::sqrt(vpp), std::sqrt(vvv), m.max_acceleration, m.source, m.cooperative};
}

TrackStatus TrackTable::update(const TrackMeasurement& m, const vehicle::VehicleState& own, TimePoint now) noexcept
{
    TrackStatus status = admit(m, own, now);
    if (status == TrackStatus::updated) {
        auto* const known =
            std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.track.id == m.id; });
        if (known != entries_.end()) {
            if (m.stamp <= known->track.stamp) {
                status = TrackStatus::stale;
            } else {
                filter(*known, m);
            }
        } else if (entries_.try_push_back(start(m))) {
            status = TrackStatus::created;
        } else {
            const Entry fresh = start(m);
            auto* const farthest =
                std::max_element(entries_.begin(), entries_.end(), [&](const Entry& a, const Entry& b) {
                    return closest_approach(a.track, own, now) < closest_approach(b.track, own, now);
                });
            status = TrackStatus::full;
            if (closest_approach(fresh.track, own, now) < closest_approach(farthest->track, own, now)) {
                *farthest = fresh;
                status = TrackStatus::replaced;
            }
        }
    }
    ++counter(diagnostics_, status);
    return status;
}

void TrackTable::expire(TimePoint now) noexcept
{
    for (std::size_t i = 0; i < entries_.size();) {
        if (now - entries_[i].track.stamp > settings_.max_age) {
            entries_.swap_erase(i);
            ++diagnostics_.expired;
        } else {
            ++i;
        }
    }
}

std::span<const Track> TrackTable::snapshot(TimePoint now) noexcept
{
    snapshot_.clear();
    for (const Entry& e : entries_) {
        Track track = e.track;
        track.position += track.velocity * (now - track.stamp);
        std::size_t at = snapshot_.size();
        snapshot_.unchecked_push_back(track);
        for (; at > 0 && snapshot_[at - 1].id > track.id; --at) {
            snapshot_[at] = snapshot_[at - 1];
        }
        snapshot_[at] = track;
    }
    return {snapshot_.data(), snapshot_.size()};
}

}  // namespace jink::world
