// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/flight_log/topics.hpp"

namespace jink::flightlog {

std::string_view name_of(link::SystemState state) noexcept
{
    switch (state) {
    case link::SystemState::boot: return "boot";
    case link::SystemState::standby: return "standby";
    case link::SystemState::active: return "active";
    case link::SystemState::critical: return "critical";
    case link::SystemState::emergency: return "emergency";
    }
    return "?";
}

std::string_view name_of(avoid::State state) noexcept
{
    switch (state) {
    case avoid::State::watching: return "watching";
    case avoid::State::avoiding: return "avoiding";
    case avoid::State::rejoining: return "rejoining";
    case avoid::State::braking: return "braking";
    }
    return "?";
}

std::string_view name_of(world::ManoeuvreKind kind) noexcept
{
    switch (kind) {
    case world::ManoeuvreKind::follow_path: return "follow path";
    case world::ManoeuvreKind::velocity: return "velocity";
    case world::ManoeuvreKind::brake: return "brake";
    case world::ManoeuvreKind::hold_turn: return "hold turn";
    }
    return "?";
}

std::string_view name_of(world::PlanStatus status) noexcept
{
    switch (status) {
    case world::PlanStatus::found: return "found";
    case world::PlanStatus::no_conflict: return "no conflict";
    case world::PlanStatus::too_close: return "too close";
    case world::PlanStatus::none_available: return "none available";
    case world::PlanStatus::budget_spent: return "budget spent";
    case world::PlanStatus::bad_input: return "bad input";
    case world::PlanStatus::running: return "running";
    }
    return "?";
}

std::string_view name_of(world::ThreatKind kind) noexcept
{
    switch (kind) {
    case world::ThreatKind::none: return "none";
    case world::ThreatKind::track: return "track";
    case world::ThreatKind::obstacle: return "obstacle";
    case world::ThreatKind::floor: return "floor";
    case world::ThreatKind::ceiling: return "ceiling";
    case world::ThreatKind::keep_in: return "keep in";
    case world::ThreatKind::cylinder: return "cylinder";
    }
    return "?";
}

std::string_view name_of(geometric::CandidateStatus status) noexcept
{
    switch (status) {
    case geometric::CandidateStatus::available: return "available";
    case geometric::CandidateStatus::chosen: return "chosen";
    case geometric::CandidateStatus::hits_static: return "hits static";
    case geometric::CandidateStatus::hits_moving: return "hits moving";
    case geometric::CandidateStatus::hits_airspace: return "hits airspace";
    case geometric::CandidateStatus::not_flyable: return "not flyable";
    case geometric::CandidateStatus::not_evaluated: return "not evaluated";
    }
    return "?";
}

}  // namespace jink::flightlog
