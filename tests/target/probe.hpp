// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/avoid/supervisor.hpp"
#include "core/geometric/planner.hpp"
#include "core/orca/planner.hpp"
#include "core/reach/planner.hpp"
#include "core/world/threat_set.hpp"
#include "tests/target/plan_bytes.hpp"
#include "tests/target/probe_record.hpp"

namespace jink::target {

/// Computes cases in sequence, each from a clean start, with the co-processor's default settings.
///
/// Between jink_window_begin() and jink_window_end() is exactly the counted code: the plan, or the update.
class Probe {
public:
    Probe() noexcept;

    /// An invalid record (magic, counts, capacities) gives an answer with magic 0.
    void answer(const ProbeRecord& record, ProbeAnswer& out) noexcept;

private:
    struct World;

    [[nodiscard]] world::PlanStatus plan(ProbeKind kind, const world::Situation& situation,
                                         WorkBudget& budget) noexcept;
    /// How many of `slicings` ways to slice a plan do not end with the bits of `manoeuvre_`, the plan in one piece.
    [[nodiscard]] std::uint32_t differing(const world::Situation& situation, const avoid::Settings& settings,
                                          std::uint32_t slicings, ProbeAnswer& out) noexcept;
    /// Whether the reach sets made the choice.
    [[nodiscard]] bool is_by_reach(const ProbeRecord& record, const ProbeAnswer& answer) const noexcept;

    geometric::Planner planner_;
    reach::Planner reach_;
    orca::Planner orca_;
    avoid::Supervisor<geometric::Planner, reach::Planner, orca::Planner> supervisor_;
    app::PlanMemory& memory_;
    world::ThreatSet threats_;
    world::Manoeuvre manoeuvre_;
};

}  // namespace jink::target
