// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "core/base/static_vector.hpp"
#include "core/base/time.hpp"
#include "core/base/vec3.hpp"

namespace jink::orca {

/// A vehicle or a piece of an obstacle, as the monitor is told of it: by what was measured, never by what a solver made
/// of it.
struct MonitoredVehicle {
    std::uint16_t id = 0;
    Vec3 position = Vec3::Zero();  ///< [m]
};
struct MonitoredPiece {
    std::uint16_t id = 0;
    /// Nearest point of it [m], where vertical distances count stop_horizontal / stop_vertical times: the space that
    /// obstacle planes are made in. The piece is convex.
    Vec3 nearest = Vec3::Zero();
};

/// What to do when it trips; the monitor itself does nothing.
enum class TripAction : std::uint8_t { hover_brake, land, event_only };

/// Distances at which something has gone wrong: 0.8 of those that are to be kept (Alejo table 8.1).
struct MonitorSettings {
    float stop_horizontal = 0.8F * 1.2F;      ///< between vehicles [m], > 0
    float stop_vertical = 0.8F * 0.6F;        ///< [m], > 0
    float obstacle_horizontal = 0.8F * 1.1F;  ///< to obstacles [m], > 0
    float obstacle_vertical = 0.8F * 0.8F;    ///< [m], > 0
    std::uint8_t samples = 2;                 ///< violated in a row that trip it, >= 1
    TripAction action = TripAction::hover_brake;
};

/// Whom a record or a trip is about.
enum class Subject : std::uint8_t { nobody, vehicle, obstacle };

/// The tightest pair of a tick.
struct MonitorRecord {
    TimePoint stamp;
    Subject subject = Subject::nobody;
    std::uint16_t id = 0;
    float horizontal = std::numeric_limits<float>::infinity();        ///< [m]
    float vertical = std::numeric_limits<float>::infinity();          ///< [m]
    float nearest_obstacle = std::numeric_limits<float>::infinity();  ///< of the tick, straight distance [m]
};

/// What a tick looked like.
struct MonitorReport {
    bool tripped = false;   ///< latched
    bool just_now = false;  ///< by this tick
    TripAction action = TripAction::hover_brake;
    Subject subject = Subject::nobody;  ///< of the tightest pair
    std::uint16_t id = 0;
    /// Of the tightest pair, as shares of the stop distances: h and z both below 1 violate the cylinder, the ellipsoid
    /// norm sqrt(h^2 + z^2) below 1 the ellipsoid in it.
    float horizontal = std::numeric_limits<float>::infinity();
    float vertical = std::numeric_limits<float>::infinity();
    float ellipsoid = std::numeric_limits<float>::infinity();
};

/// Watches the separations that the avoidance is there to keep, and trips when one is lost in both the horizontal and
/// the vertical (Alejo 8.4 item 5, G-ORCA 15). It shares nothing with any solver: own copies of positions, own sums.
///
/// Vehicles are points to each other, so h < 1 and z < 1 is exact. Of an obstacle only the nearest point is known, and
/// another of its points may be in the cylinder when that one is not: it counts as violated when the plane through the
/// nearest point, behind which all of a convex piece lies, reaches into the cylinder (h^2 + z^2 < h + z). That is never
/// too late; on a level or upright face it is the same.
///
/// `samples` in a row are counted for each vehicle and piece by itself, and one that is missing from a tick keeps its
/// count: it was not seen to be clear. A trip stays until it is acknowledged; acknowledged amid a violation it trips
/// again after as many samples.
///
/// The log holds the tightest pair of each of the last kRecords ticks. After a trip it goes on for half of that and
/// then stops until the acknowledgement: what led to it and what came of it are both kept.
///
/// Memory: about 8.5 KiB, nearly all of it the log. No allocation.
class Monitor {
public:
    static constexpr std::size_t kRecords = 256;
    /// Vehicles and pieces that are violated at once. One more trips at once: its samples could not be counted.
    static constexpr std::size_t kMostViolated = 64;

    explicit Monitor(const MonitorSettings& settings = {}) noexcept : settings_(settings) {}

    /// Once per tick. What is not finite is passed over and counted; an own position that is not finite makes the tick
    /// one that saw nothing.
    /// O((vehicles + pieces) * violated).
    MonitorReport update(TimePoint now, const Vec3& own, std::span<const MonitoredVehicle> vehicles,
                         std::span<const MonitoredPiece> pieces) noexcept;

    void acknowledge() noexcept;
    [[nodiscard]] bool tripped() const noexcept { return tripped_; }
    /// Whom the latched trip is about, and when it was.
    [[nodiscard]] const MonitorRecord& trip() const noexcept { return trip_; }

    [[nodiscard]] std::size_t records() const noexcept { return log_size_; }
    /// Record `i` < records(), the oldest first.
    [[nodiscard]] const MonitorRecord& record(std::size_t i) const noexcept
    {
        return log_[(log_first_ + i) % kRecords];
    }

    [[nodiscard]] std::uint32_t trips() const noexcept { return trips_; }
    /// Positions that were not finite.
    [[nodiscard]] std::uint32_t bad_inputs() const noexcept { return bad_inputs_; }

private:
    struct Count {
        Subject subject = Subject::nobody;
        std::uint16_t id = 0;
        std::uint8_t samples = 0;
    };
    struct Tick {
        MonitorReport report;
        MonitorRecord record;
        bool trips = false;
        MonitorRecord culprit;
    };
    void look_at(Tick& tick, Subject subject, std::uint16_t id, const Vec3& offset) noexcept;
    [[nodiscard]] bool count(Subject subject, std::uint16_t id, bool violated) noexcept;
    void remember(const MonitorRecord& record) noexcept;

    MonitorSettings settings_;
    StaticVector<Count, kMostViolated> counts_;
    bool tripped_ = false;
    MonitorRecord trip_;
    std::uint32_t trips_ = 0;
    std::uint32_t bad_inputs_ = 0;
    std::size_t since_trip_ = 0;  ///< records
    std::array<MonitorRecord, kRecords> log_{};
    std::size_t log_first_ = 0;
    std::size_t log_size_ = 0;
};

}  // namespace jink::orca
