// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "core/base/static_vector.hpp"
#include "core/world/conflict.hpp"

// Aircraft with people aboard, and the volumes that are kept clear of them (ASTM F3442).

namespace jink::world {

/// An upright cylinder about an aircraft. Distances are counted in multiples of it: 1 on its surface, less inside.
struct Volume {
    float radius = 1.0F;  ///< > 0 [m]
    float height = 1.0F;  ///< above and below, > 0 [m]
};
/// A near mid-air collision: 500 ft level and 100 ft in height.
inline constexpr Volume kNearMidAir{152.4F, 30.48F};

/// Of two in straight motion: the greater one of level distance by radius and difference in height by height.
struct Nearness {
    float least = 0.0F;   ///< in multiples of a volume
    Seconds when = 0.0F;  ///< the first instant of it
};
/// Least within [0, span]. @param gap  from the vehicle to the aircraft [m]  @param closing  its change [m/s]
/// In closed form: at an end, at either one's own least, or where both are equal. O(1).
[[nodiscard]] Nearness nearest(const Vec3& gap, const Vec3& closing, const Volume& volume, Seconds span) noexcept;
/// First instant within [0, span] inside the volume, to a thousandth of it; below 0 where there is none. O(1).
[[nodiscard]] Seconds first_inside(const Vec3& gap, const Vec3& closing, const Volume& volume, Seconds span) noexcept;

/// Levels of an alert: the volume that is entered, now or by what is predicted.
enum class Alert : std::uint8_t {
    none,
    low,       ///< the well clear volume will be
    medium,    ///< that of a near mid-air collision will be
    high,      ///< the well clear volume is
    critical,  ///< that of a near mid-air collision is
};

/// What an aircraft may do: fly straight on; turn at once by so much to either side, or stay where it is (circling),
/// which counts for a shorter time.
struct AircraftCourse {
    float cosine = 1.0F;
    float sine = 0.0F;
    bool straight = false;

    [[nodiscard]] Vec3 of(const Vec3& v) const noexcept
    {
        return {cosine * v.x() - sine * v.y(), sine * v.x() + cosine * v.y(), v.z()};
    }
};
/// Straight on first; 45 degrees to either side; none.
inline constexpr float kHalfRight = 0.70710678F;
inline constexpr std::array kAircraftCourses{AircraftCourse{1.0F, 0.0F, true}, AircraftCourse{kHalfRight, kHalfRight},
                                             AircraftCourse{kHalfRight, -kHalfRight}, AircraftCourse{0.0F, 0.0F}};
/// Courses that are not straight on count for so long: at 3 deg/s an aircraft turns by 45 degrees in 15 s [s].
inline constexpr Seconds kTurnAhead = 25.0F;

/// A piece of the way of an aircraft that turns: straight on for kTurnPiece.
struct TurnPiece {
    Vec3 position = Vec3::Zero();  ///< where it begins [m]
    Vec3 velocity = Vec3::Zero();  ///< [m/s]
};
inline constexpr Seconds kTurnPiece = 10.0F;
using TurnPieces = StaticVector<TurnPiece, 4>;
/// The way of an aircraft that goes on turning as its reports show (Track::turn_rate), as chords of its circle: their
/// ends are on it. Empty where it turns by less than 0.86 deg/s. O(1).
[[nodiscard]] TurnPieces turning_on(const Threat& aircraft) noexcept;

/// Aircraft are looked for this far ahead: to climb or descend by 76 m takes 25 s at 3 m/s [s].
inline constexpr Seconds kAircraftAhead = 60.0F;

/// Whether a threat is a track that FlightRules::well_clear is kept of.
[[nodiscard]] bool is_aircraft(const Situation& situation, const Threat& threat) noexcept;
/// The volumes, larger by what is not known of both positions. O(1).
[[nodiscard]] Volume well_clear_of(const Situation& situation, const Threat& aircraft) noexcept;
[[nodiscard]] Volume near_mid_air_of(const Threat& aircraft) noexcept;

/// Whether aircraft come too near to the way, and how near; `out` is the first loss of all. Too near is: straight on,
/// within kAircraftAhead into the well clear volume, and nearer than at present; turning on, into it at any time; on
/// another course, within kTurnAhead into the volume of a near mid-air collision. A vehicle that gives way goes on with
/// it as long as any course leads into a well clear volume a tenth larger. Where the budget runs out an aircraft is too
/// near now. O(pieces * tracks).
[[nodiscard]] Alert aircraft_conflict(const Situation& situation, const Way& way, bool gives_way, WorkBudget& budget,
                                      Conflict& out) noexcept;

}  // namespace jink::world
