// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "toolchain/sim/vec.hpp"

namespace jink::sim {

/// Side changes of a flight, per conflict. Definitions:
///
/// * A conflict is one interval of control, from the take-over of the velocity by the co-processor to the return. Each
///   conflict begins without a side. (FlipCounter, in record.hpp, keeps the side between conflicts.)
/// * The chosen side is the planner's side of a manoeuvre when it is chosen: across the leg. The chosen side changes
///   with a manoeuvre whose side opposes the side before, independent of the flight in between: product of the unit
///   vectors below -0.1, so that planes at right angles do not count. Manoeuvres along the leg have no side. Known for
///   flights in process only.
/// * The flown side is the side of the vehicle's position one second ahead under the present command, seen along the
///   first leg. The side is taken once this position is more than 0.5 m off the leg. The side changes once the position
///   is more than 0.5 m off on the opposite side (negative component along the last side).
/// * The picture (the set of known threats) changes when a threat becomes known: the first message that reports the
///   threat left the autopilot's end of the line (dropped sightings do not count). A side change counts as "changed
///   picture" if a threat became known after the last side was taken, up to the change itself; otherwise as "same
///   picture". A known threat that only later comes into conflict does not change the picture.
///
/// The promise: the chosen side changes at most once per conflict unless the picture changes. Each conflict with two or
/// more changes with the same picture breaks the promise. The flown side is counted in the same way but is stricter
/// than the promise: it also changes when the vehicle rejoins the leg steeply, and when the vehicle brakes and turns
/// away without a candidate.
struct SideCounts {
    unsigned conflicts = 0;        ///< intervals of control
    unsigned same_picture = 0;     ///< side changes with the same picture, all conflicts
    unsigned changed_picture = 0;  ///< side changes with a changed picture, all conflicts
    unsigned most_same = 0;        ///< largest number of changes with the same picture in one conflict
    unsigned broken = 0;           ///< conflicts that break the promise
};

class SideLog {
public:
    explicit SideLog(const std::vector<Vec>& mission);

    /// A step under control. @param takeover  number of the interval, counted from 1
    void note(double time, unsigned takeover, const Vec& position, const Vec& command);

    /// A manoeuvre is chosen under control. @param side  of the manoeuvre, 0: none
    void choose(double time, unsigned takeover, const Vec& side);

    /// Counts of the flown side. @param reported  time at which each threat became known [s]; negative: never.
    /// O(changes * threats).
    [[nodiscard]] SideCounts counts(const std::vector<double>& reported) const;
    /// Counts of the chosen side; `conflicts`: intervals with a chosen side.
    [[nodiscard]] SideCounts chosen(const std::vector<double>& reported) const;

private:
    /// A side that was taken, the first of its interval or a change.
    struct Taken {
        double time = 0.0;
        unsigned takeover = 0;
    };

    [[nodiscard]] static SideCounts count(const std::vector<Taken>& taken, const std::vector<double>& reported);

    Vec start_;
    Vec forward_;
    Vec side_ = Vec::Zero();
    unsigned takeover_ = 0;
    unsigned conflicts_ = 0;
    std::vector<Taken> taken_;
    std::vector<Taken> chosen_;
    Vec chosen_side_ = Vec::Zero();
};

}  // namespace jink::sim
