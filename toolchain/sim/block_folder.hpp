// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace jink::sim {

/// A folder that cannot be used; what() says why.
class BadFolder : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// A folder of results that come in blocks, so that work can be shared out and taken up again:
///
/// * manifest.txt says what set-up the folder belongs to, line by line.
/// * block_000000.txt and so on: one file per finished block. It is written under another name (`.part`) and then
///   renamed, so that a block is there as a whole or not at all, whenever the program is killed; its last line seals
///   it with the number of lines and a checksum (FNV-1a, 64 bits).
///
/// Only finished blocks count: what else lies there (`.part`, damaged files) is written anew.
class BlockFolder {
public:
    explicit BlockFolder(std::filesystem::path folder);
    BlockFolder(const BlockFolder&) = delete;
    BlockFolder& operator=(const BlockFolder&) = delete;
    ~BlockFolder();

    /// Makes the folder when it is not there, and takes it for this set-up until this object goes or the program ends,
    /// however it ends.
    /// @throws BadFolder when it belongs to another set-up, holds something else, is being used, or cannot be written
    void claim(const std::string& manifest);

    /// The text of manifest.txt. @throws BadFolder
    [[nodiscard]] std::string manifest() const;

    /// Those of 0..count-1 that are not finished, in order.
    [[nodiscard]] std::vector<std::size_t> missing(std::size_t count) const;
    /// What write() was given; nothing when the block is not finished.
    [[nodiscard]] std::optional<std::string> read(std::size_t index) const;
    /// @param text  lines, each with its end. @throws BadFolder
    void write(std::size_t index, const std::string& text) const;

    /// Any other file of the folder, as a whole or not at all. @throws BadFolder
    void write_file(const std::string& name, const std::string& text) const;

    [[nodiscard]] const std::filesystem::path& path() const noexcept { return folder_; }

private:
    [[nodiscard]] std::filesystem::path block(std::size_t index) const;

    std::filesystem::path folder_;
    int lock_ = -1;
};

/// FNV-1a, 64 bits.
[[nodiscard]] std::uint64_t checksum(const std::string& text) noexcept;

}  // namespace jink::sim
