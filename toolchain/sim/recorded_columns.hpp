// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "toolchain/sim/vec.hpp"

// Columns of recorded encounters and their units (recorded_encounter.hpp). Private to the reader.

namespace jink::sim {

/// Separated by blanks or commas.
[[nodiscard]] std::vector<std::string> words_of(std::string line);
/// Where that word begins in the line, or the line ends where it has no such word: from 1.
[[nodiscard]] std::size_t column_of(const std::string& line, std::size_t word);

/// What is wrong with a word of a line.
struct BadWord : std::runtime_error {
    BadWord(std::size_t at, const std::string& text) : std::runtime_error(text), word(at) {}
    std::size_t word;  ///< from 0; the number of words: there are too few
};

/// Contents of a row, in SI units except for the angles of a global place.
struct RecordedRow {
    std::string name;
    double time = 0.0;           ///< [s]
    Vec place = Vec::Zero();     ///< latitude, longitude [deg] and altitude [m], or a local position [m]
    Vec velocity = Vec::Zero();  ///< east, north, up [m/s]
};

/// Positions and unit factors of the columns that are read.
class RecordedColumns {
public:
    /// @throws BadWord when a column is missing
    explicit RecordedColumns(const std::vector<std::string>& names);

    /// False where the words are the first row instead of units. @throws BadWord
    [[nodiscard]] bool take_units(const std::vector<std::string>& words);
    /// @throws BadWord
    [[nodiscard]] RecordedRow row(const std::vector<std::string>& words) const;
    [[nodiscard]] bool global() const noexcept { return global_; }

private:
    struct Column {
        std::size_t index = 0;
        char quantity = '-';  ///< l: length, a: angle, v: speed, t: time
        double factor = 1.0;
    };
    [[nodiscard]] double value(const Column& column, const std::vector<std::string>& words) const;

    std::vector<std::string> names_;
    std::size_t name_ = 0;
    Column time_;
    bool clock_ = false;
    bool global_ = false;
    bool polar_ = false;  ///< track and ground speed
    std::array<Column, 3> place_;
    std::array<Column, 3> velocity_;
};

}  // namespace jink::sim
