// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

// Pinheiro's distribution study (Pinheiro 4.2, tab. 4.1): candidates over a grid of environments, their flight times
// and energies, and the relation between the two.

namespace jink::host {

/// One figure of the study.
struct CampaignFigure {
    std::string name;
    std::string unit;
    double published = 0.0;
    double ours = 0.0;
    bool expected_to_agree = false;  ///< must be within kCampaignTolerance; the other figures belong to a set-up that
                                     ///< Pinheiro's text does not give

    [[nodiscard]] double deviation() const { return published != 0.0 ? ours / published - 1.0 : 0.0; }
};
inline constexpr double kCampaignTolerance = 0.005;

struct CampaignResult {
    std::size_t environments = 0;          ///< number of environments in the grid
    std::size_t environments_skipped = 0;  ///< main threat nearer than 2.5 R
    std::size_t candidates = 0;
    double closeness_median = 0.0;  ///< M of eq. 4.12 with an assumed velocity of the moving threat [1/m]
    std::vector<CampaignFigure> figures;
};

/// The study consists of blocks, one per main threat. Any process may fly them in any order. They are merged in block
/// order, so that sums and sorted values are bit-identical to those of one process.
inline constexpr std::size_t kStudyBlocks = 225;
inline constexpr std::size_t kStudyEnvironments = 72;  ///< per block: places and radii of the moving threat

struct StudyBlock {
    std::size_t environments_skipped = 0;
    std::vector<float> times;      ///< per candidate [s]
    std::vector<float> energies;   ///< per candidate [J]
    std::vector<float> closeness;  ///< per candidate [1/m]
    std::string rows;              ///< of the CSV file, if requested
};

/// @param index  below kStudyBlocks
[[nodiscard]] StudyBlock fly_study_block(std::size_t index, bool with_rows);

/// A block as bytes, for another process of the same build; 12 bytes per candidate, and the rows.
[[nodiscard]] std::string packed(std::size_t index, const StudyBlock& block);
/// Stores a packed block at its index. @throws std::runtime_error, std::out_of_range for invalid bytes
void unpack(std::string_view bytes, std::vector<StudyBlock>& blocks);

/// @param blocks  all of them, in order
[[nodiscard]] CampaignResult merge_study(const std::vector<StudyBlock>& blocks);
void write_rows(std::ostream& csv, const std::vector<StudyBlock>& blocks);

/// Flies all blocks in sequence. `progress(done, all)` is called before each with the environments flown.
[[nodiscard]] std::vector<StudyBlock> fly_study(const std::function<void(std::size_t, std::size_t)>& progress,
                                                bool with_rows);

/// Flies all 16 200 environments. Deterministic; a few seconds on one core.
[[nodiscard]] CampaignResult run_campaign(const std::function<void(std::size_t, std::size_t)>& progress);

}  // namespace jink::host
