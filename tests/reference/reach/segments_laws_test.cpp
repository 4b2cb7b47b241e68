// SPDX-License-Identifier: BSD-3-Clause
// Segments partition the states: each state is in exactly one, by a check of its intervals in sequence.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "core/base/random.hpp"
#include "tests/reference/reach/segments.hpp"

namespace jink::reach {
namespace {

struct Axis {
    Impact impact;
    std::vector<float> walls;  // bounds and separators
    [[nodiscard]] std::size_t intervals() const { return walls.size() - 1; }
    /// [a, b), the last one [a, b].
    [[nodiscard]] bool holds(std::size_t i, float value) const
    {
        return value >= walls[i] && (value < walls[i + 1] || (i + 1 == intervals() && value == walls[i + 1]));
    }
};

float& field(Condition& condition, Impact impact)
{
    switch (impact) {
    case Impact::speed: return condition.speed;
    case Impact::pitch: return condition.pitch;
    case Impact::altitude: return condition.altitude;
    case Impact::payload: break;
    }
    return condition.payload;
}

TEST(SegmentLaws, EveryStateIsInExactlyOne)
{
    constexpr std::uint64_t kSeed = 20261123;
    Random random(kSeed);
    int states = 0;
    for (int i = 0; i < 500; ++i) {
        Segments segments;
        std::vector<Axis> axes;
        for (const Impact impact : {Impact::speed, Impact::pitch, Impact::altitude, Impact::payload}) {
            Axis axis{impact, {}};
            for (std::size_t n = 2 + random.below(4); n > 0; --n) {
                axis.walls.push_back(random.uniform(-10.0F, 10.0F));
            }
            std::ranges::sort(axis.walls);
            const std::vector<float> separators(axis.walls.begin() + 1, axis.walls.end() - 1);
            if (segments.split(impact, axis.walls.front(), axis.walls.back(), separators) == SegmentStatus::good) {
                axes.push_back(axis);
            }
        }
        std::size_t product = 1;
        for (const Axis& axis : axes) {
            product *= axis.intervals();
        }
        ASSERT_EQ(segments.count(), product) << "seed " << kSeed << ", case " << i;
        for (int k = 0; k < 200; ++k) {
            Condition condition;
            for (const Axis& axis : axes) {
                // Often on a wall.
                field(condition, axis.impact) = random.below(3) == 0
                                                    ? axis.walls[random.below(axis.walls.size())]
                                                    : random.uniform(axis.walls.front(), axis.walls.back());
            }
            int found = 0;
            for (std::size_t segment = 0; segment < product; ++segment) {
                std::size_t rest = segment;
                bool holds = true;
                for (std::size_t a = axes.size(); a-- > 0;) {
                    holds = holds && axes[a].holds(rest % axes[a].intervals(), field(condition, axes[a].impact));
                    rest /= axes[a].intervals();
                }
                if (holds) {
                    ++found;
                    ASSERT_EQ(segments.at(condition).segment, segment) << "seed " << kSeed << ", case " << i;
                }
            }
            ASSERT_EQ(found, 1) << "seed " << kSeed << ", case " << i;
            ASSERT_FALSE(segments.at(condition).outside);
            ++states;
        }
    }
    EXPECT_EQ(states, 100000);
}

}  // namespace
}  // namespace jink::reach
