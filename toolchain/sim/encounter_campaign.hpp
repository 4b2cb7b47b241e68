// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "toolchain/sim/block_folder.hpp"
#include "toolchain/sim/encounter.hpp"

// Many encounters, flown block by block into a folder (block_folder.hpp) by threads, processes or machines that share
// the folder. The results do not depend on the distribution of the work or on interruptions.

namespace jink::sim {

/// A folder's set-up, as written in the manifest.
struct EncounterSetup {
    Variant variant;
    std::vector<std::uint64_t> seeds;
    std::string seeds_text;  ///< the seeds as the manifest names them
    std::size_t block = 100;

    [[nodiscard]] std::size_t blocks() const { return (seeds.size() + block - 1) / block; }
    /// Lines "key value". They include the digest of the built sources, so that results of different programs do not
    /// mix.
    [[nodiscard]] std::string manifest() const;
};

/// " NAME=VALUE" for each of a variant's parameters, in the order of their names.
[[nodiscard]] std::string parameters_text(const Variant& variant);
/// Values by name of texts NAME=VALUE; the last one of a name counts.
/// @throws std::runtime_error when a text is not NAME=VALUE with a finite value
[[nodiscard]] std::map<std::string, double> parse_parameters(const std::vector<std::string>& texts);

/// `count` seeds from `from` on.
[[nodiscard]] EncounterSetup consecutive_setup(std::uint64_t from, std::size_t count);
/// Seeds listed in a file, one per line; text after '#' is ignored.
/// @throws std::runtime_error naming the line without a valid seed, or the repeated seed
[[nodiscard]] EncounterSetup listed_setup(const std::filesystem::path& file);

/// A folder's set-up as read from its manifest.
struct FolderSetup {
    Variant variant;
    std::size_t count = 0;
    std::size_t block = 1;
    std::string seeds_text;
    bool same_sources = false;  ///< equal to this program's sources
};
/// @throws BadFolder when the folder does not hold encounters
[[nodiscard]] FolderSetup read_setup(const BlockFolder& folder);

/// Flies blocks until `next` returns nothing.
///
/// @param next   index of the next unstarted block, handed out once; nothing when none is left
/// @param pause  called between flights
void fly_blocks(const BlockFolder& folder, const EncounterSetup& setup,
                const std::function<std::optional<std::size_t>()>& next, const std::function<void()>& pause);

/// Flies the missing blocks in order with `threads` threads of this process; 0: one to a core.
/// @param done  called after each block with the number of flown blocks, by one thread at a time
void fly_missing(const BlockFolder& folder, const EncounterSetup& setup, unsigned threads,
                 const std::function<void(std::size_t done, std::size_t all)>& done);

/// All results of a folder in the order of their blocks. @throws BadFolder when blocks are missing or not of this kind
[[nodiscard]] std::vector<EncounterResult> read_results(const BlockFolder& folder, const FolderSetup& setup);

/// Writes summary.txt and, in worst/, the ten worst encounters as scenario files that expect the same ending. The files
/// in worst/ are written only if this program's sources are those that flew. Returns the summary.
/// @throws BadFolder
std::string summarise(const BlockFolder& folder, const FolderSetup& setup, const std::vector<EncounterResult>& results);

/// Number of broken promises that the judge calls avoidable.
[[nodiscard]] std::size_t count_avoidable(const std::vector<EncounterResult>& results);

}  // namespace jink::sim
