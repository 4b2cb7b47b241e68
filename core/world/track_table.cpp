// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/track_table.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace jink::world {
namespace {

/// Sigmas below this are no measurement's, and their squares would vanish beside others [m, m/s].
constexpr float kMinSigma = 1e-4F;
/// No aircraft's: larger ones would swell a sphere over everything, or float's range [m/s2].
constexpr float kLargestAcceleration = 1000.0F;

/// Miss distance that counts as a second of time to the closest approach: either side's way in a second of an unhurried
/// manoeuvre [m/s].
constexpr float kMissSpeed = 3.0F;
/// Sightings from which a track is confirmed.
constexpr unsigned kConfirmed = 3;
/// A track that just began, and one that began during a flood, count as so much less urgent.
constexpr float kNewcomer = 1.5F;
constexpr float kNewcomerInFlood = 2.0F;
constexpr float kOwnSensor = 0.5F;
constexpr Seconds kFloodWindow = 1.0F;
/// A change of velocity is measured over this long, and counts beyond so many standard deviations.
constexpr Seconds kShownOver = 0.5F;
constexpr float kShownBeyond = 4.5F;
/// A change of course is measured over this long.
constexpr Seconds kTurnOver = 1.5F;
/// An aircraft that moved by more is not at the same place to 0.01 m, as links say it [m].
constexpr float kMoved = 0.05F;

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
           std::isfinite(m.sigma_position) && std::isfinite(m.sigma_velocity) && std::isfinite(m.max_acceleration) &&
           std::isfinite(m.half_height);
}

/// Of place and velocity. The rotation carries a change of any bit, a sign's too, into all that follow.
[[gnu::noinline]] std::uint32_t fingerprint(const TrackMeasurement& m) noexcept
{
    std::uint32_t hash = 0;
    for (const Vec3* const v : {&m.position, &m.velocity}) {
        for (const float x : *v) {
            hash = (std::rotl(hash, 13) ^ std::bit_cast<std::uint32_t>(x)) * 0x9E3779B1U;
        }
    }
    return hash;
}

/// Change of the level course from one velocity to another, less one standard deviation of it [rad].
[[gnu::cold, gnu::noinline]] float turned(const Vec3& from, const Vec3& to, float sigma) noexcept
{
    constexpr float kRootOfTwo = 1.4142136F;
    constexpr float kSlow = 1.0F;  // [m/s]
    const float angle = std::atan2(from.x() * to.y() - from.y() * to.x(), from.head<2>().dot(to.head<2>()));
    const float deviation = kRootOfTwo * sigma / std::max(to.head<2>().norm(), kSlow);
    return std::copysign(std::max(0.0F, std::abs(angle) - deviation), angle);
}

}  // namespace

float urgency(const Track& track, unsigned sightings, bool flood, const vehicle::VehicleState& own,
              TimePoint now) noexcept
{
    const Seconds age = now - track.stamp;
    const Vec3 centre = track.position + track.velocity * age;
    const Vec3 gap = nearest_in_height(track, centre, own.position.z()) - own.position;
    const Vec3 closing = track.velocity - own.velocity;
    const float speed2 = closing.squaredNorm();
    const float t = speed2 > 1e-9F ? std::max(0.0F, -gap.dot(closing) / speed2) : 0.0F;
    const float miss = std::max(0.0F, (gap + closing * t).norm() - track.radius);
    const float newcomer = sightings >= kConfirmed ? 1.0F : flood ? kNewcomerInFlood : kNewcomer;
    const float seen_here = track.source == TrackSource::own_sensor ? kOwnSensor : 1.0F;
    return (t + miss / kMissSpeed + std::max(0.0F, age)) * newcomer * seen_here;
}

Seconds TrackTable::most_age(bool cooperative) const noexcept
{
    return cooperative ? std::max(settings_.max_age, settings_.cooperative_age) : settings_.max_age;
}

TrackStatus TrackTable::admit(const TrackMeasurement& m, const vehicle::VehicleState& own, TimePoint now) const noexcept
{
    if (!all_finite(m)) {
        return TrackStatus::not_finite;
    }
    const auto within = [](float value, float low, float high) { return value >= low && value <= high; };
    const bool sizes_ok =
        within(m.radius, 0.0F, settings_.max_range) && within(m.sigma_position, kMinSigma, settings_.max_range) &&
        within(m.max_acceleration, 0.0F, kLargestAcceleration) && within(m.half_height, 0.0F, settings_.max_range) &&
        (!m.has_velocity || within(m.sigma_velocity, kMinSigma, settings_.max_speed));
    if (!sizes_ok || !((m.position - own.position).norm() <= settings_.max_range) ||
        !(m.velocity.norm() <= settings_.max_speed)) {
        return TrackStatus::out_of_range;
    }
    const Seconds age = now - m.stamp;
    if (age < -settings_.future_slack) {
        return TrackStatus::future;
    }
    return age > most_age(m.cooperative) ? TrackStatus::stale : TrackStatus::updated;
}

