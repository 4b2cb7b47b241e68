// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/decision_at.hpp"

#include <algorithm>
#include <numbers>
#include <sstream>

#include "firmware/app/method_orders.hpp"

namespace jink::sim {

std::string_view status_name(geometric::CandidateStatus status) noexcept
{
    using geometric::CandidateStatus;
    switch (status) {
    case CandidateStatus::available: return "available";
    case CandidateStatus::chosen: return "chosen";
    case CandidateStatus::hits_static: return "hits_static";
    case CandidateStatus::hits_moving: return "hits_moving";
    case CandidateStatus::hits_airspace: return "hits_airspace";
    case CandidateStatus::not_flyable: return "not_flyable";
    case CandidateStatus::not_evaluated: break;
    }
    return "not_evaluated";
}

std::string chosen_candidate(const app::Coprocessor& coprocessor)
{
    const auto& candidates = coprocessor.planner().last().candidates;
    const auto* const chosen = std::find_if(candidates.begin(), candidates.end(), [](const geometric::Candidate& c) {
        return c.status == geometric::CandidateStatus::chosen;
    });
    if (chosen == candidates.end()) {
        return "";
    }
    std::ostringstream text;
    text.precision(3);
    text << to_string(chosen->shape.family) << ", plane "
         << static_cast<double>(chosen->shape.plane) * 180.0 / std::numbers::pi << " deg, offset "
         << static_cast<double>(chosen->shape.offset) << " m, cost " << static_cast<double>(chosen->total);
    return text.str();
}

DecisionAt decision_at(const app::Coprocessor& coprocessor, const app::StepReport& report, double time)
{
    const avoid::Guidance& guidance = report.guidance;
    DecisionAt decision;
    decision.time = time;
    decision.text =
        guidance.by == 0 ? "no method has an answer" : "answer of method " + std::string(app::method_name(guidance.by));
    if (const std::string chosen = chosen_candidate(coprocessor); !chosen.empty()) {
        decision.text += "; chosen candidate: " + chosen;
    }
    decision.start = coprocessor.own().position.cast<double>();
    if (guidance.conflict) {
        decision.own_at_closest = guidance.conflict->own_at_closest.cast<double>();
    }
    const auto& candidates = coprocessor.planner().last().candidates;
    decision.candidates.assign(candidates.begin(), candidates.end());
    return decision;
}

}  // namespace jink::sim
