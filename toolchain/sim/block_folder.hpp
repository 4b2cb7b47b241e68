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

/// A folder of results in blocks, so that work can be distributed and resumed:
///
/// * manifest.txt describes the folder's set-up, line by line.
/// * block_000000.txt and so on: one file per finished block. Each file is written under another name (`.part`) and
///   then renamed: a killed program leaves a whole block or none. The last line holds the number of lines and a
///   checksum (FNV-1a, 64 bits).
///
/// Only finished blocks count. Other block files (`.part`, damaged) are rewritten.
class BlockFolder {
public:
    explicit BlockFolder(std::filesystem::path folder);
    BlockFolder(const BlockFolder&) = delete;
    BlockFolder& operator=(const BlockFolder&) = delete;
    ~BlockFolder();

    /// Creates the folder if missing and locks it for this set-up. The lock ends with this object or with the program.
    /// @throws BadFolder when the folder belongs to another set-up, holds other files, is locked, or cannot be written
    void claim(const std::string& manifest);

    /// The text of manifest.txt. @throws BadFolder
    [[nodiscard]] std::string manifest() const;

    /// Indices of unfinished blocks in 0..count-1, ascending.
    [[nodiscard]] std::vector<std::size_t> missing(std::size_t count) const;
    /// The text passed to write(); nothing when the block is unfinished.
    [[nodiscard]] std::optional<std::string> read(std::size_t index) const;
    /// @param text  lines, each with its end. @throws BadFolder
    void write(std::size_t index, const std::string& text) const;

    /// Writes any other file of the folder atomically. @throws BadFolder
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
