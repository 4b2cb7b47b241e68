// SPDX-License-Identifier: BSD-3-Clause
// The final check against dense flight in double precision (flown_densely.hpp), on manoeuvres that graze threats
// (drawn_manoeuvre.hpp).
//
// Law: the stated margin never exceeds the flight's true margin by more than stated_accuracy. So no manoeuvre reported
// clear enters the safety box by more than that.
#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/property/core/avoid/drawn_manoeuvre.hpp"

namespace jink::avoid {
namespace {

using dense::DenseFlight;
using dense::Drawn;
using dense::Flying;
using dense::kAmple;
using geometry::oracle::case_count;
using geometry::oracle::seed_of;

/// From core/avoid/final_check.hpp [m]: a flight beyond 100 m from the origin adds the rounding of each set-point's
/// position.
constexpr double kStatedAccuracy = 2e-3;
constexpr double kStatedWithin = 100.0;

double stated_accuracy(const DenseFlight& flight)
{
    const double farthest = flight.farthest();
    if (farthest <= kStatedWithin) {
        return kStatedAccuracy;
    }
    const auto coordinate = static_cast<float>(farthest);
    const double half_a_unit = 0.5 * double(std::nextafter(coordinate, 2.0F * coordinate) - coordinate);
    return kStatedAccuracy + half_a_unit * static_cast<double>(flight.commands());
}

/// The reported margin. `direction`: turn direction of a fallback; 0 for a command, stored in `d`.
float reported_of(Drawn& d, float& direction)
{
    WorkBudget budget(kAmple);
    const world::Situation situation = d.scene.situation();
    if (d.flying == Flying::held) {
        return command_margin(situation, d.manoeuvre.command, d.settings, budget);
    }
    if (d.flying == Flying::fallback_turn) {
        const Fallback fallback = choose_fallback(situation, {}, nullptr, d.settings, budget);
        const bool turns = fallback.kind == world::ManoeuvreKind::hold_turn;
        direction = turns ? fallback.command.z() : 0.0F;
        d.manoeuvre.command = fallback.command;
        return fallback.margin;
    }
    return check_manoeuvre(situation, d.manoeuvre, d.settings, budget).margin;
}

double true_margin(const Drawn& d, const DenseFlight& flight, double floor)
{
    const double shared = d.manoeuvre.kind == world::ManoeuvreKind::velocity && d.flying != Flying::held
                              ? double(time_to_stop(d.scene.situation(), d.settings))
                              : 1e9;
    double least = dense::least_of_all(d.scene, flight, shared, floor);
    for (const world::Obstacle& o : d.scene.obstacles) {
        const auto margin = [&](double t) {
            return dense::obstacle_margin_at(d.scene, o.shape, flight.at(t).position);
        };
        least = std::min(least, dense::least_margin(margin, flight.end(),
                                                    flight.fastest() + double(d.scene.rules.escape.speed),
                                                    d.scene.rules.escape, floor));
    }
    return least;
}

/// Solids other than spheres have no depth that an oracle could agree on: the escape tests of least_separation are
/// theirs.
bool starts_inside_a_solid(const Drawn& d)
{
    return std::any_of(d.scene.obstacles.begin(), d.scene.obstacles.end(), [&](const world::Obstacle& o) {
        return o.shape.kind != geometry::ShapeKind::sphere &&
               dense::obstacle_margin_at(d.scene, o.shape, d.scene.own.position.cast<double>()) <= 0.0;
    });
}

struct Counts {
    int checked = 0;
    int clear = 0;
    int above = 0;       ///< reported above the true margin
    int entered = 0;     ///< reported clear, and enters the box
    double worst = 0.0;  ///< largest excess of the report over the true margin [m]
    double deepest = 0.0;
    double below = 0.0;  ///< sum of the conservatism, over flights reported clear [m]
    /// Reported clear, by manoeuvre and by kind of vehicle.
    std::array<std::array<int, 2>, static_cast<std::size_t>(Flying::count)> clear_of{};
};

Counts compare(std::uint64_t default_seed, std::size_t cases, bool solids)
{
    const std::uint64_t seed = seed_of(default_seed);
    Random random(seed);
    Counts counts;
    for (std::size_t i = 0; i < cases; ++i) {
        Drawn d;
        if (!dense::draw(random, d, solids) || starts_inside_a_solid(d)) {
            continue;
        }
        float direction = 1.0F;
        const float reported = reported_of(d, direction);
        const DenseFlight flight = dense::fly(d, direction);
        const double accuracy = stated_accuracy(flight);
        const double floor = double(reported) - accuracy;
        ++counts.checked;
        counts.clear += reported >= 0.0F ? 1 : 0;
        counts.clear_of[static_cast<std::size_t>(d.flying)][static_cast<std::size_t>(d.scene.limits.kind)] +=
            reported >= 0.0F ? 1 : 0;
        // Margins saturate at the cap.
        const double truth = std::max(true_margin(d, flight, floor), -double(world::kSeparationCap));
        if (truth < floor) {
            counts.worst = std::max(counts.worst, double(reported) - truth);
            if (counts.above++ < 5) {
                ADD_FAILURE() << "seed " << seed << " case " << i << " of kind " << static_cast<int>(d.flying)
                              << ": told " << reported << " m, flown " << truth << " m";
            }
        } else if (reported >= 0.0F && reported < 5.0F) {
            counts.below += truth - double(reported);
        }
        if (reported >= 0.0F && truth < -accuracy) {
            ++counts.entered;
            counts.deepest = std::max(counts.deepest, -truth);
        }
    }
    std::printf(
        "[ measured ] %d manoeuvres, %d told clear, of these %d enter the box by more than %.0f mm (rounding on "
        "top beyond %.0f m), %.1f cm at most; %d told above the truth, %.3f m at most; told clear and below it by "
        "%.0f mm on average\n",
        counts.checked, counts.clear, counts.entered, 1e3 * kStatedAccuracy, kStatedWithin, 1e2 * counts.deepest,
        counts.above, counts.worst, counts.clear > 0 ? 1e3 * counts.below / counts.clear : 0.0);
    return counts;
}

TEST(FinalCheckLaws, WhatIsReportedClearStaysOutOfTheBoxWhenFlownDensely)
{
    const Counts counts = compare(20261124, case_count(4000), false);
    EXPECT_EQ(counts.entered, 0);
    EXPECT_EQ(counts.above, 0);
    EXPECT_GT(counts.clear * 4, counts.checked) << "a check that refuses all is of no use";
    for (std::size_t flying = 0; flying < counts.clear_of.size(); ++flying) {
        const auto& [multirotor, fixed_wing] = counts.clear_of[flying];
        EXPECT_GT(fixed_wing, 0) << "of kind " << flying;
        EXPECT_TRUE(multirotor > 0 || static_cast<Flying>(flying) == Flying::fallback_turn) << "of kind " << flying;
    }
}

TEST(FinalCheckLaws, SolidsAreMetAsFlownToo)
{
    const Counts counts = compare(20261125, case_count(200), true);
    EXPECT_EQ(counts.entered, 0);
    EXPECT_EQ(counts.above, 0);
    EXPECT_GT(counts.clear * 8, counts.checked);
}

}  // namespace
}  // namespace jink::avoid
