// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/world/obstacle_table.hpp"
#include "firmware/link/cloud.hpp"

namespace jink::app {

/// How the vehicle lies in the world, and what is known of its surroundings.
struct CloudView {
    bool is_placed = false;            ///< the rest holds
    TimePoint stamp;                   ///< of position and velocity
    Vec3 position = Vec3::Zero();      ///< [m]
    Vec3 velocity = Vec3::Zero();      ///< [m/s]
    float yaw = 0.0F;                  ///< [rad]
    Seconds own_age = 0.5F;            ///< place no scan by an own state older than this
    Seconds keep = 1.0F;               ///< obstacles expire so long after the scan's stamp
    Vec3 half_extents = Vec3::Zero();  ///< of the own box [m]
    bool has_floor = false;
    float floor = 0.0F;         ///< [m]
    float deceleration = 5.0F;  ///< when braking [m/s2]
};

/// What a co-processor knows of its point clouds. Behind an interface, so that an image without any carries none of it.
class Clouds {
public:
    /// Where the obstacles go; outlives the last scan.
    virtual void give_to(world::ObstacleTable& table) noexcept = 0;
    /// For the single points of the autopilot's link.
    [[nodiscard]] virtual link::CloudSink& link_points() noexcept = 0;
    /// One more taker of the same rays, one scan at a time; it outlives the last scan.
    virtual void forward_to(link::CloudSink& sink) noexcept = 0;
    /// Once per step: takes what has come.
    /// @param view  for scans that begin from now on
    virtual void serve(TimePoint now, const CloudView& view) noexcept = 0;

protected:
    ~Clouds() = default;
};

}  // namespace jink::app
