// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <exception>

#include "toolchain/host/commands.hpp"
#include "toolchain/sim/command_end.hpp"

namespace {

int run(int argc, char** argv)
{
    CLI::App app{"jink: plans, checks files, runs studies and writes reports on the host."};
    app.set_version_flag("--version", "jink " JINK_VERSION);
    app.require_subcommand(1);
    try {
        jink::host::add_campaign(app);
        jink::host::add_check(app);
        jink::host::add_log(app);
        jink::host::add_mesh(app);
        jink::host::add_parameters(app);
        jink::host::add_plan(app);
        jink::host::add_reach(app);
        jink::host::add_report(app);
        jink::host::add_scenes(app);
        jink::host::add_tables(app);
        jink::host::add_tune(app);
        jink::host::add_waypoints(app);
        app.parse(argc, argv);
        return jink::host::kExitGood;
    } catch (const CLI::RuntimeError& end) {
        return end.get_exit_code();
    } catch (const CLI::ParseError& error) {
        return jink::sim::end_of_parse(app, "jink", error);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "jink: %s\n", error.what());
        return jink::host::kExitBadInput;
    }
}

}  // namespace

int main(int argc, char** argv) { return jink::sim::with_output("jink", run(argc, argv)); }
