// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <memory>

#include "core/reach/vehicle_sets.hpp"
#include "toolchain/reach/generators.hpp"
#include "toolchain/reach/set.hpp"
#include "toolchain/reach/stored_set.hpp"

namespace jink::reach::test {

/// Gomola's sets, with 15 degrees per movement, for a vehicle of 5 m/s: combined 8/3/1 and harmonic 1. The level root
/// represents all of them.
class UnitSets {
public:
    UnitSets()
    {
        const build::Settings settings;
        const build::Set smooth =
            build::kept(build::grow(settings, build::harmonic(settings, 1)), build::kFromHarmonic);
        const build::Set wide = build::kept(build::grow(settings, build::chaotic(settings, 8, 3)), build::kFromChaotic);
        navigation_ = std::make_unique<build::StoredSet>("harmonic 1", settings, smooth, build::CostRule{});
        build::CostRule by_smoothness;
        by_smoothness.by_smoothness = true;
        emergency_ =
            std::make_unique<build::StoredSet>("combined 8/3/1", settings, build::merged(wide, smooth), by_smoothness);
        views_ = {navigation_->view(), emergency_->view()};
        pairs_.fill({&views_[0], &views_[1], false});
        sets_.vehicle = "unit";
        sets_.period = 0.5F;
        sets_.max_acceleration = 5.0F;
        sets_.max_vertical_acceleration = 3.0F;
        sets_.max_climb = 5.0F;
        sets_.max_descent = 5.0F;
        sets_.cruise_speed = 5.0F;
        sets_.speeds = speeds_;
        sets_.most_speed = 2.0F;
        sets_.pitch_separators = separators_;
        sets_.most_pitch = most_;
        sets_.segments = pairs_;
    }

    [[nodiscard]] const VehicleSets& get() const { return sets_; }

private:
    std::unique_ptr<build::StoredSet> navigation_;
    std::unique_ptr<build::StoredSet> emergency_;
    std::array<ReachSet, 2> views_;
    std::array<SegmentSets, kPitchSegments> pairs_{};
    std::array<float, 1> speeds_{0.3F};
    std::array<std::array<float, 2>, 1> separators_{{{-0.13F, 0.13F}}};
    std::array<float, 1> most_{0.8F};
    VehicleSets sets_;
};

inline const VehicleSets& unit_sets()
{
    static const UnitSets sets;
    return sets.get();
}

}  // namespace jink::reach::test
