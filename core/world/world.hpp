// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>

#include "core/base/time.hpp"
#include "core/geometry/shape.hpp"
#include "core/path/route.hpp"
#include "core/path/timed_path.hpp"
#include "core/vehicle/vehicle.hpp"
#include "core/world/cost_to_go.hpp"
#include "core/world/cylinder.hpp"
#include "core/world/flight_rules.hpp"
#include "core/world/threat.hpp"

// What is known at one instant. Plain values; tables that fill them are in track_table.hpp and obstacle_table.hpp.

namespace jink::world {

using TrackId = std::uint32_t;
using ObstacleId = std::uint32_t;

/// How a track is known.
enum class TrackSource : std::uint8_t {
    adsb,        ///< by a transponder (ADS-B, UAT, FLARM) heard here, or by the autopilot's receiver
    own_sensor,  ///< seen from here; never cooperative
    datalink,    ///< by its own word on the link that we share with it
    utm,         ///< by its own word to whoever manages the traffic
};

/// A moving threat: a sphere with a straight motion and its uncertainty. Where `half_height` is above 0 the height of
/// its centre is uncertain by that much either way: the threat is an upright capsule.
struct Track {
    TrackId id = 0;  ///< as reported; two aircraft under one id differ in `instance`
    /// The greatest that the reports of a cooperative one have shown, level or vertically; 0: none yet [m/s2].
    float shown_acceleration = 0.0F;
    TimePoint stamp{};              ///< of the newest measurement in it
    Vec3 position = Vec3::Zero();   ///< [m]; in a Situation: at Situation::now
    Vec3 velocity = Vec3::Zero();   ///< [m/s]
    float radius = 0.0F;            ///< of the body [m]
    float sigma_position = 0.0F;    ///< at `stamp`, one standard deviation per axis [m]
    float sigma_velocity = 0.0F;    ///< [m/s]
    float max_acceleration = 0.0F;  ///< bound on what it may do unannounced [m/s2]
    TrackSource source = TrackSource::adsb;
    bool cooperative = false;   ///< it takes its share in avoiding us, as we take ours; else all of it is ours
    std::uint8_t instance = 0;  ///< id and instance together are unique in a table
    bool manned = false;        ///< people aboard, as far as is reported: FlightRules::well_clear
    float half_height = 0.0F;   ///< uncertainty of the height, all of it, beside the sphere's growth [m]
    float turn_rate = 0.0F;     ///< of a manned one, as its reports show it, positive from x to y [rad/s]
};

struct Obstacle {
    ObstacleId id = 0;
    geometry::Shape shape;
    float uncertainty = 0.0F;  ///< the obstacle may stand out of `shape` by this much [m], >= 0
};

/// Bounds of the airspace, met like any obstacle by the own box, own position uncertainty included. Heights above the
/// world origin [m].
struct Airspace {
    bool has_floor = false;
    bool has_ceiling = false;
    bool has_keep_in = false;
    float floor = 0.0F;
    float ceiling = 0.0F;
    Vec3 home = Vec3::Zero();
    float keep_in_radius = 0.0F;  ///< horizontal, about home [m]
    /// Closed volumes and weather, kMaxCylinders at most, where they are at Situation::now. Their owner outlives this.
    std::span<const Cylinder> cylinders{};
};

/// A straight leg to fly, as it is reported.
struct Leg {
    Vec3 start = Vec3::Zero();
    Vec3 end = Vec3::Zero();
    float speed = 5.0F;  ///< [m/s], > 0
};

/// Where the vehicle means to go: along a route. A leg is a route of one segment, which the reference holds itself; at
/// the end of its route the vehicle hovers, or goes on straight where it cannot.
class Reference {
public:
    Reference() noexcept = default;  ///< none: not valid
    explicit Reference(const Leg& leg) noexcept
        : valid(true), speed(leg.speed), leg_(path::straight_segment(leg.start, leg.end))
    {
    }
    /// `route` outlives the Situation; it is not empty when a Situation is made of this.
    Reference(const path::Route& route, float along, std::size_t from = 0) noexcept
        : valid(true), speed(along), segment(from), route_(&route)
    {
    }
    Reference(const path::Route&&, float, std::size_t = 0) = delete;

