// SPDX-License-Identifier: BSD-3-Clause
#include "core/reach/vehicle_sets.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "firmware/vehicles/default/reach_sets.hpp"

namespace jink::reach {
namespace {

/// A root and one movement straight ahead.
struct TinySet {
    std::array<NodeIndex, 2> parent{0, 0};
    std::array<std::uint8_t, 2> movement{0, 0};
    std::array<CellIndex, 2> end{kNoCell, 17};
    std::array<std::int16_t, 6> position{0, 0, 0, 1024, 0, 0};
    std::array<std::int8_t, 4> attitude{};
    std::array<std::uint16_t, 2> cost{0, 1024};
    std::array<std::uint8_t, 2> depth{0, 1};
    std::array<std::uint16_t, 3> first_entry{0, 0, 1};
    std::array<FootprintEntry, 1> entries{{{17, 1, 8}}};
    ReachSet set;

    TinySet()
    {
        set.name = "tiny";
        set.samples = 8;
        set.parent = parent;
        set.movement = movement;
        set.end = end;
        set.position = position;
        set.attitude = attitude;
        set.cost = cost;
        set.depth = depth;
        set.first_entry = first_entry;
        set.entries = entries;
        set.checksum = checksum_of(set);
    }
};

class VehicleSetsTest : public ::testing::Test {
protected:
    VehicleSetsTest()
    {
        for (std::size_t i = 0; i < segments.size(); ++i) {
            segments[i] = {&a.set, &b.set, i % kPitchSegments == 2};
        }
        sets.vehicle = "tiny";
        sets.period = 0.5F;
        sets.max_acceleration = 5.0F;
        sets.max_vertical_acceleration = 3.0F;
        sets.max_climb = 3.0F;
        sets.max_descent = 3.0F;
        sets.cruise_speed = 5.0F;
        sets.speeds = speeds;
        sets.most_speed = 1.2F;
        sets.pitch_separators = separators;
        sets.most_pitch = most_pitch;
        sets.segments = segments;
        sets.checksum = checksum_of(sets);
    }

    /// Index of the segment, -1 for none.
    [[nodiscard]] std::ptrdiff_t at(float speed, float pitch) const
    {
        const SegmentSets* const found = segment_of(sets, speed, pitch);
        return found == nullptr ? -1 : found - segments.data();
    }
    /// The status with the checksum of the change.
    [[nodiscard]] SetStatus checked()
    {
        sets.checksum = checksum_of(sets);
        return check(sets);
    }

