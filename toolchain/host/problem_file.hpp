// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "core/geometric/planner.hpp"
#include "firmware/linux/complaint.hpp"
#include "firmware/linux/vehicle_file.hpp"

// A planning problem in YAML, the input of `jink plan`. docs/guides/planning_problems.md describes every key.

namespace jink::host {

/// One sphere of the file, grown by its uncertainty.
struct NamedThreat {
    std::string name;
    world::Threat threat;
};

struct NamedObstacle {
    std::string name;
    world::Obstacle obstacle;
};

/// An obstacle of the file that has a velocity.
struct NamedMovingSolid {
    std::string name;
    geometry::Shape shape;  ///< at its start position
    Vec3 velocity = Vec3::Zero();
};

/// The checked contents of a file; `problem_of` converts it to the planner's problem. Copies share the vertices of
/// hulls.
struct ProblemFile {
    std::string title;
    files::Vehicle vehicle;
    geometric::Settings settings;
    std::vector<NamedThreat> threats;
    std::vector<NamedObstacle> obstacles;  ///< static
    std::vector<NamedMovingSolid> moving_solids;
    std::vector<std::shared_ptr<const std::vector<Point3>>> hulls;  ///< vertices that obstacles refer to
    bool has_airspace = false;
    world::Airspace airspace;

    Vec3 start = Vec3::Zero();
    Vec3 direction = Vec3::UnitX();  ///< unit vector
    path::Route route;               ///< the nominal path, if given by segments; empty: straight
    Vec3 frame_y = Vec3::Zero();     ///< of the path frame, unit vector across `direction`; zero: horizontal
    float speed = 5.0F;              ///< cruise speed along the candidates [m/s]
    Vec3 velocity = Vec3::Zero();    ///< own, at the start [m/s]
    float distance = 0.0F;           ///< D, given or from the closest approach on the leg [m]
    float main_radius = 0.0F;        ///< R [m]
    bool main_is_obstacle = false;   ///< or a moving solid
    bool main_is_moving_solid = false;
    std::size_t main = 0;  ///< index in threats, obstacles or moving solids
    Seconds meets_main = 0.0F;
    Vec3 main_centre_offset = Vec3::Zero();
    Vec3 flown_side = Vec3::Zero();
};

/// Reads a problem file and the vehicle file that it may name. Reports all errors.
[[nodiscard]] std::variant<ProblemFile, files::Complaints> read_problem(const std::filesystem::path& path);
/// The same for text already read; `file` is its name in complaints; vehicle files are searched beside it.
[[nodiscard]] std::variant<ProblemFile, files::Complaints> read_problem_text(const std::string& text,
                                                                             const std::string& file);

/// Storage for the spans of a problem. Do not move while the problem is in use.
struct ProblemStorage {
    std::vector<world::Threat> threats;
    geometry::Shape main_shape;  ///< of a moving solid, at the encounter
};
/// The planner's problem, its route included. Refers to `file` and `storage`, which must outlive the problem.
[[nodiscard]] geometric::Problem problem_of(const ProblemFile& file, ProblemStorage& storage);

/// Outcome of a planning problem.
struct PlanOutcome {
    world::PlanStatus status = world::PlanStatus::bad_input;
    geometric::Result result;  ///< of the last attempt
    std::size_t tries = 0;
    std::uint32_t work = 0;  ///< work units spent
};
/// Solves a problem as geometric::Planner does: after each attempt without a solution the span of offsets is widened,
/// up to Settings::retries.
[[nodiscard]] std::unique_ptr<PlanOutcome> solve_problem(const ProblemFile& file, std::uint32_t budget);

}  // namespace jink::host
