// SPDX-License-Identifier: BSD-3-Clause
// jink waypoints: accuracy and cost of plans against the number of waypoints of their curves.
#include <cstdio>
#include <memory>
#include <string>

#include "core/geometric/planner.hpp"
#include "toolchain/host/commands.hpp"
#include "toolchain/host/waypoints_study.hpp"
#include "toolchain/sim/option_range.hpp"

namespace jink::host {
namespace {

struct WaypointsOptions {
    std::string file;
    std::vector<std::uint16_t> waypoints{8, 10, 13, 16, 19, 22, 25, 31, 37, 49, 57, 64};
    std::size_t problems = 1000;
};

files::Vehicle read(const std::string& file)
{
    if (file.empty()) {
        return *files::built_in_vehicle("default");
    }
    files::Complaints complaints;
    auto vehicle = files::read_vehicle_file(file, complaints);
    for (const files::Complaint& complaint : complaints) {
        std::fprintf(stderr, "%s\n", files::to_string(complaint).c_str());
    }
    if (!vehicle) {
        throw CLI::RuntimeError(kExitBadInput);
    }
    return *std::move(vehicle);
}

void run_waypoints(const WaypointsOptions& options)
{
    const files::Vehicle vehicle = read(options.file);
    const auto distance = static_cast<double>(study_distance(vehicle.limits));
    std::printf("%s, main threat %.0f m ahead; largest errors against %zu waypoints in double precision:\n",
                vehicle.name.c_str(), distance, kReferenceWaypoints);
    std::printf("%9s %9s %9s %9s %9s | %9s %9s | %12s %12s | %7s %7s %7s %8s\n", "waypoints", "time", "smooth.",
                "energy", "closeness", "cost", "order", "inside, wide", "typical", "found", "as 64", "units", "us");
    const std::vector<WaypointPlans> plans = waypoint_plans(vehicle, options.waypoints, options.problems);
    for (std::size_t i = 0; i < options.waypoints.size(); ++i) {
        const WaypointErrors e = waypoint_errors(vehicle, options.waypoints[i]);
        const WaypointPlans& p = plans[i];
        const double all = static_cast<double>(p.problems);
        std::printf(
            "%9zu %8.3f%% %8.2f%% %8.3f%% %8.3f%% | %9.5f %9.5f | %10.3f m %10.3f m | %6.1f%% %6.1f%% %7.0f %8.1f%s\n",
            e.waypoints, 100.0 * e.time, 100.0 * e.smoothness, 100.0 * e.energy, 100.0 * e.closeness, e.cost, e.order,
            distance * e.inside, distance * e.typical, 100.0 * static_cast<double>(p.found) / all,
            100.0 * static_cast<double>(p.same_choice) / all, p.units, p.microseconds,
            e.waypoints == geometric::Settings{}.waypoints ? "  default" : "");
    }
    std::printf(
        "order: largest difference of the cost's errors between two curves of a leg. inside: how far a chord lies\n"
        "from its curve, at |w| = 1.28 D and 0.4 D. found, as 64, units, us: %zu random problems, one attempt each;\n"
        "us of CPU on this machine.\n",
        options.problems);
}

}  // namespace

void add_waypoints(CLI::App& jink)
{
    auto options = std::make_shared<WaypointsOptions>();
    CLI::App* command = jink.add_subcommand(
        "waypoints", "study of how many waypoints candidates need: errors of costs and shape, work and time of plans");
    command->add_option("vehicle", options->file, "vehicle file (YAML), default: the default vehicle");
    command->add_option("--waypoints", options->waypoints, "numbers to look at")
        ->capture_default_str()
        ->check(sim::whole(8, kMaxPathPoints));
    command->add_option("--problems", options->problems, "random problems to plan")
        ->capture_default_str()
        ->check(sim::whole(1, 1'000'000));
    command->callback([options] { run_waypoints(*options); });
}

}  // namespace jink::host
