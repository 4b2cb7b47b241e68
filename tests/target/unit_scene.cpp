// SPDX-License-Identifier: BSD-3-Clause
#include "tests/target/unit_scene.hpp"

namespace jink::target {

geometry::Shape UnitScene::solid(const Vec3& at) noexcept
{
    switch (below(3)) {
    case 0: {
        const Vec3 half = sized(0.1F, 3.0F);
        return geometry::make_box(at, half, turned());
    }
    case 1: return geometry::make_cylinder(at, at + within(5.0F), random_.uniform(0.1F, 3.0F));
    default: break;
    }
    const std::size_t count = 4 + below(kMaxHullVertices - 3);
    for (std::size_t i = 0; i < count; ++i) {
        vertices_[i] = Point3::of(within(3.0F));
    }
    return geometry::make_hull({vertices_.data(), count}, at, turned());
}

void UnitScene::path() noexcept
{
    manoeuvre_ = {};
    manoeuvre_.kind = world::ManoeuvreKind::follow_path;
    const std::size_t points = 2 + below(kMaxPathPoints - 1);
    const Seconds step = random_.uniform(0.05F, 0.6F);
    Vec3 at = own_.position;
    Vec3 velocity = own_.velocity;
    for (std::size_t i = 0; i < points; ++i) {
        manoeuvre_.path.points.unchecked_push_back({at, velocity, step * static_cast<float>(i)});
        at += velocity * step;
        velocity = 0.9F * velocity + 0.1F * within(5.0F);
    }
}

void UnitScene::scene(Work work) noexcept
{
    own_ = {};
    own_.position = within(50.0F);
    own_.velocity = within(4.0F);
    const bool reach = work >= Work::reach_tracks && work <= Work::reach_scan;
    if (reach) {
        own_.velocity.z() *= 0.1F;  // steeper there is no set
    }
    own_.sigma_position = below(2) == 0 ? 0.0F : 0.1F;
    limits_ = {};
    limits_.half_extents = sized(0.2F, 1.5F);
    if (work == Work::fallback && below(3) == 0) {
        limits_.kind = vehicle::VehicleKind::fixed_wing;
    }
    airspace_ = {};
    airspace_.has_floor = below(2) == 0;
    airspace_.has_ceiling = below(2) == 0;
    airspace_.has_keep_in = below(2) == 0;
    airspace_.floor = -60.0F;
    airspace_.ceiling = 60.0F;
    airspace_.keep_in_radius = 200.0F;
    const Vec3 leg = within(50.0F);
    reference_ = world::Reference({own_.position, own_.position + leg, 5.0F});
    tracks_.clear();
    obstacles_.clear();
    path();

    const bool geometric = work >= Work::geometric_tracks && work <= Work::geometric_solids;
    const bool aircraft = work == Work::aircraft_look || work == Work::aircraft_command;
    rules_.well_clear.radius = aircraft ? 610.0F : 0.0F;
    const bool tracks = aircraft || work == Work::separation_tracks || work == Work::conflict_tracks ||
                        work == Work::fallback || work == Work::orca_tracks || work == Work::objective_leg ||
                        work == Work::objective_route || work == Work::common_stop || work == Work::reach_tracks ||
                        geometric;
    const bool spheres = work == Work::separation_spheres || work == Work::conflict_spheres || work == Work::fallback ||
                         work == Work::orca_spheres || work == Work::reach_spheres || work == Work::geometric_spheres;
    const bool cylinders =
        work == Work::separation_cylinders || work == Work::conflict_cylinders || work == Work::reach_cylinders;
    const bool solids = work == Work::separation_solids || work == Work::conflict_solids || work == Work::orca_solids ||
                        work == Work::reach_solids || work == Work::objective_solids || work == Work::geometric_solids;
    const float spread = random_.uniform(1.0F, 60.0F);
    // Few threats in every other case, where a node or a candidate costs more than its threats.
    const bool few = (reach || geometric) && below(2) == 0;
    const auto most = [few](std::size_t capacity) noexcept { return few ? std::size_t{4} : capacity + 1; };
    // A plan needs something in its way.
    const auto place = [&, this](std::size_t i) noexcept {
        return geometric && i == 0 ? Vec3(own_.position + random_.uniform(0.1F, 1.0F) * leg + within(1.0F))
                                   : Vec3(own_.position + within(spread));
    };
    for (std::size_t i = 0, n = tracks ? below(most(kMaxTracks)) : 0; i < n; ++i) {
        world::Track track;
        track.id = static_cast<std::uint32_t>(i);
        track.position = place(i);
        track.velocity = below(3) == 0 ? own_.velocity : within(6.0F);
        track.radius = random_.uniform(0.2F, 4.0F);
        track.sigma_velocity = below(2) == 0 ? 0.0F : 0.2F;
        track.max_acceleration = below(3) == 0 ? 0.3F : 0.0F;
        track.cooperative = below(2) == 0;
        if (geometric && i == 0 && below(2) == 0) {
            track.velocity.setZero();
        }
        if (aircraft) {
            track.manned = true;
            track.position = own_.position + within(25.0F * spread).cwiseProduct(Vec3(1.0F, 1.0F, 0.1F));
            track.velocity *= 10.0F;
            track.turn_rate = below(2) == 0 ? 0.0F : random_.uniform(-0.3F, 0.3F);
        }
        tracks_.unchecked_push_back(track);
    }
    cylinders_.clear();
    for (std::size_t i = 0, n = cylinders ? below(most(kMaxCylinders)) : 0; i < n; ++i) {
        const Vec3 at = own_.position + within(spread);
        world::Cylinder cylinder;
        cylinder.circle = {at.head<2>(), random_.uniform(0.2F, 8.0F)};
        cylinder.velocity = below(2) == 0 ? world::Vec2(world::Vec2::Zero()) : world::Vec2(within(6.0F).head<2>());
        cylinder.bottom = at.z() - random_.uniform(0.0F, 8.0F);
        cylinder.top = at.z() + random_.uniform(0.0F, 8.0F);
        cylinder.margin = random_.uniform(0.0F, 4.0F);
        cylinders_.unchecked_push_back(cylinder);
    }
    airspace_.cylinders = {cylinders_.data(), cylinders_.size()};
    for (std::size_t i = 0, n = spheres ? below(most(kMaxObstacles)) : 0; i < n; ++i) {
        obstacles_.unchecked_push_back({static_cast<world::ObstacleId>(i), upright(place(i))});
    }
    for (std::size_t i = 0, n = solids ? below(6) : 0; i < n; ++i) {
        const Vec3 at = place(i);
        obstacles_.unchecked_push_back({static_cast<world::ObstacleId>(i), below(4) == 0 ? closed(at) : solid(at)});
    }
}

/// As many legs and arcs as a route may have.
void UnitScene::wind() noexcept
{
    route_.clear();
    Vec3 from = own_.position;
    while (route_.segments().size() < kMaxRouteSegments) {
        const bool arc = below(3) != 0;
        const Vec3 aside = Vec3(random_.uniform(-1.0F, 1.0F), random_.uniform(0.2F, 1.0F), 0.0F).normalized();
        const path::RouteStatus added = arc ? route_.add_arc(from, from + random_.uniform(2.0F, 30.0F) * aside,
                                                             Vec3::UnitZ(), random_.uniform(-3.0F, 3.0F))
                                            : route_.add_leg(from, from + within(30.0F));
        if (added == path::RouteStatus::ok) {
            from = route_.at(route_.length()).position;
        }
    }
}

}  // namespace jink::target
