// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/host/problem_file.hpp"

#include <algorithm>
#include <array>
#include <tuple>

#include "toolchain/host/problem_parts.hpp"

namespace jink::host {
namespace {

using detail::kSpeed;
using files::Complaints;
using files::kNeed;
using files::YamlMap;
constexpr std::array<std::string_view, 2> kBuiltInVehicles{"default", "uav2"};
constexpr float kShortest = 1e-3F;  // of a leg or a direction

/// State of the reader besides the file that it fills.
struct Reader {
    YamlMap& root;
    Complaints& complaints;
    ProblemFile out;
    std::vector<std::size_t> main_threats;
    detail::MainObstacles main_obstacles;
    bool has_distance = false;
    bool has_main_radius = false;
    float leg_length = 0.0F;
};

void read_vehicle_part(Reader& reader)
{
    ProblemFile& out = reader.out;
    const auto node = reader.root.node("vehicle", kNeed);
    std::optional<files::Vehicle> vehicle;
    if (node && node->IsScalar()) {
        vehicle = files::built_in_vehicle(node->Scalar());
        if (!vehicle) {
            const std::filesystem::path beside =
                std::filesystem::path(reader.root.file()).parent_path() / node->Scalar();
            const std::size_t before = reader.complaints.size();
            vehicle = files::read_vehicle_file(beside, reader.complaints);
            if (reader.complaints.size() != before) {
                reader.root.complain(
                    "vehicle", files::in_quotes(node->Scalar()) +
                                   " is neither a vehicle file beside this one that can be used, nor default or uav2" +
                                   files::suggestion(node->Scalar(), kBuiltInVehicles));
            }
        }
    } else if (node) {
        vehicle = files::read_vehicle(*node, "vehicle", reader.root.file(), reader.complaints);
    }
    out.vehicle = vehicle.value_or(*files::built_in_vehicle("default"));
    if (const auto side = reader.root.number("collision_box_side", {0.2F, 40.0F})) {
        out.vehicle.limits.half_extents = Vec3::Constant(0.5F * *side);
    }
}

void set_direction(Reader& reader, std::string_view key, const Vec3& along)
{
    if (along.norm() < kShortest) {
        reader.root.complain(key, "has no length: no direction can be told");
        return;
    }
    reader.out.direction = along.normalized();
}

void read_leg(Reader& reader, YamlMap& leg)
{
    ProblemFile& out = reader.out;
    const auto start = leg.vector("start", detail::kCoordinate, kNeed);
    const auto end = leg.vector("end", detail::kCoordinate, kNeed);
    out.speed = leg.number("speed", kSpeed).value_or(out.vehicle.limits.cruise_speed);
    leg.finish();
    out.start = start.value_or(out.start);
    if (start && end) {
        set_direction(reader, "leg", *end - *start);
        reader.leg_length = (*end - *start).norm();
    }
}

/// Either `leg` or `reference`, whose collision point is computed, or `start`, `direction` and `distance` to the
/// collision point.
void read_way(Reader& reader)
{
    YamlMap& root = reader.root;
    ProblemFile& out = reader.out;
    const std::string_view way = root.has("leg") ? "leg" : "reference";
    if (root.has(way)) {
        for (const std::string_view key : {"start", "direction", "distance", "speed", "reference"}) {
            if (key != way && root.has(key)) {
                root.complain(key, "does not go with `" + std::string(way) + "`");
            }
        }
        if (way == "reference") {
            detail::read_reference(root, out, reader.complaints);
        } else if (auto leg = root.map("leg")) {
            read_leg(reader, *leg);
        }
    } else {
        out.start = root.vector("start", detail::kCoordinate, kNeed).value_or(out.start);
        if (const auto along = root.vector("direction", detail::kCoordinate, kNeed)) {
            set_direction(reader, "direction", *along);
        }
        out.distance = root.number("distance", {0.1F, 10000.0F}, kNeed).value_or(1.0F);
        out.speed = root.number("speed", kSpeed).value_or(out.vehicle.limits.cruise_speed);
        reader.has_distance = true;
    }
    detail::read_frame(root, out);
    out.velocity = root.vector("velocity", detail::kVelocity)
                       .value_or(vehicle::clamped_velocity(out.direction, out.speed, out.vehicle.limits));
    out.flown_side = root.vector("flown_side", {-1.0F, 1.0F}).value_or(Vec3::Zero());
    if (const auto radius = root.number("main_radius", detail::kSize)) {
        out.main_radius = *radius;
        reader.has_main_radius = true;
    }
}

void read_threats(Reader& reader)
{
    const float k_sigma = reader.root.number("k_sigma", {0.0F, 6.0F}).value_or(3.0F);
    const auto list = reader.root.list("threats");
    if (!list) {
        return;
    }
    if (list->size() > kMaxTracks) {
        reader.root.complain("threats", std::to_string(list->size()) + " are more than " + std::to_string(kMaxTracks));
        return;
    }
    for (std::size_t i = 0; i < list->size(); ++i) {
        YamlMap map((*list)[i], "threats[" + std::to_string(i) + "]", reader.root.file(), reader.complaints);
        if (!map.is_map()) {
            continue;
        }
        NamedThreat named;
        named.name = map.text("name").value_or("threat " + std::to_string(i));
        geometry::Motion motion;
        world::Growth growth;
        motion.position = map.vector("position", detail::kCoordinate, kNeed).value_or(Vec3::Zero());
        motion.velocity = map.vector("velocity", detail::kVelocity).value_or(Vec3::Zero());
        growth.radius = map.number("radius", detail::kSize, kNeed).value_or(1.0F) +
                        k_sigma * map.number("sigma_position", {0.0F, 500.0F}).value_or(0.0F);
        growth.rate = k_sigma * map.number("sigma_velocity", {0.0F, 100.0F}).value_or(0.0F);
        growth.acceleration = map.number("max_acceleration", {0.0F, 50.0F}).value_or(0.0F);
        named.threat = world::track_threat(i, motion, growth);
        if (map.boolean("main").value_or(false)) {
            reader.main_threats.push_back(i);
        }
        map.finish();
        reader.out.threats.push_back(std::move(named));
    }
}

void read_airspace(Reader& reader)
{
    auto map = reader.root.map("airspace");
    if (!map) {
        return;
    }
    world::Airspace& airspace = reader.out.airspace;
    const auto floor = map->number("floor", detail::kCoordinate);
    const auto ceiling = map->number("ceiling", detail::kCoordinate);
    airspace.has_floor = floor.has_value();
    airspace.has_ceiling = ceiling.has_value();
    airspace.floor = floor.value_or(0.0F);
    airspace.ceiling = ceiling.value_or(0.0F);
    if (auto keep_in = map->map("keep_in")) {
        airspace.has_keep_in = true;
        airspace.home = keep_in->vector("home", detail::kCoordinate).value_or(Vec3::Zero());
        airspace.keep_in_radius = keep_in->number("radius", {1.0F, 50000.0F}, kNeed).value_or(1.0F);
        keep_in->finish();
    }
    map->finish();
    if (floor && ceiling && *ceiling - *floor < 2.0F * reader.out.vehicle.limits.half_extents.z()) {
        reader.root.complain("airspace", "the own box does not fit between floor and ceiling");
    }
    reader.out.has_airspace = true;
}

/// Finds the main threat or obstacle: the flagged one, or the only one in the file.
bool find_main(Reader& reader)
{
    ProblemFile& out = reader.out;
    const detail::MainObstacles& solids = reader.main_obstacles;
    const std::size_t flagged = reader.main_threats.size() + solids.at_rest.size() + solids.moving.size();
    const std::size_t all = out.threats.size() + out.obstacles.size() + out.moving_solids.size();
    if (all == 0) {
        reader.complaints.push_back(
            {0, 0, "no threat and no obstacle: there is nothing to plan around", reader.root.file()});
        return false;
    }
    if (flagged > 1 || (flagged == 0 && all > 1)) {
        reader.root.complain(reader.root.has("threats") ? "threats" : "obstacles",
                             "exactly one threat or obstacle must say `main: true`, not " + std::to_string(flagged));
        return false;
    }
    out.main_is_obstacle = flagged == 1 ? reader.main_threats.empty() : out.threats.empty();
    out.main_is_moving_solid = flagged == 1 ? !solids.moving.empty() : !out.moving_solids.empty();
    if (flagged == 1) {
        out.main = !out.main_is_obstacle      ? reader.main_threats.front()
                   : out.main_is_moving_solid ? solids.moving.front()
                                              : solids.at_rest.front();
    }
    return true;
}

/// Sets the collision point and dependent values: closest approach of the centres while the vehicle flies along the leg
/// or the reference, or the given distance.
void meet_main(Reader& reader)
{
    ProblemFile& out = reader.out;
    geometry::Motion motion;
    if (out.main_is_moving_solid) {
        motion = {out.moving_solids[out.main].shape.centre, out.moving_solids[out.main].velocity};
    } else if (out.main_is_obstacle) {
        motion.position = out.obstacles[out.main].obstacle.shape.centre;
    } else {
        motion = {out.threats[out.main].threat.position, out.threats[out.main].threat.velocity};
    }
    const Vec3 own = vehicle::clamped_velocity(out.direction, out.speed, out.vehicle.limits);
    Seconds when = out.distance / own.norm();
    if (!out.route.empty()) {
        const auto distance = detail::nearest_on_reference(out, motion);
        if (!distance) {
            reader.root.complain("reference", "the main threat is not nearest on it, but at its start or its end");
            return;
        }
        out.distance = *distance;
        when = out.distance / out.speed;
    } else if (!reader.has_distance) {
        const Vec3 closing = own - motion.velocity;
        const float closing2 = closing.squaredNorm();
        when = closing2 > 1e-6F ? (motion.position - out.start).dot(closing) / closing2 : 0.0F;
        out.distance = when * own.norm();
        if (!(when > 0.0F && out.distance <= reader.leg_length)) {
            reader.root.complain("leg", "the main threat is not nearest on it, but " +
                                            std::string(when > 0.0F ? "beyond its end" : "at or before its start"));
            return;
        }
    }
    out.meets_main = when;
    const Vec3 point =
        out.route.empty() ? Vec3(out.start + out.distance * out.direction) : out.route.at(out.distance).position;
    out.main_centre_offset = motion.position + when * motion.velocity - point;
    if (reader.has_main_radius) {
        return;
    }
    if (out.main_is_moving_solid) {
        out.main_radius = geometry::bounding_radius(out.moving_solids[out.main].shape);
    } else if (out.main_is_obstacle) {
        out.main_radius = geometry::bounding_radius(out.obstacles[out.main].obstacle.shape);
    } else {
        const world::Growth& growth = out.threats[out.main].threat.growth;
        out.main_radius = growth.radius + growth.rate * when + 0.5F * growth.acceleration * when * when;
    }
}

std::variant<ProblemFile, Complaints> read(const YAML::Node& node, const std::string& file)
{
    Complaints complaints;
    YamlMap root(node, "", file, complaints);
    if (!root.is_map()) {
        return complaints;
    }
    Reader reader{root, complaints, {}, {}, {}};
    reader.out.title = root.text("title").value_or(std::filesystem::path(file).stem().string());
    read_vehicle_part(reader);
    read_way(reader);
    read_threats(reader);
    detail::read_obstacles(root, reader.out, reader.main_obstacles, complaints);
    read_airspace(reader);
    detail::read_settings(root, reader.out.vehicle.caps, reader.out.settings, complaints);
    root.finish();
    if (complaints.empty() && find_main(reader)) {
        meet_main(reader);
    }
    if (complaints.empty() && !geometric::is_valid(reader.out.settings)) {
        root.complain("settings", "are out of range");
    }
    if (!complaints.empty()) {
        std::stable_sort(complaints.begin(), complaints.end(),
                         [](const files::Complaint& a, const files::Complaint& b) {
                             return std::tie(a.file, a.line, a.column) < std::tie(b.file, b.line, b.column);
                         });
        return complaints;
    }
    return std::move(reader.out);
}

}  // namespace

std::variant<ProblemFile, Complaints> read_problem_text(const std::string& text, const std::string& file)
{
    Complaints complaints;
    const auto root = files::parse_yaml(text, file, complaints);
    return root ? read(*root, file) : std::variant<ProblemFile, Complaints>(complaints);
}

std::variant<ProblemFile, Complaints> read_problem(const std::filesystem::path& path)
{
    Complaints complaints;
    const auto text = files::read_text_file(path, complaints);
    return text ? read_problem_text(*text, path.string()) : std::variant<ProblemFile, Complaints>(complaints);
}

geometric::Problem problem_of(const ProblemFile& file, ProblemStorage& storage)
{
    storage.threats.clear();
    if (file.has_airspace) {
        const auto bounds = world::bounds_of(file.airspace, 0.0F);
        storage.threats.assign(bounds.begin(), bounds.end());
    }
    const std::size_t bounds = storage.threats.size();
    for (const NamedThreat& threat : file.threats) {
        storage.threats.push_back(threat.threat);
    }
    for (const NamedObstacle& obstacle : file.obstacles) {
        storage.threats.push_back(world::obstacle_threat(storage.threats.size() - bounds - file.threats.size(),
                                                         obstacle.obstacle.shape, 0.0F));
    }
    for (const NamedMovingSolid& solid : file.moving_solids) {
        storage.threats.push_back(world::solid_threat(storage.threats.size() - bounds - file.threats.size(),
                                                      solid.shape, solid.velocity, {}));
    }
    geometric::Problem problem;
    problem.frame = geometric::make_path_frame(file.start, file.direction);
    if (file.frame_y != Vec3::Zero()) {
        problem.frame = geometric::make_path_frame(file.start, file.direction, file.frame_y);
    }
    problem.ahead.route = file.route;
    problem.distance = file.distance;
    problem.main_radius = file.main_radius;
    problem.threats = storage.threats;
    problem.start_velocity = file.velocity;
    problem.speed = file.speed;
    problem.preferred_side = file.flown_side;
    problem.main_centre_offset = file.main_centre_offset;
    if (!file.main_is_obstacle) {
        problem.main = file.main;
    } else if (file.main_is_moving_solid) {
        storage.main_shape = file.moving_solids[file.main].shape;
        storage.main_shape.centre += file.meets_main * file.moving_solids[file.main].velocity;
        problem.main_shape = &storage.main_shape;
    } else if (file.obstacles[file.main].obstacle.shape.kind != geometry::ShapeKind::sphere) {
        problem.main_shape = &file.obstacles[file.main].obstacle.shape;
    }
    return problem;
}

std::unique_ptr<PlanOutcome> solve_problem(const ProblemFile& file, std::uint32_t budget)
{
    auto outcome = std::make_unique<PlanOutcome>();
    ProblemStorage storage;
    const geometric::Problem problem = problem_of(file, storage);
    WorkBudget work(budget);
    geometric::Workspace workspace;
    geometric::Settings settings = file.settings;
    settings.all_terms = settings.evaluate_all = true;  // for printing
    outcome->status = geometric::solve_with_retries(problem, settings, file.vehicle.limits, file.vehicle.airframe, work,
                                                    workspace, outcome->result, outcome->tries);
    outcome->work = work.spent();
    return outcome;
}

}  // namespace jink::host
