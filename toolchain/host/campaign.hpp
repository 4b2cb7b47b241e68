// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>
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

/// The study comes in blocks, one to a main threat: they can be flown by anybody in any order, and are merged in their
/// own, so that sums and sorted values are those of one process, bit by bit.
inline constexpr std::size_t kStudyBlocks = 225;
inline constexpr std::size_t kStudyEnvironments = 72;  ///< in each: places and radii of the moving threat

struct StudyBlock {
    std::size_t environments_skipped = 0;
    std::vector<float> times;      ///< of each candidate [s]
    std::vector<float> energies;   ///< the same [J]
    std::vector<float> closeness;  ///< the same [1/m]
    std::string rows;              ///< of the CSV file, where they were asked for
};

/// @param index  below kStudyBlocks
[[nodiscard]] StudyBlock fly_study_block(std::size_t index, bool with_rows);

/// A block as bytes, for another process of the same build; 12 bytes to a candidate, and the rows.
[[nodiscard]] std::string packed(std::size_t index, const StudyBlock& block);
/// Puts a packed block in its place. @throws std::runtime_error, std::out_of_range when it is none
void unpack(std::string_view bytes, std::vector<StudyBlock>& blocks);

/// @param blocks  all of them, in order
[[nodiscard]] CampaignResult merge_study(const std::vector<StudyBlock>& blocks);
void write_rows(std::ostream& csv, const std::vector<StudyBlock>& blocks);

/// All blocks, one after the other. `progress(done, all)` is called before each with the environments flown.
[[nodiscard]] std::vector<StudyBlock> fly_study(const std::function<void(std::size_t, std::size_t)>& progress,
                                                bool with_rows);

/// Flies all 16 200 environments. Deterministic; a few seconds on one core.
[[nodiscard]] CampaignResult run_campaign(const std::function<void(std::size_t, std::size_t)>& progress);

}  // namespace jink::host