    /// Valid as long as this and what it was made of.
    [[nodiscard]] path::RouteView route() const& noexcept
    {
        return route_ != nullptr ? path::RouteView(*route_) : path::RouteView({&leg_, 1});
    }
    path::RouteView route() const&& = delete;
    /// The same on a copy of its route, which is put into `copy`; a leg needs none.
    [[nodiscard]] Reference moved_to(path::Route& copy) const noexcept
    {
        Reference moved = *this;
        if (route_ != nullptr) {
            copy = *route_;
            moved.route_ = &copy;
        }
        return moved;
    }

    bool valid = false;
    float speed = 5.0F;       ///< along the route [m/s], > 0
    std::size_t segment = 0;  ///< of the route: the one being flown, or one before it
    bool measured = false;    ///< motion that was measured: nobody means to come back to this very route

private:
    path::RouteSegment leg_;
    const path::Route* route_ = nullptr;  ///< null: leg_ is the route
};

enum class ManoeuvreKind : std::uint8_t { follow_path, velocity, brake, hold_turn };

/// What to fly. For `brake` and `velocity` the path is the predicted flight under the constant command `command`.
struct Manoeuvre {
    ManoeuvreKind kind = ManoeuvreKind::brake;
    std::uint8_t by = 0;  ///< MethodTraits::id of the method that found it, set by the supervisor; 0: none
    TimePoint start;      ///< path time 0
    TimePoint valid_until;
    Vec3 command = Vec3::Zero();  ///< `velocity`: [m/s]
    /// Unit vector from the leg towards the farthest point of the path; zero for none. Of a `velocity` set by the
    /// supervisor.
    Vec3 side = Vec3::Zero();
    float cost = 0.0F;  ///< [0, 1], as the method counts it among its own
    path::TimedPath path;
};

/// A velocity that the vehicle was commanded to fly.
struct Commanded {
    Vec3 velocity = Vec3::Zero();  ///< [m/s]
    TimePoint at;
};

/// A view of everything a method may know; made once per tick, immutable.
struct Situation {
    TimePoint now;
    const vehicle::VehicleState& own;
    const vehicle::VehicleLimits& limits;
    const vehicle::Airframe& airframe;
    const Reference& reference;
    const FlightRules& rules;
    /// All that must be kept clear of, a ThreatSet's or some of them. Without data (null): never collected; then
    /// everything counts as contact.
    std::span<const Threat> threats{};
    const Manoeuvre* flying = nullptr;  ///< what is being flown or was last chosen, for hysteresis
    /// By which the others of the same link know us (TrackSource::datalink); 0: not known. Says nothing beside the id
    /// of a track of another source: that is of another scheme, and they may know us by another too.
    TrackId own_id = 0;
    const Commanded* commanded = nullptr;  ///< the last command, while the vehicle is steered from here
    /// Cooperative tracks are checked so far ahead in separations, and not beyond [s]: what they do then
    /// depends on both. Conflicts are not bounded by it.
    Seconds shared_horizon = std::numeric_limits<Seconds>::infinity();
    const CostToGo* cost_to_go = nullptr;  ///< of the way past obstacles; null: not known. It does not change meanwhile
};

/// A situation is copied with something else in one of its places by this function alone. It does not compile when a
/// field is added that it does not know.
[[nodiscard]] inline Situation copy_with(const Situation& s, const vehicle::VehicleLimits& limits,
                                         const Reference& reference) noexcept
{
    const auto& [now, own, other_limits, airframe, other_reference, rules, threats, flying, own_id, commanded,
                 shared_horizon, cost_to_go] = s;
    return {now,     own,    limits, airframe,  reference,      rules,
            threats, flying, own_id, commanded, shared_horizon, cost_to_go};
}
[[nodiscard]] inline Situation with_limits(const Situation& s, const vehicle::VehicleLimits& limits) noexcept
{
    return copy_with(s, limits, s.reference);
}
[[nodiscard]] inline Situation with_reference(const Situation& s, const Reference& reference) noexcept
{
    return copy_with(s, s.limits, reference);
}

enum class PlanStatus : std::uint8_t {
    found,           ///< `out` holds a checked manoeuvre
    no_conflict,     ///< nothing to avoid
    too_close,       ///< nearer to the main threat than the method can plan for
    none_available,  ///< every candidate touches something or cannot be flown
    budget_spent,    ///< the work budget ran out before an answer that may be trusted
    bad_input,       ///< no reference, or settings out of range
    running,         ///< it goes on in the next update
};

/// Whether a method can plan in it: a reference, flight rules within their ranges, threats collected. O(1).
[[nodiscard]] inline bool is_complete(const Situation& situation) noexcept
{
    return situation.reference.valid && !situation.reference.route().empty() && is_valid(situation.rules) &&
           situation.threats.data() != nullptr;
}

/// How much earlier everything is met because the own position is not known better: k_sigma standard deviations [m].
[[nodiscard]] inline float own_uncertainty(const Situation& situation) noexcept
{
    return situation.rules.k_sigma * situation.own.sigma_position;
}

/// Level acceleration that cooperative vehicles are counted on not to exceed: the own limit, since they fly by the same
/// rules, or that of the rules, where it is more [m/s2].
[[nodiscard]] inline float fellow_acceleration(const vehicle::VehicleLimits& own, const FlightRules& rules) noexcept
{
    return std::max(own.max_acceleration, rules.fellow_acceleration);
}
/// Whether a cooperative vehicle accelerates harder than that and than the own vertical limit, by a quarter.
[[nodiscard]] inline bool accelerates_harder(const Track& track, const vehicle::VehicleLimits& own,
                                             const FlightRules& rules) noexcept
{
    return track.shown_acceleration > 1.25F * std::max(fellow_acceleration(own, rules), own.max_vertical_acceleration);
}
/// Level acceleration that a cooperative vehicle may have flown unheard: fellow_acceleration, or as hard as it has
/// shown [m/s2].
[[nodiscard]] inline float unheard_acceleration(const Track& track, const vehicle::VehicleLimits& own,
                                                const FlightRules& rules) noexcept
{
    return accelerates_harder(track, own, rules) ? track.shown_acceleration : fellow_acceleration(own, rules);
}

/// What a vehicle that avoids us too may have done since its report and did not announce: it changes its velocity no
/// faster than by unheard_acceleration. Zero for tracks that are not cooperative.
struct Doubt {
    float position = 0.0F;  ///< its place may be off by so much [m]
    float velocity = 0.0F;  ///< and its velocity [m/s]
    Seconds ends = 0.0F;    ///< until the own vehicle can stand: what the other one does then depends on both
};
/// Age of a report up to which nothing is doubted: both vehicles react to what it hides. What is older counts from here
/// on [s].
inline constexpr Seconds kFreshReport = 0.3F;
/// O(1).
[[nodiscard]] Doubt doubt_of(const Situation& situation, const Track& track) noexcept;

/// Radius of a track's sphere at `t` seconds after Situation::now: body, k_sigma standard deviations of the distance
/// between the two, and half its acceleration bound times its age squared. The errors of the own position and of the
/// track's position come from different sensors, so their variances add. The velocity's standard deviation times the
/// age adds linearly, because its error and the position's are correlated. For a sensor of the vehicle's own, the own
/// error cancels: conservative. For cooperative tracks the doubt is added, its velocity over `t`, until it ends. The
/// only place where threats grow. O(1).
[[nodiscard]] float threat_radius(const Situation& situation, const Track& track, Seconds t) noexcept;

/// The point of a track's upright axis that is nearest in height to `height`, its centre being at `centre`. O(1).
[[nodiscard]] inline Vec3 nearest_in_height(const Track& track, const Vec3& centre, float height) noexcept
{
    return {centre.x(), centre.y(), std::clamp(height, centre.z() - track.half_height, centre.z() + track.half_height)};
}

/// `threat_radius` from Situation::now on, without the doubt of the velocity (Threat::doubt); never below it where the
/// track's stamp lies ahead of now. O(1).
[[nodiscard]] Growth growth_of(const Situation& situation, const Track& track) noexcept;

}  // namespace jink::world
