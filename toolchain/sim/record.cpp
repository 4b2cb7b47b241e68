// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/record.hpp"

#include <algorithm>

namespace jink::sim {
namespace {

/// Offsets from the leg smaller than this have no side [m].
constexpr double kDeadBand = 0.5;
/// Look-ahead of the commanded track [s].
constexpr double kAhead = 1.0;

}  // namespace

FlipCounter::FlipCounter(const std::vector<Vec>& mission)
    : start_(mission[0]), forward_((mission[1] - mission[0]).normalized())
{
}

void FlipCounter::note(const Vec& position, const Vec& command)
{
    const Vec ahead = position + command * kAhead - start_;
    const Vec off = ahead - forward_ * ahead.dot(forward_);
    if (side_.norm() == 0.0) {
        side_ = off.norm() > kDeadBand ? Vec(off.normalized()) : side_;
        return;
    }
    if (off.dot(side_) < -kDeadBand) {
        ++flips_;
        side_ = off.normalized();
    }
}

std::vector<std::string> unmet(const Scenario& scenario, const Record& record)
{
    std::vector<std::string> missing;
    const Expectation& expect = scenario.expect;
    if (std::find(expect.outcomes.begin(), expect.outcomes.end(), record.outcome) == expect.outcomes.end()) {
        std::string wanted;
        for (const Outcome outcome : expect.outcomes) {
            wanted += (wanted.empty() ? "" : " or ") + std::string(to_string(outcome));
        }
        missing.push_back("outcome is " + std::string(to_string(record.outcome)) + ", not " + wanted);
    }
    if (expect.given_back && *expect.given_back != record.given_back) {
        missing.push_back(record.given_back ? "the mission was given back" : "the mission was not given back");
    }
    if (expect.final_mode && *expect.final_mode != record.final_mode) {
        missing.push_back("it ends in mode " + std::string(to_string(record.final_mode)) + ", not " +
                          std::string(to_string(*expect.final_mode)));
    }
    if (expect.goal_reached && *expect.goal_reached != (record.goal_at >= 0.0)) {
        missing.push_back(record.goal_at >= 0.0 ? "the goal was reached" : "the goal was not reached");
    }
    if (expect.flips_at_most && record.flips > *expect.flips_at_most) {
        missing.push_back(std::to_string(record.flips) + " changes of side, " + std::to_string(*expect.flips_at_most) +
                          " allowed");
    }
    return missing;
}

}  // namespace jink::sim
