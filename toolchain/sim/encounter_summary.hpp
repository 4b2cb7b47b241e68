// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "toolchain/sim/encounter_campaign.hpp"

namespace jink::sim {

/// The ten worst, the worst first: broken promises that the judge calls avoidable, then flights in which a rule was
/// broken, then the others; within each the least separation first, then the smaller seed.
[[nodiscard]] std::vector<EncounterResult> worst_of(std::vector<EncounterResult> results);

/// Summary of all encounters as text: counts with shares and their 95 % intervals (statistics.hpp), quantiles, side
/// changes, effort, the same per number of intruders, every broken promise, and the ten worst. Byte-identical for equal
/// results.
[[nodiscard]] std::string summary_text(const FolderSetup& setup, const std::vector<EncounterResult>& results);

}  // namespace jink::sim
