// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "toolchain/sim/vec.hpp"

namespace jink::sim {

/// Changes of side of a flight, conflict by conflict. The terms are defined here, and counted as they are:
///
/// * A conflict is one stretch of control: from where the autopilot gives the velocity to the co-processor until it
///   takes it back. Each begins without a side. (FlipCounter, in record.hpp, carries the side from one to the next.)
/// * The side that is chosen is that of a manoeuvre when it is taken, as the planner names it: across the leg. It
///   changes with a manoeuvre whose side points away from the one before, whatever was flown in between: product of the
///   unit vectors below -0.1, so that planes at right angles are no change. Manoeuvres along the leg have none. Known
///   of flights in process alone.
/// * The side that is flown is where the vehicle will be one second on under the command in force, seen along the first
///   leg: taken once that lies more than 0.5 m off the leg, changed once it lies more than 0.5 m off on the opposite
///   side (negative component along the side taken last).
/// * The picture has changed when a threat became known for the first time: the first message that tells of it left the
///   autopilot's end of the line (dropped sightings tell nobody). A change of side counts as with a changed picture
///   when that happened after the side before was taken, up to the change itself, and otherwise as with the same
///   picture. A threat that was known but only then came into the way is the same picture.
///
/// The promise: the side that is chosen changes at most once per conflict unless the picture changed. It is broken by
/// each conflict with two or more changes with the same picture. The side that is flown is counted in the same way and
/// says more than the promise: it changes also where the leg is rejoined steeply, and where the vehicle brakes and
/// turns away because nothing is left to choose.
struct SideCounts {
    unsigned conflicts = 0;        ///< stretches of control
    unsigned same_picture = 0;     ///< changes of side, all conflicts
    unsigned changed_picture = 0;  ///< the same
    unsigned most_same = 0;        ///< changes with the same picture in one conflict, the most
    unsigned broken = 0;           ///< conflicts that break the promise
};

class SideLog {
public:
    explicit SideLog(const std::vector<Vec>& mission);

    /// A step under control. @param takeover  number of the stretch, counted from 1
    void note(double time, unsigned takeover, const Vec& position, const Vec& command);

    /// A manoeuvre is taken, in control. @param side  of it, 0: none
    void choose(double time, unsigned takeover, const Vec& side);

    /// Of the side that is flown. @param told  when each threat became known [s]; negative: never. O(changes *
    /// threats).
    [[nodiscard]] SideCounts counts(const std::vector<double>& told) const;
    /// Of the side that is chosen; `conflicts` are the stretches in which one was.
    [[nodiscard]] SideCounts chosen(const std::vector<double>& told) const;

private:
    /// A side was taken, the first one of its stretch or another one.
    struct Taken {
        double time = 0.0;
        unsigned takeover = 0;
    };

    [[nodiscard]] static SideCounts count(const std::vector<Taken>& taken, const std::vector<double>& told);

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
