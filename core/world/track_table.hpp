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
    bool manned = false;       ///< likewise
    float half_height = 0.0F;  ///< uncertainty of the height of `position` beside sigma_position [m], >= 0
};

enum class TrackStatus : std::uint8_t {
    updated,
    created,
    replaced,      ///< table full, or kMaxSameId tracks of this id: the least urgent one gave way
    not_finite,    ///< NaN or infinity
    out_of_range,  ///< farther, larger or less certain than `max_range`, faster or less certain in that than
                   ///< `max_speed`, sigmas below 0.1 mm, acceleration not in 0..1000 m/s2
    stale,         ///< too old to be kept, or not newer than the track that it fits: stamped no later, or repeated
    future,        ///< stamped later than now
    full,          ///< table full, or kMaxSameId tracks of this id, and the sighting is the least urgent
};

/// Counters since start; each sighting adds to exactly one of the first eight.
struct TrackDiagnostics {
    std::uint32_t updated = 0, created = 0, replaced = 0, not_finite = 0, out_of_range = 0, stale = 0, future = 0,
                  full = 0;
    std::uint32_t expired = 0;  ///< dropped by age
    std::uint32_t jumps = 0;    ///< sightings so far from the prediction that the track was started anew from them
    std::uint32_t doubled = 0;  ///< tracks started beside another of the same id, which could not have got there
    std::uint32_t floods = 0;   ///< seconds with more new tracks than `flood`
};

struct TrackTableSettings {
    Seconds max_age = 3.0F;             ///< a track not seen for longer is dropped [s]
    Seconds cooperative_age = 10.0F;    ///< where that is longer: a cooperative one [s]
    float max_range = 20000.0F;         ///< from the vehicle [m]
    float max_speed = 400.0F;           ///< [m/s]
    float process_acceleration = 0.5F;  ///< white acceleration noise of the filter, root of its density [m/s^1.5]
    float first_sigma_velocity = 5.0F;  ///< of a track first seen without velocity [m/s]
    float jump_gate = 6.0F;             ///< innovation in standard deviations beyond which a track starts anew
    Seconds future_slack = 0.05F;       ///< stamps may lie this far ahead of now [s]
    float reach_acceleration = 10.0F;   ///< aircraft accelerate no faster, beside their max_acceleration [m/s2]
    std::uint16_t flood = 16;           ///< new tracks in a second beyond which more are a flood
};

/// How urgent a track is [s]; the smaller, the more urgent. The time to the closest approach to `own`, both flying
/// straight on, plus a second for each 3 m of miss distance, plus the track's age. A track of an own sensor counts
/// half; a track that was sighted fewer than three times counts 1.5 times, and twice during a flood. O(1).
[[nodiscard]] float urgency(const Track& track, unsigned sightings, bool flood, const vehicle::VehicleState& own,
                            TimePoint now) noexcept;

/// Tracks under a constant-velocity Kalman filter, one variance for the three axes.
///
/// Two aircraft may share an id. A sighting belongs to a track of its id that could have reached its place: the
/// prediction, `jump_gate` standard deviations of both, and `reach_acceleration` over the time between. A sighting that
/// no track of its id could have reached starts another one beside them. Of several tracks the sighting goes to the one
/// that it fits best in place and velocity. A track that really jumped leaves a ghost, which ages out as any other.
/// Sightings of an uncertain height and those of a known one have tracks of their own. Two aircraft of one id that are
/// first seen nearer to each other than that reach share a track until they part.
///
/// Receivers repeat what they heard last. A sighting with exactly the place and velocity of the one before, of an
/// aircraft that moves, is such a repetition: it is refused, so that the track's age stays that of what was heard. The
/// last sightings of the kMaxTracks tracks that aged out last are known still, so that a repetition starts none of them
/// anew.
///
/// A cooperative track's reported velocities show how hard it accelerates (Track::shown_acceleration): their change
/// over half a second or more, less 4.5 standard deviations of one, which noise exceeds in 0.6 % of cases at most; no
/// more than `reach_acceleration`. What was shown once counts for as long as the track is kept.
///
/// A manned track's reported velocities show how it turns (Track::turn_rate): the change of course over 1.5 s or more,
/// less one standard deviation of it, and the mean of that and what was shown before.
///
/// Memory: kMaxTracks * (2 * sizeof(Track) + 40) bytes. Nothing is dropped without a count.
class TrackTable {
public:
    explicit TrackTable(const TrackTableSettings& settings = {}) noexcept : settings_(settings) {}