[[gnu::noinline]] TrackTable::Entry TrackTable::start(const TrackMeasurement& m) const noexcept
{
    Entry entry;
    entry.variance_position = m.sigma_position * m.sigma_position;
    const float sigma_velocity = m.has_velocity ? m.sigma_velocity : settings_.first_sigma_velocity;
    entry.variance_velocity = sigma_velocity * sigma_velocity;
    entry.track = {m.id,
                   0.0F,
                   m.stamp,
                   m.position,
                   m.has_velocity ? m.velocity : Vec3(Vec3::Zero()),
                   m.radius,
                   m.sigma_position,
                   sigma_velocity,
                   m.max_acceleration,
                   m.source,
                   m.cooperative,
                   0,
                   m.manned,
                   m.half_height,
                   0.0F};
    entry.velocity_then = entry.track.velocity;
    entry.changing = m.has_velocity ? 0 : kUnchanged;
    entry.said = fingerprint(m);
    return entry;
}

void TrackTable::move(const Vec3& by) noexcept
{
    for (Entry& entry : entries_) {
        entry.track.position += by;
    }
}

/// Small in flash rather than fast: once a report.
[[gnu::cold, gnu::noinline]] void TrackTable::note_velocity(Entry& e, const TrackMeasurement& m) const noexcept
{
    constexpr Seconds kMaxChanging = 60.0F;
    if (e.changing == kUnchanged) {
        e.velocity_then = m.velocity;
        e.changing = m.has_velocity ? 0 : kUnchanged;
        return;
    }
    const Seconds span = std::min(1e-3F * static_cast<float>(e.changing) + (m.stamp - e.track.stamp), kMaxChanging);
    e.changing = static_cast<std::uint16_t>(std::lround(1e3F * span));
    if ((!m.cooperative && !m.manned) || !m.has_velocity || span < (m.manned ? kTurnOver : kShownOver)) {
        return;
    }
    if (m.manned) {
        e.track.turn_rate = 0.5F * (e.track.turn_rate + turned(e.velocity_then, m.velocity, m.sigma_velocity) / span);
    }
    if (m.cooperative) {
        const Vec3 change = m.velocity - e.velocity_then;
        const float most = std::max(change.head<2>().norm(), std::abs(change.z()));
        const float shown = std::min((most - kShownBeyond * m.sigma_velocity) / span, settings_.reach_acceleration);
        e.track.shown_acceleration = std::max(e.track.shown_acceleration, shown);
    }
    e.velocity_then = m.velocity;
    e.changing = 0;
}

[[gnu::cold, gnu::noinline]] bool TrackTable::any_accelerates_harder(const vehicle::VehicleLimits& own,
                                                                     const FlightRules& rules) const noexcept
{
    return std::any_of(entries_.begin(), entries_.end(),
                       [&](const Entry& e) noexcept { return accelerates_harder(e.track, own, rules); });
}

void TrackTable::filter(Entry& e, const TrackMeasurement& m) noexcept
{
    note_velocity(e, m);
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
        Entry fresh = start(m);
        fresh.track.instance = e.track.instance;
        fresh.track.shown_acceleration = e.track.shown_acceleration;
        fresh.track.turn_rate = e.track.turn_rate;
        fresh.velocity_then = e.velocity_then;
        fresh.changing = e.changing;
        e = fresh;
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
    e.track = {m.id,
               e.track.shown_acceleration,
               m.stamp,
               position,
               velocity,
               m.radius,
               std::sqrt(vpp),
               std::sqrt(vvv),
               m.max_acceleration,
               m.source,
               m.cooperative,
               e.track.instance,
               m.manned,
               m.half_height,
               e.track.turn_rate};
    e.said = fingerprint(m);
    e.sightings = static_cast<std::uint16_t>(std::min<unsigned>(e.sightings + 1U, 0xFFFFU));
}

bool TrackTable::repeats(const Said& said, const TrackMeasurement& m) noexcept
{
    return m.has_velocity && said.id == m.id && m.velocity.norm() * std::abs(m.stamp - said.stamp) > kMoved &&
           said.fingerprint == fingerprint(m);
}

/// Whether the track could have reached the sighting; `cost` says how well it fits, the less the better.
bool TrackTable::fit(const Entry& e, const TrackMeasurement& m, float& cost) const noexcept
{
    // A late sighting is compared with where the track was then.
    const Seconds dt = m.stamp - e.track.stamp;
    const Seconds apart = std::abs(dt);
    const float q = settings_.process_acceleration * settings_.process_acceleration;
    const float spread = e.variance_position + apart * (2.0F * e.covariance + apart * e.variance_velocity) +
                         q * apart * apart * apart / 3.0F + m.sigma_position * m.sigma_position;
    Vec3 gap = m.position - (e.track.position + e.track.velocity * dt);
    const float by_height = std::min(std::abs(gap.z()), e.track.half_height + m.half_height);
    gap.z() -= std::copysign(by_height, gap.z());
    const float acceleration = settings_.reach_acceleration + std::max(e.track.max_acceleration, m.max_acceleration);
    const float turned = 0.5F * acceleration * apart * apart;
    cost = gap.squaredNorm() / spread;
    if (m.has_velocity) {
        const float spread_velocity = e.variance_velocity + q * apart + m.sigma_velocity * m.sigma_velocity;
        cost += (m.velocity - e.track.velocity).squaredNorm() / spread_velocity;
    }
    return gap.norm() <= settings_.jump_gate * std::sqrt(spread) + turned;
}

