// SPDX-License-Identifier: BSD-3-Clause
// jink tables: a vehicle's cost look-up tables, with the errors of their interpolation.
#include <cstdio>
#include <memory>
#include <string>

#include "core/geometric/planner.hpp"
#include "toolchain/host/commands.hpp"
#include "toolchain/host/cost_tables.hpp"
#include "toolchain/host/header_text.hpp"
#include "toolchain/sim/option_range.hpp"

namespace jink::host {
namespace {

struct TablesOptions {
    std::string file;
    std::string out;
    std::uint16_t waypoints = geometric::Settings{}.waypoints;
    bool check = false;
};

void print_line(const char* what, double error, float bound)
{
    std::printf("  %-28s %9.1e %9.1e\n", what, error, static_cast<double>(bound));
}

/// Errors of one family; false where a bound does not hold.
bool print_family(const cost::tables::Tables& tables, std::size_t family, const Density& density)
{
    const cost::tables::FamilyTable& table = tables.families[family];
    const TableErrors errors = sample_errors(tables, family, density);
    const ExactCurve curve(curve_families()[family], tables.waypoints);
    const double flat = 1e-3;
    const double wide = static_cast<double>(cost::tables::kLargestRatio);
    std::printf("%-30s %9s %9s   (%zu look-ups)\n", std::string(table.name).c_str(), "error", "bound", errors.look_ups);
    print_line("arc length", errors.length, table.bounds.length);
    print_line("duration", errors.time, table.bounds.time);
    print_line("  of all chords together", errors.chords, table.bounds.time);
    print_line("smoothness", errors.smoothness, table.bounds.smoothness);
    print_line("energy", errors.energy, table.bounds.energy);
    std::printf(
        "  of the exact integral, %u waypoints give %.1f %% of the smoothness when flat, %.1f %% at |w| = %.2f D\n",
        static_cast<unsigned>(tables.waypoints), 100.0 * curve.bend(flat) / exact_bend(curve_families()[family], flat),
        100.0 * curve.bend(wide) / exact_bend(curve_families()[family], wide), wide);
    const bool good = holds(errors, table.bounds);
    if (!good) {
        std::printf("  A BOUND DOES NOT HOLD\n");
    }
    return good;
}

void run_tables(const TablesOptions& options)
{
    check_outputs("tables", {options.file}, {options.out});
    const files::Vehicle vehicle = read_named_vehicle("tables", options.file);
    MadeTables made = make_tables(vehicle, options.waypoints);
    const cost::tables::Tables tables = made.view();
    const cost::Caps flights = cost::reference_flights(made.limits, made.airframe);
    std::printf("%s: %u waypoints, %zu bytes in %zu families; %s, relative errors:\n", made.vehicle.c_str(),
                static_cast<unsigned>(made.waypoints), made.bytes(), made.families.size(),
                options.check ? "checked between the samples that its bounds come from" : "as measured");
    bool good = true;
    for (std::size_t i = 0; i < tables.families.size(); ++i) {
        good = print_family(tables, i, options.check ? kChecking : kMeasuring) && good;
    }
    std::printf("reference flights              %.4f to %.4f s, %.2f to %.1f J; caps %.4f to %.4f s, %.2f to %.1f J\n",
                static_cast<double>(flights.time_low), static_cast<double>(flights.time_high),
                static_cast<double>(flights.energy_low), static_cast<double>(flights.energy_high),
                static_cast<double>(made.caps.time_low), static_cast<double>(made.caps.time_high),
                static_cast<double>(made.caps.energy_low), static_cast<double>(made.caps.energy_high));
    if (!good) {
        throw CLI::RuntimeError(kExitStop);
    }
    if (!options.out.empty()) {
        write_whole("tables", options.out, tables_header(made));
    }
}

}  // namespace

void add_tables(CLI::App& jink)
{
    auto options = std::make_shared<TablesOptions>();
    CLI::App* command = jink.add_subcommand(
        "tables", "make a vehicle's cost look-up tables; exit status 1 when an error bound does not hold");
    command->add_option("vehicle", options->file, "vehicle file (YAML)")->required();
    command->add_option("--out", options->out, "write the tables to this C++ header");
    command->add_option("--waypoints", options->waypoints, "points of every curve")
        ->capture_default_str()
        ->check(sim::whole(8, kMaxPathPoints));
    command->add_flag("--check", options->check,
                      "prove the bounds on samples twice as dense as, and between, those that they come from");
    command->callback([options] { run_tables(*options); });
}

}  // namespace jink::host
