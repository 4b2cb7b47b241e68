// SPDX-License-Identifier: BSD-3-Clause
#include <utility>

#include "firmware/linux/flight_log/topics.hpp"

namespace jink::flightlog {

std::string names_of_faults(std::uint16_t faults)
{
    using app::Fault;
    constexpr std::array kNames = std::to_array<std::pair<Fault, std::string_view>>({
        {Fault::no_autopilot, "no autopilot"},
        {Fault::autopilot_silent, "autopilot silent"},
        {Fault::own_state_missing, "own state missing"},
        {Fault::own_state_stale, "own state stale"},
        {Fault::port_lost, "port lost"},
        {Fault::late, "late"},
        {Fault::not_finite, "not finite"},
        {Fault::passive, "passive"},
        {Fault::bus_lost, "bus lost"},
        {Fault::airspace_unplaced, "airspace unplaced"},
        {Fault::map_unresolved, "map unresolved"},
    });
    std::string text;
    for (const auto& [fault, name] : kNames) {
        if ((faults & app::bit(fault)) != 0) {
            text += (text.empty() ? "" : ", ") + std::string(name);
        }
    }
    return text.empty() ? "none" : text;
}

}  // namespace jink::flightlog
