// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "toolchain/sim/block_folder.hpp"
#include "toolchain/sim/encounter.hpp"

// Many encounters, flown block by block into a folder (block_folder.hpp), by threads, processes or machines that share
// the folder. What is written does not depend on who flew what, nor on how often the run was broken off.

namespace jink::sim {

/// What a folder holds; the manifest in other words.
struct EncounterSetup {
    Variant variant;
    std::vector<std::uint64_t> seeds;
    std::string seeds_text;  ///< how the manifest names them
    std::size_t block = 100;

    [[nodiscard]] std::size_t blocks() const { return (seeds.size() + block - 1) / block; }
    /// Lines "key value". Among them the digest of the sources that were built: results of another program do not mix.
    [[nodiscard]] std::string manifest() const;
};

/// " NAME=VALUE" for each of a variant's parameters, in the order of their names.
[[nodiscard]] std::string parameters_text(const Variant& variant);
/// @throws std::runtime_error  when it is not NAME=VALUE with a finite value
[[nodiscard]] std::pair<std::string, double> parse_parameter(const std::string& text);

/// `count` seeds from `from` on.
[[nodiscard]] EncounterSetup consecutive_setup(std::uint64_t from, std::size_t count);
/// Those listed in a file, one to a line; what follows '#' is passed over.
/// @throws std::runtime_error  naming the line that is no seed, or the seed that comes twice
[[nodiscard]] EncounterSetup listed_setup(const std::filesystem::path& file);

/// What can be told of a folder by its manifest alone.
struct FolderSetup {
    Variant variant;
    std::size_t count = 0;
    std::size_t block = 1;
    std::string seeds_text;
    bool same_sources = false;  ///< as this program's
};
/// @throws BadFolder when it is no folder of encounters
[[nodiscard]] FolderSetup read_setup(const BlockFolder& folder);

/// Flies blocks until there are no more to be had.
///
/// @param next   index of the next block that nobody has begun, for one asker alone; nothing when there are no more
/// @param pause  called between flights
void fly_blocks(const BlockFolder& folder, const EncounterSetup& setup,
                const std::function<std::optional<std::size_t>()>& next, const std::function<void()>& pause);

/// The same by `threads` threads of this process, who take the blocks that are missing in order.
/// @param done  called after each block with how many have been flown, by one thread at a time
void fly_missing(const BlockFolder& folder, const EncounterSetup& setup, unsigned threads,
                 const std::function<void(std::size_t done, std::size_t all)>& done);

/// All results of a folder in the order of their blocks. @throws BadFolder when blocks are missing or not of this kind
[[nodiscard]] std::vector<EncounterResult> read_results(const BlockFolder& folder, const FolderSetup& setup);

/// Writes summary.txt and, in worst/, the ten worst encounters as scenario files that are expected to end as they did;
/// the latter only where this program's sources are those that flew. Returns the summary.
/// @throws BadFolder
std::string summarise(const BlockFolder& folder, const FolderSetup& setup, const std::vector<EncounterResult>& results);

/// The broken promises which the judge says were avoidable.
[[nodiscard]] std::size_t count_avoidable(const std::vector<EncounterResult>& results);

}  // namespace jink::sim
