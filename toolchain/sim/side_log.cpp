// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/side_log.hpp"

#include <algorithm>

namespace jink::sim {
namespace {

/// Offsets from the leg smaller than this have no side [m].
constexpr double kDeadBand = 0.5;
/// Look-ahead of the commanded track [s].
constexpr double kAhead = 1.0;
/// Unit vectors with a product below this are opposite sides.
constexpr double kOpposite = -0.1;

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

void SideLog::choose(double time, unsigned takeover, const Vec& side)
{
    if (side.norm() == 0.0) {
        return;
    }
    const bool first = chosen_.empty() || chosen_.back().takeover != takeover;
    if (first || side.dot(chosen_side_) < kOpposite) {
        chosen_.push_back({time, takeover});
    }
    chosen_side_ = side;
}

SideCounts SideLog::count(const std::vector<Taken>& taken, const std::vector<double>& reported)
{
    SideCounts counts;
    unsigned same = 0;
    const auto end_conflict = [&] {
        counts.most_same = std::max(counts.most_same, same);
        counts.broken += same > 1 ? 1U : 0U;
        same = 0;
    };
    for (std::size_t i = 1; i < taken.size(); ++i) {
        if (taken[i].takeover != taken[i - 1].takeover) {
            end_conflict();
            continue;
        }
        const bool changed = std::any_of(reported.begin(), reported.end(),
                                         [&](double at) { return at > taken[i - 1].time && at <= taken[i].time; });
        (changed ? counts.changed_picture : counts.same_picture) += 1;
        same += changed ? 0U : 1U;
    }
    end_conflict();
    return counts;
}

SideCounts SideLog::counts(const std::vector<double>& reported) const
{
    SideCounts counts = count(taken_, reported);
    counts.conflicts = conflicts_;
    return counts;
}

SideCounts SideLog::chosen(const std::vector<double>& reported) const
{
    SideCounts counts = count(chosen_, reported);
    for (std::size_t i = 0; i < chosen_.size(); ++i) {
        counts.conflicts += i == 0 || chosen_[i].takeover != chosen_[i - 1].takeover ? 1U : 0U;
    }
    return counts;
}

}  // namespace jink::sim
