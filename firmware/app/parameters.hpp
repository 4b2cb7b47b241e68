// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/avoid/settings.hpp"
#include "core/geometric/planner.hpp"
#include "core/orca/planner.hpp"
#include "core/reach/planner.hpp"
#include "core/world/track_table.hpp"
#include "firmware/app/method_orders.hpp"
#include "firmware/link/messages.hpp"

namespace jink::app {

/// What the co-processor does about a conflict.
enum class ActMode : std::uint8_t { off = 0, advise = 1, act = 2 };

/// Parameters in the order of their MAVLink index.
enum class Param : std::uint8_t {
    mode,
    lookahead,
    half_xy,
    half_z,
    k_sigma,
    bounds,
    floor,
    ceiling,
    keep_in,
    reserve,
    settle,
    rate,
    track_radius,
    point_radius,
    track_sigma_p,
    track_sigma_v,
    track_acceleration,
    track_latency,
    track_age,
    scan_height,
    scan_latency,
    scan_keep,
    own_age,
    heartbeat_age,
    cruise,
    climb,
    descent,
    acceleration,
    vertical_acceleration,
    lag,
    fixed_wing,
    mass,
    drag,
    area,
    offsets,
    planes,
    families,
    waypoints,
    swept,
    weight_smoothness,
    weight_time,
    weight_passing,
    weight_beyond,
    rotation_penalty,
    flip_penalty,
    nearest,
    max_cost,
    time_low,
    time_high,
    latency,
    standby,
    ask_rates,
    tell_near,
    methods,
    unseen,
    coop,
    own_address,
    patience,
    sticks,
    sigma_baro,
    sigma_compared,
    well_clear,
    well_clear_height,
    count
};
inline constexpr std::size_t kParamCount = static_cast<std::size_t>(Param::count);

/// GEO_OFFSETS and GEO_PLANES where nothing is set: 32 candidates in two families, fewer where the capacity is less.
inline constexpr bool kHas16Candidates = kMaxCandidates >= 16;
inline constexpr bool kHas32Candidates = kMaxCandidates >= 32;
inline constexpr std::size_t kInitialOffsets = kHas32Candidates ? 4 : 2;
inline constexpr std::size_t kInitialPlanes = kHas16Candidates ? 3 : 1;
static_assert(2 * kInitialOffsets * (kInitialPlanes + 1) <= kMaxCandidates);
using ParamValues = std::array<float, kParamCount>;

struct ParamInfo {
    std::string_view name;  ///< at most 16 characters, as on the wire and in files
    float initial;
    float low;
    float high;
    bool integer;
    std::string_view text;  ///< meaning and unit
};
/// The table; index = Param.
[[nodiscard]] const std::array<ParamInfo, kParamCount>& param_table() noexcept;

enum class ParamStatus : std::uint8_t {
    ok,
    unknown_name,
    not_finite,
    out_of_range,  ///< beyond its own limits, or not a whole number
    not_built,     ///< JNK_METHODS names a method that this image is built without
    inconsistent,  ///< alone in range, but not together with the others
};

/// Everything that parameters decide, as the modules of core want it.
struct Configuration {
    ActMode mode = ActMode::act;
    world::FlightRules rules;  ///< of the supervisor and all methods
    avoid::Settings supervisor;
    geometric::Settings planner;
    reach::Settings reach;
    orca::Settings orca;
    /// The reach sets do not suit the vehicle's limits, or the capacities: they are not asked, whatever the order.
    bool reach_unsuited = false;
    bool blocks_unseen = true;  ///< by reach sets, where a point cloud does not see
    vehicle::VehicleLimits limits;
    vehicle::Airframe airframe;
    world::TrackTableSettings tracks;
    bool floor_on = false, ceiling_on = false, keep_in_on = false;
    float floor = 0.0F, ceiling = 0.0F, keep_in = 0.0F;  ///< above and about home [m]
    float track_radius = 1.0F, point_radius = 1.0F;      ///< of traffic that does not say its size [m]
    float track_sigma_position = 0.5F, track_sigma_velocity = 0.3F, track_acceleration = 0.0F, track_latency = 0.1F;
    float sigma_baro = 30.0F;     ///< of the height of traffic that is a pressure altitude [m]
    float sigma_compared = 5.0F;  ///< of a difference of two pressure altitudes [m]
    float scan_height = 10.0F;    ///< half height given to what a level scan sees [m]
    bool coop_systems = true, coop_utm = true, coop_unmanned = true, coop_all = false;  ///< who is cooperative
    std::uint32_t own_address = 0;                                                      ///< 24 bits; 0: not known
    Seconds scan_latency = 0.1F, scan_keep = 1.0F;
    Seconds own_age = 0.5F, heartbeat_age = 4.5F;  ///< older is a fault [s]
    Seconds setpoint_period = 0.05F;
    bool stands_by = false;
    bool ask_rates = true;
    bool tell_near = false;
    float sticks = 0.3F;  ///< moved by so much they end a take-over [of half their travel]; 0: never
};

/// Whether reach sets are among the methods that these settings ask.
[[nodiscard]] inline bool asks_reach_sets(const avoid::Settings& settings) noexcept
{
    return kHasReach && needs_sets(settings.order);
}

/// Values with their checks. A refused change changes nothing.
class Parameters {
public:
    Parameters() noexcept;

    [[nodiscard]] float get(Param p) const noexcept { return values_[static_cast<std::size_t>(p)]; }
    ParamStatus set(Param p, float value) noexcept;
    ParamStatus set(std::string_view name, float value) noexcept;
    /// Several at once, checked together: weights, caps, limits that only fit as a set. A refused set changes nothing.
    ParamStatus set_all(const std::array<float, kParamCount>& values) noexcept;
    /// All of `values` where they fit together; else each for itself, in two passes because one may only fit after
    /// another. @return how many were refused
    std::size_t set_each(const ParamValues& values) noexcept;
    [[nodiscard]] const std::array<float, kParamCount>& values() const noexcept { return values_; }

    /// Index of a name (NUL or end of view ends it); kParamCount when unknown. O(kParamCount).
    [[nodiscard]] static std::size_t find(std::string_view name) noexcept;

    /// What the autopilot says about its limits bounds those of the parameters: the lower one holds, of lags the
    /// longer.
    void believe(const link::ReportedLimits& reported) noexcept;

    /// Takes other reach sets than this build's. They outlive the parameters.
    void use(const reach::VehicleSets& sets) noexcept;

    [[nodiscard]] const Configuration& configuration() const noexcept { return configuration_; }
    /// Counts accepted changes, so that users of the configuration know when to take it over.
    [[nodiscard]] std::uint32_t generation() const noexcept { return generation_; }

private:
    std::array<float, kParamCount> values_;
    const reach::VehicleSets* sets_ = nullptr;
    link::ReportedLimits reported_;
    Configuration configuration_;
    std::uint32_t generation_ = 0;
};

}  // namespace jink::app
