// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <istream>
#include <string>
#include <vector>

#include "toolchain/sim/vec.hpp"

// Recorded encounters of several aircraft in the format of DAIDALUS (*.daa): a line of column names, an optional line
// of units, and a row per aircraft and time. Columns are separated by blanks or commas; the rest of a line after `#` is
// a remark; lines NAME = VALUE before the column names are parameters, ignored here.
//
// Columns that are read, in any case and order (nasa/daidalus, C++/src/SequenceReader.cpp):
//   name | aircraft | id;  time | tm | st, or clock as h:m:s
//   lat | latitude, lon | long | longitude, alt | altitude;  or sx, sy, sz (also x, y, z)
//   trk | track, gs | groundspeed | groundspd, vs | verticalspeed | hdot;  or vx, vy, vz
// Other columns are ignored, with any unit and values. A unit may be in brackets or bare. A missing unit (`-`,
// unspecified, or no line of units) is DAIDALUS's default: deg, ft, nmi for sx and sy, knot, fpm, s.

namespace jink::sim {

/// An aircraft at one time, in a local plane (x east, y north, z up) about the own ship's first position; metres, m/s.
/// In files with sx, sy, sz: in their frame.
struct Fix {
    double time = 0.0;
    Vec position = Vec::Zero();
    Vec velocity = Vec::Zero();
};

struct Aircraft {
    std::string name;
    std::vector<Fix> fixes;  ///< in strictly increasing time

    /// Linear between fixes, position and velocity. Within the time of the fixes.
    [[nodiscard]] Fix at(double t) const;
};

struct RecordedEncounter {
    std::vector<Aircraft> aircraft;  ///< own ship first, the others in order of first appearance
    std::size_t reordered = 0;       ///< rows after a later row of the same aircraft; sorted by time
};

/// @throws std::runtime_error, with file and line, on: missing columns; unknown units, or units of another quantity, in
/// a column that is read; rows with another number of columns; malformed or non-finite numbers; latitudes beyond the
/// poles; two fixes of an aircraft at one time. Without a line on: fewer than two aircraft
[[nodiscard]] RecordedEncounter read_encounter(const std::filesystem::path& file);
/// `name`: used in exceptions
[[nodiscard]] RecordedEncounter read_encounter(std::istream& in, const std::string& name);

/// Own ship and another aircraft at the same times.
struct Paired {
    struct Both {
        Fix own;
        Fix other;
    };
    std::vector<Both> fixes;       ///< one per time of an own fix
    std::size_t unmatched = 0;     ///< own fixes without a known position of the other aircraft
    std::size_t interpolated = 0;  ///< of `fixes`: the other aircraft's position is interpolated
};

/// The other aircraft's position is known at its fixes, and between two fixes at most this far apart [s].
inline constexpr double kLongestFixGap = 5.0;

/// Paired by time, never by row.
[[nodiscard]] Paired pair_by_time(const Aircraft& own, const Aircraft& other);

}  // namespace jink::sim
