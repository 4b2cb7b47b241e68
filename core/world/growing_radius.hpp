// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "core/world/world.hpp"

namespace jink::world {

/// `threat_radius` of one track at many instants: what does not depend on the instant is computed once. Equal to it but
/// for rounding (1e-5 of the radius). O(1) per instant.
class GrowingRadius {
public:
    GrowingRadius(const Situation& situation, const Track& track) noexcept
        : growth_(growth_of(situation, track, 0.0F)), begins_(std::max(track.stamp - situation.now, 0.0F))
    {
    }
    /// @param t  after Situation::now [s]
    [[nodiscard]] float operator()(Seconds t) const noexcept { return growth_.at(std::max(t - begins_, 0.0F)); }

private:
    Growth growth_;
    Seconds begins_;  ///< a stamp ahead of now: grows from there on
};

}  // namespace jink::world
