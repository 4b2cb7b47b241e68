// SPDX-License-Identifier: BSD-3-Clause
// Times of cells on sets that are flown: each trajectory flown densely, in double, from the root (avoidance
// specification, section 2.1).
#include "tests/reference/reach/meeting.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

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
    // Cells that no trajectory passes have no time.
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

}  // namespace
}  // namespace jink::reach::build
