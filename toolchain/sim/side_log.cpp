// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/side_log.hpp"

#include <algorithm>

namespace jink::sim {
namespace {

/// Offsets from the leg smaller than this have no side [m].
constexpr double kDeadBand = 0.5;
/// How far ahead the commanded track is looked at [s].
constexpr double kAhead = 1.0;

}  // namespace

SideLog::SideLog(const std::vector<Vec>& mission) : start_(mission[0]), forward_((mission[1] - mission[0]).normalized())
{
}

void SideLog::note(double time, unsigned takeover, const Vec& position, const Vec& command)
{
    if (takeover != takeover_) {
        takeover_ = takeover;
        ++conflicts_;
        side_ = Vec::Zero();
    }
    const Vec ahead = position + command * kAhead - start_;
    const Vec off = ahead - forward_ * ahead.dot(forward_);
    const bool none_yet = side_.norm() == 0.0;
    if (none_yet ? off.norm() > kDeadBand : off.dot(side_) < -kDeadBand) {
        side_ = off.normalized();
        taken_.push_back({time, takeover});
    }
}

SideCounts SideLog::counts(const std::vector<double>& told) const
{
    SideCounts counts;
    counts.conflicts = conflicts_;
    unsigned same = 0;
    const auto end_conflict = [&] {
        counts.most_same = std::max(counts.most_same, same);
        counts.broken += same > 1 ? 1U : 0U;
        same = 0;
    };
    for (std::size_t i = 1; i < taken_.size(); ++i) {
        if (taken_[i].takeover != taken_[i - 1].takeover) {
            end_conflict();
            continue;
        }
        const bool changed = std::any_of(told.begin(), told.end(),
                                         [&](double at) { return at > taken_[i - 1].time && at <= taken_[i].time; });
        (changed ? counts.changed_picture : counts.same_picture) += 1;
        same += changed ? 0U : 1U;
    }
    end_conflict();
    return counts;
}

}  // namespace jink::sim
