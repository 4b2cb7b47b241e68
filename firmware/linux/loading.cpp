// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/loading.hpp"

#include <ctime>

#include "firmware/linux/airspace_file.hpp"
#include "firmware/linux/background.hpp"
#include "firmware/linux/param_store.hpp"

namespace jink::host {

void complain(const files::Complaints& complaints)
{
    for (const files::Complaint& complaint : complaints) {
        complain_now(files::to_string(complaint));
    }
}

bool load_airspace(const std::string& file, hal::SystemClock& clock, app::Coprocessor& coprocessor,
                   flightlog::HalRecorder* recorder)
{
    timespec t{};
    ::clock_gettime(CLOCK_REALTIME, &t);
    const TimePoint now{clock.now_us()};
    const double unix_seconds = static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec) * 1e-9;
    files::Complaints complaints;
    const auto constraints = files::read_airspace_file(file, {unix_seconds, now}, complaints);
    complain(complaints);
    if (constraints) {
        coprocessor.set_constraints(*constraints, now);
        if (recorder != nullptr) {
            recorder->areas(*constraints, now);
        }
        complain_now(files::areas_text(file, *constraints, now));
    }
    return constraints.has_value();
}

std::optional<files::MapTables> load_map(const std::string& file)
{
    files::Complaints complaints;
    auto map = files::read_map_file(file, complaints);
    complain(complaints);
    if (map) {
        complain_now(file + ": " + std::to_string(map->pieces.size()) + " pieces are known" +
                     (map->origin.known ? "" : ", in the autopilot's local frame"));
    }
    return map;
}

void load_state(const std::string& file, app::Parameters& parameters)
{
    if (file.empty()) {
        return;
    }
    files::Complaints complaints;
    const files::StateLoad load = files::load_state(file, parameters, complaints);
    complain(complaints);
    if (load.taken + load.refused > 0) {
        complain_now(file + ": " + std::to_string(load.taken) + " parameters as set over a link, " +
                     std::to_string(load.refused) + " lines left out");
    }
}

}  // namespace jink::host
