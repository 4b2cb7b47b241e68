// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "core/base/static_vector.hpp"
#include "core/capacity.hpp"
#include "core/world/world.hpp"

namespace jink::world {

/// One sighting of a moving threat, world frame, on the co-processor's clock.
struct TrackMeasurement {
    TrackId id = 0;
    TimePoint stamp;
    Vec3 position = Vec3::Zero();  ///< [m]
    Vec3 velocity = Vec3::Zero();  ///< [m/s]
    bool has_velocity = false;
    float radius = 0.0F;            ///< of the body [m], >= 0
    float sigma_position = 0.0F;    ///< [m], > 0
    float sigma_velocity = 0.0F;    ///< [m/s], > 0 where has_velocity
    float max_acceleration = 0.0F;  ///< [m/s2], >= 0
    TrackSource source = TrackSource::adsb;
    bool cooperative = false;  ///< as in Track; the newest sighting's word counts
};

enum class TrackStatus : std::uint8_t {
    updated,
    created,
    replaced,      ///< table full: the track with the farthest closest approach gave way
    not_finite,    ///< NaN or infinity
    out_of_range,  ///< farther, larger or less certain than `max_range`, faster or less certain in that than
                   ///< `max_speed`, sigmas below 0.1 mm, acceleration not in 0..1000 m/s2
    stale,         ///< older than `max_age`, or not newer than what is known
    future,        ///< stamped later than now
    full,          ///< table full and this one is the least dangerous
};

/// Counters since start; each sighting adds to exactly one but `expired` and `jumps`.
struct TrackDiagnostics {
    std::uint32_t updated = 0, created = 0, replaced = 0, not_finite = 0, out_of_range = 0, stale = 0, future = 0,
                  full = 0;
    std::uint32_t expired = 0;  ///< dropped by age
    std::uint32_t jumps = 0;    ///< sightings so far from the prediction that the track was started anew from them
};

struct TrackTableSettings {
    Seconds max_age = 3.0F;             ///< a track not seen for longer is dropped [s]
    float max_range = 20000.0F;         ///< from the vehicle [m]
    float max_speed = 400.0F;           ///< [m/s]
    float process_acceleration = 0.5F;  ///< white acceleration noise of the filter, root of its density [m/s^1.5]
    float first_sigma_velocity = 5.0F;  ///< of a track first seen without velocity [m/s]
    float jump_gate = 6.0F;             ///< innovation in standard deviations beyond which a track starts anew
    Seconds future_slack = 0.05F;       ///< stamps may lie this far ahead of now [s]
};

/// Tracks under a constant-velocity Kalman filter, one variance for the three axes.
///
/// Memory: kMaxTracks * (sizeof(Track) + 16) bytes. Nothing is dropped without a count.
class TrackTable {
public:
    explicit TrackTable(const TrackTableSettings& settings = {}) noexcept : settings_(settings) {}

    /// Takes one sighting. O(kMaxTracks).
    TrackStatus update(const TrackMeasurement& measurement, const vehicle::VehicleState& own, TimePoint now) noexcept;

    /// Drops tracks older than `max_age`. O(kMaxTracks).
    void expire(TimePoint now) noexcept;

    /// Tracks extrapolated to `now`, in order of id (so that order of arrival changes nothing); their sigmas stay those
    /// at their stamp. O(kMaxTracks^2). The view is valid until the next call of any member.
    [[nodiscard]] std::span<const Track> snapshot(TimePoint now) noexcept;

    /// Id of track `index` of the last snapshot.
    [[nodiscard]] TrackId id_in_snapshot(std::size_t index) const noexcept { return snapshot_[index].id; }

    /// The frame's origin turned out to lie elsewhere, or was moved: every track goes by as much [m]. O(kMaxTracks).
    void move(const Vec3& by) noexcept;
    void clear() noexcept { entries_.clear(); }
    void configure(const TrackTableSettings& settings) noexcept { settings_ = settings; }
    [[nodiscard]] std::size_t size() const noexcept { return entries_.size(); }
    [[nodiscard]] const TrackDiagnostics& diagnostics() const noexcept { return diagnostics_; }

private:
    struct Entry {
        Track track;  ///< at its stamp
        float variance_position = 0.0F;
        float covariance = 0.0F;
        float variance_velocity = 0.0F;
    };

    [[nodiscard]] TrackStatus admit(const TrackMeasurement& m, const vehicle::VehicleState& own,
                                    TimePoint now) const noexcept;
    [[nodiscard]] Entry start(const TrackMeasurement& m) const noexcept;
    void filter(Entry& entry, const TrackMeasurement& m) noexcept;

    TrackTableSettings settings_;
    TrackDiagnostics diagnostics_;
    StaticVector<Entry, kMaxTracks> entries_;
    StaticVector<Track, kMaxTracks> snapshot_;
};

}  // namespace jink::world
