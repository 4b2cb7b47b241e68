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

// A planning problem in YAML: what `jink plan` solves. docs/guides/planning_problems.md describes every key.

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
    geometry::Shape shape;  ///< where it is at the start
    Vec3 velocity = Vec3::Zero();
};

/// What a file says, checked: `problem_of` turns it into what the planner solves. Copies share the vertices of hulls.
struct ProblemFile {
    std::string title;
    files::Vehicle vehicle;
    geometric::Settings settings;
    std::vector<NamedThreat> threats;
    std::vector<NamedObstacle> obstacles;  ///< at rest
    std::vector<NamedMovingSolid> moving_solids;
    std::vector<std::shared_ptr<const std::vector<Point3>>> hulls;  ///< vertices that obstacles refer to
    bool has_airspace = false;
    world::Airspace airspace;

    Vec3 start = Vec3::Zero();
    Vec3 direction = Vec3::UnitX();  ///< unit vector
    path::Route route;               ///< the reference, where it is told by segments; empty: straight
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

/// Reads a problem file and the vehicle file that it may name. All that is wrong, not only the first thing.
[[nodiscard]] std::variant<ProblemFile, files::Complaints> read_problem(const std::filesystem::path& path);
/// The same for text already read; `file` names it in complaints, and vehicle files are looked for beside it.
[[nodiscard]] std::variant<ProblemFile, files::Complaints> read_problem_text(const std::string& text,
                                                                             const std::string& file);

/// What the spans of a problem refer to. Not to be moved while the problem is in use.
struct ProblemStorage {
    std::vector<world::Threat> threats;
    geometry::Shape main_shape;  ///< of a moving solid, where it is met
};
/// The problem as the planner wants it, its route included. It refers to `file` and `storage`, which outlive it.
[[nodiscard]] geometric::Problem problem_of(const ProblemFile& file, ProblemStorage& storage);

/// What became of a problem.
struct PlanOutcome {
    world::PlanStatus status = world::PlanStatus::bad_input;
    geometric::Result result;  ///< of the last try
    std::size_t tries = 0;
    std::uint32_t work = 0;  ///< units spent
};
/// Solves it as geometric::Planner does: the span of offsets widened for every try that finds nothing, up to
/// Settings::retries.
[[nodiscard]] std::unique_ptr<PlanOutcome> solve_problem(const ProblemFile& file, std::uint32_t budget);

}  // namespace jink::host
