// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/scenario.hpp"

namespace jink::sim {

std::string_view to_string(Outcome outcome) noexcept
{
    switch (outcome) {
    case Outcome::clear: return "clear";
    case Outcome::avoided: return "avoided";
    case Outcome::braked: return "braked";
    case Outcome::breach: return "breach";
    case Outcome::collision: return "collision";
    case Outcome::failed: break;
    }
    return "failed";
}

std::string_view to_string(Mode mode) noexcept
{
    switch (mode) {
    case Mode::mission: return "mission";
    case Mode::external: return "external";
    case Mode::hold: return "hold";
    case Mode::brake: return "brake";
    case Mode::home: return "home";
    case Mode::land: return "land";
    case Mode::guided: return "guided";
    case Mode::pilot: break;
    }
    return "pilot";
}

std::string_view to_string(PlannerKind planner) noexcept
{
    return planner == PlannerKind::product ? "product" : "source";
}

std::string_view to_string(Stack stack) noexcept { return stack == Stack::ardupilot ? "ardupilot" : "px4"; }

}  // namespace jink::sim
