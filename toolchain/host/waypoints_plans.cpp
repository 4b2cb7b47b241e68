// SPDX-License-Identifier: BSD-3-Clause
// Outcome and cost of plans with different numbers of waypoints.
#include <algorithm>
#include <ctime>
#include <memory>

#include "core/base/random.hpp"
#include "core/geometric/planner.hpp"
#include "toolchain/host/waypoints_study.hpp"

namespace jink::host {
namespace {

constexpr std::size_t kRepetitions = 9;

/// Main threat on the leg ahead, with a radius of a tenth of the distance; two more threats move about the leg and
/// grow.
struct DrawnScene {
    std::vector<world::Threat> threats;
    geometric::Problem problem;
};

DrawnScene draw(const vehicle::VehicleLimits& limits, std::uint64_t seed)
{
    Random random(seed);
    DrawnScene scene;
    const float speed = limits.cruise_speed;
    const float distance = study_distance(limits);
    const float climb = random.uniform(-0.3F, 0.3F);
    geometric::Problem& problem = scene.problem;
    problem.frame = geometric::make_path_frame(Vec3::Zero(), Vec3(1.0F, 0.0F, climb));
    problem.distance = distance;
    problem.main_radius = 0.1F * distance;
    problem.main = 0;
    problem.speed = speed;
    const Vec3 along = problem.frame.axes.col(0);
    problem.start_velocity = vehicle::clamped_velocity(along, speed, limits);
    scene.threats.push_back(world::track_threat(0, {distance * along, Vec3::Zero()}, {problem.main_radius}));
    for (int i = 0; i < 2; ++i) {
        const float x = random.uniform(0.4F, 2.4F);
        const float y = random.uniform(-0.8F, 0.8F);
        const Vec3 at = distance * Vec3(x, y, random.uniform(-0.5F, 0.5F));
        const float vx = random.uniform(-0.8F, 0.8F);
        const float vy = random.uniform(-0.8F, 0.8F);
        const Vec3 velocity = speed * Vec3(vx, vy, random.uniform(-0.3F, 0.3F));
        const float met = random.uniform(0.0F, 2.0F) * distance / speed;
        scene.threats.push_back(world::track_threat(scene.threats.size(), {at - met * velocity, velocity},
                                                    {distance * random.uniform(0.05F, 0.25F), 0.1F}));
    }
    return scene;
}

/// Key of the chosen curve: family, plane and the offset's index in its plane; 0 for none.
std::size_t choice_of(const geometric::Result& result, world::PlanStatus status)
{
    return status == world::PlanStatus::found ? result.chosen + 1 : 0;
}

}  // namespace

std::vector<WaypointPlans> waypoint_plans(const files::Vehicle& vehicle, const std::vector<std::uint16_t>& waypoints,
                                          std::size_t problems)
{
    const auto result = std::make_unique<geometric::Result>();
    geometric::Workspace workspace;
    const auto plan = [&](const DrawnScene& drawn, std::uint16_t count, WaypointPlans& out) {
        geometric::Problem problem = drawn.problem;
        problem.threats = drawn.threats;
        geometric::Settings settings;
        settings.waypoints = count;
        settings.check_units = 1'000'000;  // the answer, not where the work of an attempt ends
        settings.caps = vehicle.caps;
        WorkBudget budget(1'000'000);
        const auto status =
            geometric::solve(problem, settings, vehicle.limits, vehicle.airframe, budget, workspace, *result);
        out.units += static_cast<double>(budget.spent()) / static_cast<double>(problems);
        out.found += status == world::PlanStatus::found ? 1U : 0U;
        return choice_of(*result, status);
    };
    std::vector<DrawnScene> scenes;
    std::vector<std::size_t> finest;
    WaypointPlans unused;
    for (std::size_t i = 0; i < problems; ++i) {
        scenes.push_back(draw(vehicle.limits, i + 1));
        finest.push_back(plan(scenes.back(), static_cast<std::uint16_t>(kMaxPathPoints), unused));
    }
    std::vector<WaypointPlans> out;
    for (const std::uint16_t count : waypoints) {
        WaypointPlans& row = out.emplace_back();
        row.problems = problems;
        for (std::size_t i = 0; i < problems; ++i) {
            row.same_choice += plan(scenes[i], count, row) == finest[i] ? 1U : 0U;
        }
        double least = 1e300;
        for (std::size_t k = 0; k < kRepetitions; ++k) {
            const std::clock_t began = std::clock();
            for (const DrawnScene& scene : scenes) {
                plan(scene, count, unused);
            }
            least = std::min(least, static_cast<double>(std::clock() - began));
        }
        row.microseconds = 1e6 * least / (static_cast<double>(CLOCKS_PER_SEC) * static_cast<double>(problems));
    }
    return out;
}

}  // namespace jink::host
