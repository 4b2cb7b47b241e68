// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include <Eigen/Geometry>

#include "toolchain/host/problem_parts.hpp"

namespace jink::host::detail {
namespace {

using files::kNeed;
using files::YamlMap;

Mat3 turned(float yaw_degrees)
{
    return Eigen::AngleAxisf(yaw_degrees * kPi / 180.0F, Vec3::UnitZ()).toRotationMatrix();
}

geometry::Shape read_sphere(YamlMap& map)
{
    return geometry::make_sphere(map.vector("centre", kCoordinate, kNeed).value_or(Vec3::Zero()),
                                 map.number("radius", kSize, kNeed).value_or(1.0F));
}

geometry::Shape read_box(YamlMap& map)
{
    const Vec3 centre = map.vector("centre", kCoordinate, kNeed).value_or(Vec3::Zero());
    const Vec3 half = map.vector("half_extents", kSize, kNeed).value_or(Vec3::Ones());
    return geometry::make_box(centre, half, turned(map.number("yaw", {-360.0F, 360.0F}).value_or(0.0F)));
}

/// Capsule and cylinder: an axis and a radius.
template <class Make>
geometry::Shape read_round(YamlMap& map, const Make& make)
{
    const auto from = map.vector("from", kCoordinate, kNeed);
    const auto to = map.vector("to", kCoordinate, kNeed);
    const float radius = map.number("radius", kSize, kNeed).value_or(1.0F);
    if (from && to && (*to - *from).norm() < kSize.low) {
        map.complain("to", "lies on `from`: the axis needs a length");
    }
    const Vec3 a = from.value_or(Vec3::Zero());
    return make(a, from && to && *from != *to ? *to : Vec3(a + Vec3::UnitZ()), radius);
}

geometry::Shape read_hull(YamlMap& map, const std::string& file, ProblemFile& out, files::Complaints& complaints)
{
    auto vertices = std::make_shared<std::vector<Point3>>();
    if (const auto list = map.list("vertices", kNeed)) {
        if (list->size() < 4 || list->size() > kMaxHullVertices) {
            map.complain("vertices", "4 to " + std::to_string(kMaxHullVertices) + " are wanted, not " +
                                         std::to_string(list->size()));
        } else {
            for (std::size_t i = 0; i < list->size(); ++i) {
                const std::string where = map.name("vertices") + "[" + std::to_string(i) + "]";
                vertices->push_back(Point3::of(
                    files::vector_of((*list)[i], kCoordinate, where, file, complaints).value_or(Vec3::Zero())));
            }
        }
    }
    const Vec3 centre = map.vector("centre", kCoordinate).value_or(Vec3::Zero());
    const Mat3 axes = turned(map.number("yaw", {-360.0F, 360.0F}).value_or(0.0F));
    out.hulls.push_back(vertices);
    return geometry::make_hull(*vertices, centre, axes);
}

constexpr std::array<std::string_view, 5> kShapes{"sphere", "box", "capsule", "cylinder", "hull"};

geometry::Shape read_shape(std::size_t kind, YamlMap& map, const std::string& file, ProblemFile& out,
                           files::Complaints& complaints)
{
    switch (kind) {
    case 0: return read_sphere(map);
    case 1: return read_box(map);
    case 2: return read_round(map, geometry::make_capsule);
    case 3: return read_round(map, geometry::make_cylinder);
    default: return read_hull(map, file, out, complaints);
    }
}

}  // namespace

void read_obstacles(YamlMap& root, ProblemFile& out, MainObstacles& mains, files::Complaints& complaints)
{
    const std::string& file = root.file();
    const auto list = root.list("obstacles");
    if (!list) {
        return;
    }
    if (list->size() > kMaxObstacles) {
        root.complain("obstacles", std::to_string(list->size()) + " are more than " + std::to_string(kMaxObstacles));
        return;
    }
    for (std::size_t i = 0; i < list->size(); ++i) {
        const std::size_t before = complaints.size();
        const std::string where = "obstacles[" + std::to_string(i) + "]";
        YamlMap map((*list)[i], where, file, complaints);
        if (!map.is_map()) {
            continue;
        }
        NamedObstacle obstacle;
        obstacle.name = map.text("name").value_or("obstacle " + std::to_string(i));
        obstacle.obstacle.id = static_cast<world::ObstacleId>(i);
        const Vec3 velocity = map.vector("velocity", kVelocity).value_or(Vec3::Zero());
        const bool moves = velocity != Vec3::Zero();
        if (map.boolean("main").value_or(false)) {
            (moves ? mains.moving : mains.at_rest).push_back(moves ? out.moving_solids.size() : out.obstacles.size());
        }
        std::size_t shapes = 0;
        for (std::size_t kind = 0; kind < kShapes.size(); ++kind) {
            if (!map.has(kShapes[kind])) {
                continue;
            }
            ++shapes;
            if (auto shape = map.map(kShapes[kind])) {
                obstacle.obstacle.shape = read_shape(kind, *shape, file, out, complaints);
                shape->finish();
            }
        }
        if (shapes != 1) {
            complaints.push_back(files::complaint_at(
                (*list)[i].Mark(), file, where + ": exactly one of sphere, box, capsule, cylinder, hull is wanted"));
        }
        map.finish();
        if (complaints.size() == before && !geometry::is_valid(obstacle.obstacle.shape)) {
            complaints.push_back(files::complaint_at((*list)[i].Mark(), file, where + ": is no solid"));
        }
        if (moves) {
            out.moving_solids.push_back({std::move(obstacle.name), obstacle.obstacle.shape, velocity});
        } else {
            out.obstacles.push_back(std::move(obstacle));
        }
    }
    if (out.moving_solids.size() > geometric::kMaxMovingSolids) {
        root.complain("obstacles", std::to_string(out.moving_solids.size()) + " of them move, more than " +
                                       std::to_string(geometric::kMaxMovingSolids));
    }
}

}  // namespace jink::host::detail