float TrackTable::urgency_of(const Entry& e, const vehicle::VehicleState& own, TimePoint now) const noexcept
{
    return urgency(e.track, e.sightings, new_in_second_ > settings_.flood, own, now);
}

std::size_t TrackTable::least_urgent(const vehicle::VehicleState& own, TimePoint now) const noexcept
{
    std::size_t worst = 0;
    float most = -1.0F;
    for (std::size_t i = 0; i < entries_.size(); ++i) {
        const float its = urgency_of(entries_[i], own, now);
        worst = its > most ? i : worst;
        most = std::max(most, its);
    }
    return worst;
}

TrackTable::Match TrackTable::match(const TrackMeasurement& m, const vehicle::VehicleState& own,
                                    TimePoint now) const noexcept
{
    Match out;
    out.repeated = std::any_of(expired_.begin(), expired_.end(), [&](const Said& said) { return repeats(said, m); });
    float least_cost = std::numeric_limits<float>::infinity();
    float most = -1.0F;
    unsigned taken = 0;
    for (std::size_t i = 0; i < entries_.size(); ++i) {
        const Entry& e = entries_[i];
        if (e.track.id != m.id) {
            continue;
        }
        out.repeated = out.repeated || repeats({e.track.id, e.said, e.track.stamp}, m);
        taken |= 1U << e.track.instance;
        ++out.count;
        const float its = urgency_of(e, own, now);
        out.least_urgent = its > most ? i : out.least_urgent;
        most = std::max(most, its);
        const bool same_kind = (e.track.half_height > 0.0F) == (m.half_height > 0.0F);
        float cost = 0.0F;
        if (same_kind && fit(e, m, cost) && cost < least_cost) {
            least_cost = cost;
            out.best = i;
        }
    }
    out.free_instance = static_cast<std::uint8_t>(std::countr_one(taken));
    return out;
}

void TrackTable::note_new(TimePoint now) noexcept
{
    if (now - second_began_ >= kFloodWindow || now < second_began_) {
        second_began_ = now;
        new_in_second_ = 0;
    }
    ++new_in_second_;
    diagnostics_.floods += new_in_second_ == settings_.flood + 1 ? 1U : 0U;
}

/// A track for a sighting that fits none.
TrackStatus TrackTable::add(const TrackMeasurement& m, const Match& match, const vehicle::VehicleState& own,
                            TimePoint now) noexcept
{
    note_new(now);
    Entry fresh = start(m);
    fresh.track.instance = match.free_instance;
    const bool id_full = match.count >= kMaxSameId;
    diagnostics_.doubled += match.count > 0 ? 1U : 0U;
    if (!id_full && entries_.try_push_back(fresh)) {
        return TrackStatus::created;
    }
    Entry& victim = entries_[id_full ? match.least_urgent : least_urgent(own, now)];
    if (!(urgency_of(fresh, own, now) < urgency_of(victim, own, now))) {
        return TrackStatus::full;
    }
    fresh.track.instance = id_full ? victim.track.instance : match.free_instance;
    victim = fresh;
    return TrackStatus::replaced;
}

TrackStatus TrackTable::update(const TrackMeasurement& m, const vehicle::VehicleState& own, TimePoint now) noexcept
{
    TrackStatus status = admit(m, own, now);
    if (status == TrackStatus::updated) {
        const Match found = match(m, own, now);
        // NOLINTNEXTLINE(bugprone-branch-clone): in this order, a repetition starts no track
        if (found.repeated) {
            status = TrackStatus::stale;
        } else if (found.best == kNone) {
            status = add(m, found, own, now);
        } else if (m.stamp <= entries_[found.best].track.stamp) {
            status = TrackStatus::stale;
        } else {
            filter(entries_[found.best], m);
        }
    }
    ++counter(diagnostics_, status);
    return status;
}

void TrackTable::expire(TimePoint now) noexcept
{
    for (std::size_t i = 0; i < entries_.size();) {
        const Entry& e = entries_[i];
        if (now - e.track.stamp > most_age(e.track.cooperative)) {
            const Said said{e.track.id, e.said, e.track.stamp};
            if (!expired_.try_push_back(said)) {
                expired_[next_expired_] = said;
                next_expired_ = (next_expired_ + 1) % kMaxTracks;
            }
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
        const auto comes_after = [&](const Track& other) {
            return other.id != track.id ? other.id > track.id : other.instance > track.instance;
        };
        for (; at > 0 && comes_after(snapshot_[at - 1]); --at) {
            snapshot_[at] = snapshot_[at - 1];
        }
        snapshot_[at] = track;
    }
    return {snapshot_.data(), snapshot_.size()};
}

}  // namespace jink::world
