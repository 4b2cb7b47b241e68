// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

// The distribution study of the planner's source (Pinheiro 4.2, tab. 4.1): candidates over a grid of environments,
// their flight times and energies, and how the two go together.

namespace jink::host {

/// One figure of the study.
struct CampaignFigure {
    std::string name;
    std::string unit;
    double published = 0.0;
    double ours = 0.0;
    bool expected_to_agree =
        false;  ///< within kCampaignTolerance; the others belong to a set-up that the source's text does not give

    [[nodiscard]] double deviation() const { return published != 0.0 ? ours / published - 1.0 : 0.0; }
};
inline constexpr double kCampaignTolerance = 0.005;

struct CampaignResult {
    std::size_t environments = 0;          ///< all of the grid
    std::size_t environments_skipped = 0;  ///< main threat nearer than 2.5 R
    std::size_t candidates = 0;
    double closeness_median = 0.0;  ///< M of eq. 4.12 with our guess of the moving threat's velocity [1/m]
    std::vector<CampaignFigure> figures;
};

/// Flies all 16 200 environments. `progress(done, all)` is called now and then. A row per candidate goes to `csv` where
/// it is given. Deterministic; a few seconds on one core.
[[nodiscard]] CampaignResult run_campaign(const std::function<void(std::size_t, std::size_t)>& progress,
                                          std::ostream* csv = nullptr);

}  // namespace jink::host
