// SPDX-License-Identifier: BSD-3-Clause
// Meetings with intruders on sets that are flown: each trajectory flown densely, in double, from the root (avoidance
// specification, sections 2.1 and 2.9).
#include "core/reach/meeting.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/base/random.hpp"
#include "core/reach/predictor.hpp"
#include "toolchain/reach/generators.hpp"
#include "toolchain/reach/stored_set.hpp"

namespace jink::reach::build {
namespace {

/// A set, and the exact pose of each of its nodes.
struct Flown {
    Settings settings;
    StoredSet stored;
    ReachSet set = stored.view();
    std::vector<Pose<double>> poses;

    Flown() : Flown(Settings{}) {}
    explicit Flown(const Settings& s)
        : settings(s), stored("chaotic", s, kept(grow(s, chaotic(s, 9, 3)), kFromChaotic), CostRule{})
    {
        for (std::size_t i = 0; i < set.nodes(); ++i) {
            poses.push_back(i == 0 ? root(s)
                                   : apply(poses[set.parent[i]], static_cast<Movement>(set.movement[i]), s.step));
        }
    }
    [[nodiscard]] static Pose<double> root(const Settings& s)
    {
        Pose<double> pose;
        pose.pitch = s.root_pitch * s.step.pitch;
        return pose;
    }
    /// At a share of the movement of a node.
    [[nodiscard]] Point<double> at(std::size_t node, double share) const
    {
        return at_share(poses[set.parent[node]], static_cast<Movement>(set.movement[node]), share, settings.step)
            .position;
    }
    [[nodiscard]] double time(std::size_t node, double share) const { return set.depth[node] - 1 + share; }
};

/// Samples of a movement.
constexpr int kDense = 64;

/// Every dense sample lies within the hull of its cell, unless the movement clips the cell between two samples of the
/// set's own, which the safety margin is there for.
void every_sample_is_in_its_cells_times(const Flown& flown)
{
    constexpr float kPeriod = 0.5F;
    std::vector<Stay> times(flown.set.grid.cells());
    cell_times(flown.set, kPeriod, times);
    std::size_t samples = 0;
    std::size_t clipped = 0;
    std::vector<bool> passed(flown.set.grid.cells(), false);
    for (std::size_t node = 1; node < flown.set.nodes(); ++node) {
        for (int k = 1; k <= kDense; ++k) {
            const double share = static_cast<double>(k) / kDense;
            const Located in = flown.settings.grid.locate(flown.at(node, share));
            if (in.status != LocateStatus::inside) {
                continue;
            }
            const CellIndex cell = flown.set.grid.index(in.place);
            const double t = static_cast<double>(kPeriod) * flown.time(node, share);
            passed[cell] = true;
            ++samples;
            clipped +=
                t < static_cast<double>(times[cell].from) - 1e-3 || t > static_cast<double>(times[cell].to) + 1e-3 ? 1U
                                                                                                                   : 0U;
        }
    }
    EXPECT_GT(samples, 100000U);
    EXPECT_LE(clipped, samples / 2000) << samples << " samples";
    ::testing::Test::RecordProperty("clipped_per_million", static_cast<int>(1000000 * clipped / samples));
    // And nothing is named that nobody passes.
    for (std::size_t cell = 0; cell < times.size(); ++cell) {
        EXPECT_TRUE(is_never(times[cell]) || passed[cell]) << cell;
    }
}

TEST(Meetings, CellTimesHoldEveryTrajectory)
{
    every_sample_is_in_its_cells_times(Flown());
    Settings nose_down;
    nose_down.root_pitch = 1;
    every_sample_is_in_its_cells_times(Flown(nose_down));
}

/// The tables' entries alone name a cell for the movement that enters it: later ones that are still in it are why
/// `stay_of` flies them again.
TEST(Meetings, MovementsStayInCellsThatTheirParentsEntered)
{
    const Flown flown;
    std::size_t longer = 0;
    for (std::size_t node = 1; node < flown.set.nodes(); ++node) {
        const std::optional<CellStay> first = stay_of(flown.set, node, 1, 1.0F);
        ASSERT_TRUE(first);
        bool named = false;
        for (const FootprintEntry& entry : flown.set.entered(node)) {
            named = named || entry.cell == first->cell;
        }
        longer += named ? 0U : 1U;
    }
    EXPECT_GT(longer, 50U);
}

/// One that comes near some trajectory at the time when the vehicle is there.
Intruder random_intruder(Random& random, const Flown& flown)
{
    const auto vector = [&](float size) {
        return Vec3(random.uniform(-size, size), random.uniform(-size, size), 0.3F * random.uniform(-size, size));
    };
    Intruder intruder;
    intruder.velocity = vector(2.0F);
    intruder.radius = random.uniform(0.2F, 1.0F);
    intruder.speed_share = 0.0F;
    const std::size_t node = 1 + random.below(flown.set.nodes() - 1);
    const float share = random.uniform();
    intruder.position = flown.at(node, static_cast<double>(share)).cast<float>() + vector(1.0F) -
                        static_cast<float>(flown.time(node, static_cast<double>(share))) * intruder.velocity;
    return intruder;
}

/// Section 2.9, item 2: whatever comes closer than the radius and the margin on its arc is blocked, and whatever is
/// blocked comes closer than that and the stated looseness: the arc's deviation twice, and rounding.
TEST(Meetings, DirectNeverAcceptsWhatComesTooNear)
{
    const Flown flown;
    constexpr std::uint64_t kSeed = 20261123;
    Random random(kSeed);
    std::size_t blocked = 0;
    std::size_t looked = 0;
    for (int i = 0; i < 12; ++i) {
        const Intruder intruder = random_intruder(random, flown);
        const float margin = random.uniform(0.0F, 0.5F);
        const double limit = static_cast<double>(intruder.radius) + static_cast<double>(margin);
        for (std::size_t node = 1; node < flown.set.nodes(); ++node) {
            double least = 1e9;
            for (int k = 0; k <= kDense; ++k) {
                const double share = static_cast<double>(k) / kDense;
                const Point<double> q =
                    intruder.position.cast<double>() + flown.time(node, share) * intruder.velocity.cast<double>();
                least = std::min(least, (flown.at(node, share) - q).norm());
            }
            const bool is = meets(flown.set, node, 1.0F, intruder, margin);
            if (least <= limit) {
                ASSERT_TRUE(is) << "seed " << kSeed << ", intruder " << i << ", node " << node;
            }
            // Between two dense samples it may be nearer by half a step of both.
            const double step = (1.0 + static_cast<double>(intruder.velocity.norm())) / (2.0 * kDense);
            const auto aside =
                static_cast<double>(chord_deviation(flown.set.step, static_cast<Movement>(flown.set.movement[node])));
            if (least > limit + 2.0 * aside + step + 3e-3) {
                ASSERT_FALSE(is) << "seed " << kSeed << ", intruder " << i << ", node " << node;
            }
            blocked += is ? 1U : 0U;
            ++looked;
        }
    }
    EXPECT_GT(blocked, looked / 100);
    EXPECT_LT(blocked, looked / 2);
}

/// Section 2.9, item 1: node by node nothing is accepted where the body and the vehicle are in the same cell at the
/// same time; and whatever it blocks, the hull of all trajectories' times blocks.
TEST(Meetings, CellsAtTheSameTimeAreBlocked)
{
    const Flown flown;
    constexpr std::uint64_t kSeed = 2;
    Random random(kSeed);
    const Grid<float>& grid = flown.set.grid;
    std::vector<CellBall> balls;
    for (CellIndex cell = 0; cell < grid.cells(); ++cell) {
        balls.push_back(ball_of(grid, grid.place(cell)));
    }
    std::vector<Stay> hull(grid.cells());
    cell_times(flown.set, 1.0F, hull);
    std::size_t contacts = 0;
    std::size_t by_hull = 0;
    std::size_t by_node = 0;
    for (int i = 0; i < 8; ++i) {
        const Intruder intruder = random_intruder(random, flown);
        std::vector<Stay> table(grid.cells());
        fill_meetings(CombinedModel(grid, intruder, {false, true, false, true}, 0.0F), balls, table);
        for (std::size_t node = 1; node < flown.set.nodes(); ++node) {
            const bool is = meets_in_cells(flown.set, node, 1.0F, table);
            bool hulls = false;
            for (std::size_t sample = 1; sample <= flown.set.samples; ++sample) {
                const std::optional<CellStay> stay = stay_of(flown.set, node, sample, 1.0F);
                hulls = hulls || (stay && meet(hull[stay->cell], table[stay->cell]));
            }
            ASSERT_TRUE(hulls || !is);
            by_hull += hulls ? 1U : 0U;
            by_node += is ? 1U : 0U;
            // Where the intruder's body covers the vehicle itself, they are in one cell at one time.
            for (int k = 1; k <= kDense; ++k) {
                const double share = static_cast<double>(k) / kDense;
                const Point<double> p = flown.at(node, share);
                const Point<double> q =
                    intruder.position.cast<double>() + flown.time(node, share) * intruder.velocity.cast<double>();
                if ((p - q).norm() < static_cast<double>(intruder.radius) - 1e-3) {
                    ++contacts;
                    ASSERT_TRUE(is) << "seed " << kSeed << ", intruder " << i << ", node " << node;
                }
            }
        }
    }
    EXPECT_GT(contacts, 1000U);
    EXPECT_LT(by_node, by_hull) << "it is finer";
    RecordProperty("blocked_by_node", static_cast<int>(by_node));
    RecordProperty("blocked_by_hull", static_cast<int>(by_hull));
}

}  // namespace
}  // namespace jink::reach::build
