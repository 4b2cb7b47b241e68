// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "toolchain/host/problem_file.hpp"

// A plan for people (table), for spreadsheets (CSV) and for programs (JSON). docs/guides/planning_problems.md explains
// the columns.

namespace jink::host {

[[nodiscard]] std::string_view name_of(world::PlanStatus status);
[[nodiscard]] std::string_view name_of(geometric::CandidateStatus status);
/// Name, as in the file, of the threat or obstacle that a candidate is in contact with; empty for none.
[[nodiscard]] std::string hit_name(const ProblemFile& file, const world::ThreatRef& hit);

[[nodiscard]] std::string plan_table(const ProblemFile& file, const PlanOutcome& outcome);
/// One line per candidate under a line of column names. Terms of candidates without cost are empty; contact with a
/// moving threat's path is `inf`.
[[nodiscard]] std::string plan_csv(const ProblemFile& file, const PlanOutcome& outcome);
/// `points`: with the curve of every candidate. Infinite closeness is null.
[[nodiscard]] nlohmann::ordered_json plan_json(const ProblemFile& file, const PlanOutcome& outcome, bool points);

}  // namespace jink::host
