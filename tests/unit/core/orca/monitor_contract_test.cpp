// SPDX-License-Identifier: BSD-3-Clause
// The monitor's header where a second trip, a broken piece or a moving own vehicle shows what the first tick does not.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "core/orca/monitor.hpp"

namespace jink::orca {
namespace {

constexpr float kNoPlace = std::numeric_limits<float>::quiet_NaN();

class MonitorContract : public ::testing::Test {
protected:
    MonitorReport see(const std::vector<MonitoredVehicle>& vehicles, const std::vector<MonitoredPiece>& pieces = {})
    {
        now = now + 0.025F;
        return monitor->update(now, own, vehicles, pieces);
    }
    std::unique_ptr<Monitor> monitor = std::make_unique<Monitor>();
    Vec3 own = Vec3::Zero();
    TimePoint now;
};

/// After each trip the log goes on for 128 ticks.
TEST_F(MonitorContract, TheLogGoesOnAfterTheSecondTripAsAfterTheFirst)
{
    TimePoint second;
    for (int trip = 0; trip < 2; ++trip) {
        for (int i = 0; i < 2; ++i) {
            static_cast<void>(see({{1, {0.5F, 0, 0}}}));
        }
        ASSERT_TRUE(monitor->tripped());
        second = now;
        for (int i = 0; i < 400; ++i) {
            static_cast<void>(see({{1, {2, 0, 0}}}));
        }
        if (trip == 0) {
            monitor->acknowledge();
        }
    }
    ASSERT_EQ(monitor->records(), Monitor::kRecords);
    EXPECT_EQ(monitor->record(127).stamp, second);
    EXPECT_EQ(monitor->trip().stamp, second);
    EXPECT_EQ(monitor->trips(), 2U);
}

/// A piece that is not a number is passed over and counted, the others and what was counted of it stay.
TEST_F(MonitorContract, APieceThatIsNoNumberClearsNothing)
{
    EXPECT_FALSE(see({}, {{3, {0.5F, 0, 0}}, {4, {9, 0, 0}}}).tripped);
    const MonitorReport between = see({}, {{3, {0, kNoPlace, 0}}, {4, {8, 0, 0}}});
    EXPECT_FALSE(between.tripped);
    EXPECT_EQ(between.id, 4U);
    EXPECT_EQ(monitor->bad_inputs(), 1U);
    EXPECT_EQ(monitor->record(1).nearest_obstacle, 8.0F);
    EXPECT_TRUE(see({}, {{3, {0.5F, 0, 0}}}).tripped);
    EXPECT_EQ(monitor->trip().id, 3U);
    EXPECT_EQ(monitor->trip().nearest_obstacle, 0.5F);
}

/// Distances are those from the own place, of vehicles by their own stop distances and of pieces by theirs.
TEST_F(MonitorContract, SharesAreOfTheirOwnStopDistances)
{
    MonitorSettings settings;
    settings.stop_horizontal = 2.0F;
    settings.stop_vertical = 1.0F;
    settings.obstacle_horizontal = 4.0F;
    settings.obstacle_vertical = 0.5F;
    settings.action = TripAction::event_only;
    monitor = std::make_unique<Monitor>(settings);
    own = {10, 20, 30};
    const MonitorReport vehicle = see({{1, {13, 24, 28}}});
    EXPECT_EQ(vehicle.action, TripAction::event_only);
    EXPECT_EQ(vehicle.subject, Subject::vehicle);
    EXPECT_FLOAT_EQ(vehicle.horizontal, 2.5F);
    EXPECT_FLOAT_EQ(vehicle.vertical, 2.0F);
    EXPECT_FLOAT_EQ(vehicle.ellipsoid, std::hypot(2.5F, 2.0F));
    EXPECT_FLOAT_EQ(monitor->record(0).horizontal, 5.0F);
    EXPECT_FLOAT_EQ(monitor->record(0).vertical, 2.0F);
    EXPECT_TRUE(std::isinf(monitor->record(0).nearest_obstacle)) << "a vehicle is no obstacle";
    const MonitorReport piece = see({}, {{1, {13, 24, 28}}});
    EXPECT_EQ(piece.subject, Subject::obstacle);
    EXPECT_FLOAT_EQ(piece.horizontal, 1.25F);
    EXPECT_FLOAT_EQ(piece.vertical, 4.0F);
    EXPECT_FLOAT_EQ(monitor->record(1).nearest_obstacle, std::sqrt(29.0F));
}

/// The latched trip is about the first, whatever comes after it, until it is acknowledged.
TEST_F(MonitorContract, ATripIsOfWhomItWasAbout)
{
    static_cast<void>(see({{5, {0.5F, 0, 0}}}));
    ASSERT_TRUE(see({{5, {0.5F, 0, 0}}}).just_now);
    const TimePoint first = now;
    static_cast<void>(see({{6, {0.1F, 0, 0}}}));
    static_cast<void>(see({{6, {0.1F, 0, 0}}}));
    EXPECT_EQ(monitor->trip().id, 5U);
    EXPECT_EQ(monitor->trip().stamp, first);
    EXPECT_EQ(monitor->trips(), 1U);
    monitor->acknowledge();
    EXPECT_FALSE(see({{6, {0.1F, 0, 0}}}).tripped) << "counted anew";
    EXPECT_TRUE(see({{6, {0.1F, 0, 0}}}).just_now);
    EXPECT_EQ(monitor->trip().id, 6U);
}

/// Those that are clear again make room for others: 64 at once, not 64 ever.
TEST_F(MonitorContract, WhoIsClearAgainIsNotCounted)
{
    for (std::uint16_t id = 0; id < 3 * Monitor::kMostViolated; ++id) {
        ASSERT_FALSE(see({{id, {0.5F, 0, 0}}}).tripped) << id;
        ASSERT_FALSE(see({{id, {1.5F, 0, 0}}}).tripped) << id;
    }
}

}  // namespace
}  // namespace jink::orca