    /// Takes one sighting. O(kMaxTracks).
    TrackStatus update(const TrackMeasurement& measurement, const vehicle::VehicleState& own, TimePoint now) noexcept;

    /// Drops tracks that are too old. O(kMaxTracks).
    void expire(TimePoint now) noexcept;

    /// Tracks extrapolated to `now`, in order of id and instance (so that order of arrival changes nothing); their
    /// sigmas stay those at their stamp. O(kMaxTracks^2). The view is valid until the next call of any member.
    [[nodiscard]] std::span<const Track> snapshot(TimePoint now) noexcept;

    /// Id of track `index` of the last snapshot.
    [[nodiscard]] TrackId id_in_snapshot(std::size_t index) const noexcept { return snapshot_[index].id; }

    /// Whether any track accelerates_harder. O(kMaxTracks).
    [[nodiscard]] bool any_accelerates_harder(const vehicle::VehicleLimits& own,
                                              const FlightRules& rules) const noexcept;

    /// The frame's origin turned out to lie elsewhere, or was moved: every track goes by as much [m]. O(kMaxTracks).
    void move(const Vec3& by) noexcept;
    void clear() noexcept
    {
        entries_.clear();
        expired_.clear();
        next_expired_ = 0;
    }
    void configure(const TrackTableSettings& settings) noexcept { settings_ = settings; }
    [[nodiscard]] std::size_t size() const noexcept { return entries_.size(); }
    [[nodiscard]] const TrackDiagnostics& diagnostics() const noexcept { return diagnostics_; }

private:
    /// What the last sighting of a track said.
    struct Said {
        TrackId id = 0;
        std::uint32_t fingerprint = 0;  ///< of place and velocity
        TimePoint stamp;
    };
    static constexpr std::uint16_t kUnchanged = 0xFFFF;  ///< of Entry::changing: no velocity was reported yet
    struct Entry {
        Track track;  ///< at its stamp
        float variance_position = 0.0F;
        float covariance = 0.0F;
        float variance_velocity = 0.0F;
        std::uint16_t sightings = 1;          ///< saturates
        std::uint16_t changing = kUnchanged;  ///< since `velocity_then` was reported, saturates [ms]
        std::uint32_t said = 0;               ///< fingerprint of the last sighting's place and velocity
        Vec3 velocity_then = Vec3::Zero();    ///< at the beginning of the change that is measured
    };
    /// The tracks of one id, and which of them a sighting fits.
    struct Match {
        std::size_t best = kNone;          ///< that could have reached it; kNone: no track could
        std::size_t least_urgent = kNone;  ///< of those of the id
        std::size_t count = 0;
        std::uint8_t free_instance = 0;
        bool repeated = false;  ///< the last sighting of one of them again, and the aircraft moves
    };
    static constexpr std::size_t kNone = kMaxTracks;

    [[nodiscard]] Seconds most_age(bool cooperative) const noexcept;
    [[nodiscard]] TrackStatus admit(const TrackMeasurement& m, const vehicle::VehicleState& own,
                                    TimePoint now) const noexcept;
    [[nodiscard]] static bool repeats(const Said& said, const TrackMeasurement& m) noexcept;
    [[nodiscard]] Entry start(const TrackMeasurement& m) const noexcept;
    void filter(Entry& entry, const TrackMeasurement& m) noexcept;
    void note_velocity(Entry& entry, const TrackMeasurement& m) const noexcept;
    [[nodiscard]] bool fit(const Entry& entry, const TrackMeasurement& m, float& cost) const noexcept;
    [[nodiscard]] Match match(const TrackMeasurement& m, const vehicle::VehicleState& own,
                              TimePoint now) const noexcept;
    [[nodiscard]] float urgency_of(const Entry& e, const vehicle::VehicleState& own, TimePoint now) const noexcept;
    [[nodiscard]] std::size_t least_urgent(const vehicle::VehicleState& own, TimePoint now) const noexcept;
    [[nodiscard]] TrackStatus add(const TrackMeasurement& m, const Match& match, const vehicle::VehicleState& own,
                                  TimePoint now) noexcept;
    void note_new(TimePoint now) noexcept;

    TrackTableSettings settings_;
    TrackDiagnostics diagnostics_;
    TimePoint second_began_;
    std::uint16_t new_in_second_ = 0;
    StaticVector<Entry, kMaxTracks> entries_;
    StaticVector<Said, kMaxTracks> expired_;  ///< full: a ring
    std::size_t next_expired_ = 0;
    StaticVector<Track, kMaxTracks> snapshot_;
};

}  // namespace jink::world
