// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <istream>
#include <string>
#include <vector>

#include "toolchain/sim/vec.hpp"

// Recorded encounters of several aircraft as DAIDALUS reads them (*.daa): a line of column names, a line of units,
// which may be missing, and a row per aircraft and time. Columns are separated by blanks or commas; the rest of a line
// after
// `#` is a remark; lines NAME = VALUE before the column names are parameters, which do not count here.
//
// Columns that are read, in any case and order (nasa/daidalus, C++/src/SequenceReader.cpp):
//   name | aircraft | id;  time | tm | st, or clock as h:m:s
//   lat | latitude, lon | long | longitude, alt | altitude;  or sx, sy, sz (also x, y, z)
//   trk | track, gs | groundspeed | groundspd, vs | verticalspeed | hdot;  or vx, vy, vz
// Others are passed over, whatever their unit and their values. A unit stands in brackets or bare. A missing unit (`-`,
// unspecified, or no line of units) is DAIDALUS's: deg, ft, nmi for sx and sy, knot, fpm, s.

namespace jink::sim {

/// An aircraft at one time, in a local plane (x east, y north, z up) about where the own ship was first; metres, m/s.
/// In files with sx, sy, sz: in their frame.
struct Fix {
    double time = 0.0;
    Vec position = Vec::Zero();
    Vec velocity = Vec::Zero();
};

struct Aircraft {
    std::string name;
    std::vector<Fix> fixes;  ///< in order of time, no two at the same

    /// Linear between fixes, position and velocity. Within the time of the fixes.
    [[nodiscard]] Fix at(double t) const;
};

struct RecordedEncounter {
    std::vector<Aircraft> aircraft;  ///< own ship first, the others as they first appear
    std::size_t reordered = 0;       ///< rows that came after a later one of the same aircraft, and were put in order
};

/// @throws std::runtime_error, with file and line, on missing columns, units that are unknown or of another quantity in
/// a column that is read, rows of another number of columns, numbers that are none or not finite, latitudes beyond the
/// poles, and two fixes of an aircraft at one time; without a line on fewer than two aircraft
[[nodiscard]] RecordedEncounter read_encounter(const std::filesystem::path& file);
/// `name`: in what is thrown
[[nodiscard]] RecordedEncounter read_encounter(std::istream& in, const std::string& name);

/// Own ship and another aircraft at the same times.
struct Paired {
    struct Both {
        Fix own;
        Fix other;
    };
    std::vector<Both> fixes;       ///< at each time of an own fix
    std::size_t unmatched = 0;     ///< own fixes at whose time the other is not known
    std::size_t interpolated = 0;  ///< of `fixes`: the other has no fix of its own at that time
};

/// The other aircraft is known at the times of its fixes, and between two of them that are at most this far apart [s].
inline constexpr double kLongestFixGap = 5.0;

/// Paired by time, never by row.
[[nodiscard]] Paired pair_by_time(const Aircraft& own, const Aircraft& other);

}  // namespace jink::sim