    TinySet a;
    TinySet b;
    std::array<float, 2> speeds{0.25F, 0.75F};
    std::array<std::array<float, 2>, 2> separators{{{-0.125F, 0.125F}, {-0.0625F, 0.0625F}}};
    std::array<float, 2> most_pitch{0.375F, 0.1875F};
    std::array<SegmentSets, 6> segments{};
    VehicleSets sets;
};

/// Specification 6: a separator belongs to the interval above it, the upper bound to the last one.
TEST_F(VehicleSetsTest, BordersBelongToTheSegmentAbove)
{
    EXPECT_EQ(at(0.0F, 0.0F), 1);
    EXPECT_EQ(at(0.1F, 0.0F), 1) << "slower than the first segment's lower end";
    EXPECT_EQ(at(0.25F, 0.0F), 1);
    EXPECT_EQ(at(std::nextafter(0.75F, 0.0F), 0.0F), 1);
    EXPECT_EQ(at(0.75F, 0.0F), 4);
    EXPECT_EQ(at(1.2F, 0.0F), 4);
    EXPECT_EQ(at(std::nextafter(1.2F, 2.0F), 0.0F), -1);
    EXPECT_EQ(at(0.5F, -0.125F), 1);
    EXPECT_EQ(at(0.5F, std::nextafter(-0.125F, -1.0F)), 2) << "nose up: climbing";
    EXPECT_EQ(at(0.5F, std::nextafter(0.125F, 0.0F)), 1);
    EXPECT_EQ(at(0.5F, 0.125F), 0) << "nose down: descending";
    EXPECT_EQ(at(0.5F, 0.375F), 0);
    EXPECT_EQ(at(0.5F, -0.375F), 2);
    EXPECT_EQ(at(0.5F, std::nextafter(0.375F, 1.0F)), -1);
    EXPECT_EQ(at(0.5F, std::nextafter(-0.375F, -1.0F)), -1);
    EXPECT_EQ(at(1.0F, 0.1F), 3) << "separators of its own speed";
    EXPECT_EQ(at(1.0F, 0.2F), -1);
}

TEST_F(VehicleSetsTest, NothingForWhatIsNoState)
{
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    EXPECT_EQ(at(nan, 0.0F), -1);
    EXPECT_EQ(at(0.5F, nan), -1);
    EXPECT_EQ(at(infinity, 0.0F), -1);
    EXPECT_EQ(at(-0.1F, 0.0F), -1);
    EXPECT_EQ(at(0.5F, infinity), -1);
    EXPECT_EQ(segment_of(VehicleSets{}, 0.5F, 0.0F), nullptr);
}

TEST_F(VehicleSetsTest, GoodOnesPass) { EXPECT_EQ(check(sets), SetStatus::good); }

TEST_F(VehicleSetsTest, EmptyAndOversizedAreRefused)
{
    EXPECT_EQ(check(VehicleSets{}), SetStatus::empty);
    const std::array<float, kMaxSpeedSegments + 1> many{};
    sets.speeds = many;
    EXPECT_EQ(checked(), SetStatus::too_large);
}

TEST_F(VehicleSetsTest, SizesHaveToMatch)
{
    sets.segments = sets.segments.first(5);
    EXPECT_EQ(checked(), SetStatus::sizes_differ);
    sets.segments = segments;
    sets.most_pitch = sets.most_pitch.first(1);
    EXPECT_EQ(checked(), SetStatus::sizes_differ);
    sets.most_pitch = most_pitch;
    sets.pitch_separators = sets.pitch_separators.first(1);
    EXPECT_EQ(checked(), SetStatus::sizes_differ);
}

TEST_F(VehicleSetsTest, NumbersHaveToMakeSense)
{
    for (float VehicleSets::*number :
         {&VehicleSets::period, &VehicleSets::max_acceleration, &VehicleSets::max_vertical_acceleration,
          &VehicleSets::max_climb, &VehicleSets::max_descent, &VehicleSets::cruise_speed, &VehicleSets::most_speed}) {
        for (const float bad : {0.0F, -1.0F, std::numeric_limits<float>::quiet_NaN()}) {
            const float good = sets.*number;
            sets.*number = bad;
            EXPECT_EQ(checked(), SetStatus::bad_segments);
            sets.*number = good;
        }
    }
    speeds = {0.75F, 0.75F};
    EXPECT_EQ(checked(), SetStatus::bad_segments);
    speeds = {0.25F, 1.2F};
    EXPECT_EQ(checked(), SetStatus::bad_segments);
    speeds = {0.25F, 0.75F};
    separators[1] = {0.1F, 0.15F};
    EXPECT_EQ(checked(), SetStatus::bad_segments);
    separators[1] = {-0.0625F, 0.0625F};
    most_pitch[1] = 0.05F;
    EXPECT_EQ(checked(), SetStatus::bad_segments);
    most_pitch[1] = 0.1875F;
    EXPECT_EQ(checked(), SetStatus::good);
}

TEST_F(VehicleSetsTest, EverySegmentHasTwoSetsOfOneGrid)
{
    segments[3].navigation = nullptr;
    EXPECT_EQ(checked(), SetStatus::bad_segments);
    EXPECT_EQ(at(1.0F, 0.0F), 4) << "looking for a segment reads no set";
    segments[3].navigation = &a.set;
    b.set.step.yaw = 0.1F;
    b.set.checksum = checksum_of(b.set);
    EXPECT_EQ(checked(), SetStatus::bad_segments);
}

/// A bit that flipped, in a table or in a number: everything is noticed, wherever it is.
TEST_F(VehicleSetsTest, DamageIsSeen)
{
    b.cost[1] ^= 1U;
    EXPECT_EQ(check(sets), SetStatus::wrong_checksum);
    b.cost[1] ^= 1U;
    b.parent[1] = 1;
    EXPECT_EQ(check(sets), SetStatus::not_a_tree);
    b.parent[1] = 0;
    EXPECT_EQ(check(sets), SetStatus::good);
    for (float VehicleSets::*number : {&VehicleSets::period, &VehicleSets::max_acceleration, &VehicleSets::most_speed,
                                       &VehicleSets::cruise_speed, &VehicleSets::max_descent}) {
        const float good = sets.*number;
        sets.*number = 1.01F * good;
        EXPECT_EQ(check(sets), SetStatus::wrong_checksum);
        sets.*number = good;
    }
    segments[5].upside_down = !segments[5].upside_down;
    EXPECT_EQ(check(sets), SetStatus::wrong_checksum);
    segments[5].upside_down = !segments[5].upside_down;
    speeds[0] = 0.26F;
    EXPECT_EQ(check(sets), SetStatus::wrong_checksum);
    speeds[0] = 0.25F;
    most_pitch[0] = 0.376F;
    EXPECT_EQ(check(sets), SetStatus::wrong_checksum);
}

TEST(UpsideDown, IsItsOwnInverseAndTurnsPitchAlone)
{
    for (const Movement movement : kAllMovements) {
        const Movement mirrored = upside_down(movement);
        EXPECT_EQ(upside_down(mirrored), movement);
        EXPECT_EQ(turn_of(mirrored).pitch, -turn_of(movement).pitch);
        EXPECT_EQ(turn_of(mirrored).yaw, turn_of(movement).yaw);
    }
    const Grid<float> grid;
    for (CellIndex cell = 0; cell < grid.cells(); ++cell) {
        const CellPlace place = grid.place(cell);
        const CellPlace mirrored = upside_down(place, grid.rows());
        EXPECT_EQ(upside_down(mirrored, grid.rows()), place);
        const Vec3 centre = grid.centre(place);
        EXPECT_NEAR((grid.centre(mirrored) - Vec3(centre.x(), centre.y(), -centre.z())).norm(), 0.0F, 1e-5F);
    }
}

/// Calls until something other than `running` comes, with so many units each; 0: with those of the next piece.
Progress pass(TableCheck& tables, std::uint32_t units = 0, int* calls = nullptr)
{
    for (int i = 1; i < 10'000; ++i) {
        WorkBudget budget(units == 0 ? tables.units_of_next() : units);
        const Progress progress = tables.advance(budget);
        if (progress != Progress::running) {
            if (calls != nullptr) {
                *calls = i;
            }
            return progress;
        }
    }
    return Progress::running;
}

TEST_F(VehicleSetsTest, TablesAreCheckedAgainAndAgain)
{
    for (const std::uint32_t units : {20U, 23U, 37U, 1000U}) {
        TableCheck tables(sets);
        for (int i = 0; i < 3; ++i) {
            EXPECT_EQ(pass(tables, units), Progress::done) << units;
        }
    }
    TableCheck starved(sets);
    EXPECT_EQ(pass(starved, starved.units_of_next() - 1), Progress::running);
}

TEST_F(VehicleSetsTest, EveryFlippedBitIsFoundWithinAPassAndForGood)
{
    const auto flip_each = [&](auto& table) {
        const std::span<std::byte> bytes = std::as_writable_bytes(std::span(table));
        for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
            TableCheck tables(sets);
            ASSERT_EQ(pass(tables), Progress::done);
            bytes[bit / 8] ^= std::byte{1} << (bit % 8);
            EXPECT_EQ(pass(tables), Progress::failed) << bit;
            bytes[bit / 8] ^= std::byte{1} << (bit % 8);
            EXPECT_EQ(pass(tables), Progress::failed) << "what has failed once will fail again";
        }
    };
    for (TinySet* set : {&a, &b}) {
        flip_each(set->parent);
        flip_each(set->movement);
        flip_each(set->end);
        flip_each(set->position);
        flip_each(set->attitude);
        flip_each(set->cost);
        flip_each(set->depth);
        flip_each(set->first_entry);
        flip_each(set->entries);
    }
    flip_each(speeds);
    flip_each(separators);
    flip_each(most_pitch);
}

/// The real ones: each table once although several segments refer to it, however the work is divided.
TEST(VehicleSets, TablesOfTheDefaultVehicleAreCheckedWithinNinetySeconds)
{
    TableCheck tables(kDefaultSets);
    int calls = 0;
    EXPECT_EQ(pass(tables, 0, &calls), Progress::done);
    EXPECT_LT(calls, 90 * 50) << "steps";
    EXPECT_EQ(pass(tables, 1'000'000), Progress::done);
}

}  // namespace
}  // namespace jink::reach
