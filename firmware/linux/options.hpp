// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "firmware/linux/housekeeping.hpp"
#include "firmware/linux/live_page/live_page.hpp"
#include "firmware/linux/logging.hpp"

namespace CLI {
class App;
}

namespace jink::host {

/// The command line of jinkd.
struct Options {
    std::string serial;
    std::string link;
    std::string can;
    std::string cloud;
    std::string vehicle_file;
    std::string param_file;
    std::string state_file;
    std::string airspace_file;
    std::string map_file;
    SigningFiles signing;
    LogOptions log;
    livepage::PageOptions page;
    std::string watchdog;
    std::string summary;
    double status_period = 1.0;
    unsigned clock = 0;  ///< of the processor [MHz]; 0: not said
    int system_id = 0;
    int node_id = 0;
    int realtime = 0;
    bool quiet = false;
};

inline constexpr const char* kAbout =
    "jinkd: collision avoidance beside a PX4 or ArduPilot autopilot, over MAVLink on a serial line, with\n"
    "sensors and traffic on a DroneCAN bus, or over MAVLink through that bus. Runs until SIGTERM or SIGINT.";
void add_options(CLI::App& cli, Options& options);
/// What CLI11 does not check: a line to the autopilot, and no empty names. False, with a message, where jinkd must not
/// start.
[[nodiscard]] bool check_names(const CLI::App& cli, const Options& options);
/// Names the files that jinkd keeps beside others: the state file where there is no option, and the signing state.
void name_stores(Options& options);
/// False, with a message, where a file that jinkd writes is one of those that it reads, or where two are one file, and
/// where the cloud line is the autopilot's device. Opens nothing.
[[nodiscard]] bool check_files(const Options& options);

}  // namespace jink::host
