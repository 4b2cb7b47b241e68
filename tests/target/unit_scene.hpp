// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Geometry>

#include "core/base/random.hpp"
#include "core/world/threat_set.hpp"

// Random input of the unit probe.

namespace jink::target {

/// As toolchain/report/units names them.
enum class Work : std::uint32_t {
    contact_closed,
    contact_solid,
    distance_closed,
    distance_solid,
    margin_closed,
    margin_solid,
    separation_tracks,
    separation_spheres,
    separation_solids,
    separation_cylinders,
    conflict_tracks,
    conflict_spheres,
    conflict_solids,
    conflict_cylinders,
    check,
    command,
    fallback,
    orca_tracks,
    orca_spheres,
    orca_solids,
    orca_program,
    curve_exact,
    curve_table,
    energy_exact,
    energy_table,
    objective_leg,
    objective_route,
    objective_solids,
    aircraft_look,
    aircraft_command,
    common_stop,
    table_check,
    reach_tracks,
    reach_spheres,
    reach_solids,
    reach_cylinders,
    reach_scan,
    geometric_tracks,
    geometric_spheres,
    geometric_solids,
    count,
};

/// Everything that the work is done on, by a seed and the kind of work.
class UnitScene {
protected:
    std::size_t below(std::size_t n) noexcept { return static_cast<std::size_t>(random_.below(n)); }
    Vec3 within(float size) noexcept
    {
        const float x = random_.uniform(-size, size);
        const float y = random_.uniform(-size, size);
        return {x, y, random_.uniform(-size, size)};
    }
    Vec3 sized(float low, float high) noexcept
    {
        const float x = random_.uniform(low, high);
        const float y = random_.uniform(low, high);
        return {x, y, random_.uniform(low, high)};
    }
    Mat3 turned() noexcept
    {
        Mat3 axes;
        axes.col(2) = (within(1.0F) + Vec3(0.0F, 0.0F, 1.5F)).normalized();
        axes.col(0) = axes.col(2).cross(within(1.0F) + Vec3(1.5F, 0.0F, 0.0F)).normalized();
        axes.col(1) = axes.col(2).cross(axes.col(0));
        return axes;
    }
    geometry::Shape closed(const Vec3& at) noexcept
    {
        const float radius = random_.uniform(0.1F, 3.0F);
        return below(2) == 0 ? geometry::make_sphere(at, radius)
                             : geometry::make_capsule(at, at + within(6.0F), radius);
    }
    geometry::Shape upright(const Vec3& at) noexcept
    {
        return geometry::make_capsule(at, at + Vec3(0.0F, 0.0F, random_.uniform(0.0F, 9.0F)),
                                      random_.uniform(0.1F, 3.0F));
    }
    geometry::Shape solid(const Vec3& at) noexcept;
    void scene(Work work) noexcept;
    void wind() noexcept;
    [[nodiscard]] world::Situation situation() const noexcept
    {
        return {{}, own_, limits_, airframe_, reference_, rules_};
    }

    Random random_{0};
    std::array<Point3, kMaxHullVertices> vertices_{};
    vehicle::VehicleState own_;
    world::FlightRules rules_;
    vehicle::VehicleLimits limits_;
    vehicle::Airframe airframe_;
    world::Reference reference_;
    path::Route route_;
    world::Airspace airspace_;
    StaticVector<world::Cylinder, kMaxCylinders> cylinders_;
    StaticVector<world::Track, kMaxTracks> tracks_;
    StaticVector<world::Obstacle, kMaxObstacles> obstacles_;
    world::Manoeuvre manoeuvre_;

private:
    void path() noexcept;
};

}  // namespace jink::target
