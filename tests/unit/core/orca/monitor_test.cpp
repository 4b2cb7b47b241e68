// SPDX-License-Identifier: BSD-3-Clause
// The supervision monitor (G-ORCA section 15).
#include "core/orca/monitor.hpp"

#include <limits>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

namespace jink::orca {
namespace {

/// Stop distances 0.96 and 0.48 m between vehicles, 0.88 and 0.64 m to obstacles.
class MonitorTest : public ::testing::Test {
protected:
    MonitorReport see(const std::vector<MonitoredVehicle>& vehicles, const std::vector<MonitoredPiece>& pieces = {})
    {
        now = now + 0.025F;
        return monitor->update(now, own, vehicles, pieces);
    }
    std::unique_ptr<Monitor> monitor = std::make_unique<Monitor>();
    Vec3 own = Vec3(100.0F, -50.0F, 20.0F);
    TimePoint now;
    [[nodiscard]] MonitoredVehicle vehicle(std::uint16_t id, const Vec3& offset) const { return {id, own + offset}; }
    [[nodiscard]] MonitoredPiece piece(std::uint16_t id, const Vec3& offset) const { return {id, own + offset}; }
};

TEST_F(MonitorTest, TripsAtTheSecondSampleInARow)
{
    EXPECT_FALSE(see({vehicle(7, {0.9F, 0, 0.4F})}).tripped);
    const MonitorReport second = see({vehicle(7, {0.9F, 0, 0.4F})});
    EXPECT_TRUE(second.tripped);
    EXPECT_TRUE(second.just_now);
    EXPECT_EQ(second.action, TripAction::hover_brake);
    EXPECT_EQ(monitor->trip().subject, Subject::vehicle);
    EXPECT_EQ(monitor->trip().id, 7);
    EXPECT_NEAR(monitor->trip().horizontal, 0.9F, 1e-4F);
    EXPECT_NEAR(monitor->trip().vertical, 0.4F, 1e-4F);
    EXPECT_EQ(monitor->trip().stamp, now);
}
/// h < 1 AND z < 1: either one kept is enough (Alejo 8.4 item 5).
TEST_F(MonitorTest, OneComponentKeptIsEnough)
{
    for (int i = 0; i < 5; ++i) {
        EXPECT_FALSE(see({vehicle(7, {0.0F, 0, 0.49F}), vehicle(8, {0.97F, 0, 0.0F})}).tripped);
    }
    const MonitorReport report = see({vehicle(7, {0.0F, 0, 0.49F})});
    EXPECT_EQ(report.horizontal, 0.0F);
    EXPECT_NEAR(report.vertical, 0.49F / 0.48F, 1e-3F);
    EXPECT_NEAR(report.ellipsoid, report.vertical, 1e-6F);
}
TEST_F(MonitorTest, ASampleBetweenThatIsClearCounts)
{
    for (int i = 0; i < 5; ++i) {
        EXPECT_FALSE(see({vehicle(7, {0.5F, 0, 0})}).tripped);
        EXPECT_FALSE(see({vehicle(7, {1.5F, 0, 0})}).tripped);
    }
}
/// One that was not seen to be clear keeps its count: a picture that flickers hides nothing.
TEST_F(MonitorTest, ASampleThatIsMissingDoesNot)
{
    EXPECT_FALSE(see({vehicle(7, {0.5F, 0, 0})}).tripped);
    EXPECT_FALSE(see({}).tripped);
    EXPECT_TRUE(see({vehicle(7, {0.5F, 0, 0})}).tripped);
}
TEST_F(MonitorTest, SamplesAreCountedForEachByItself)
{
    EXPECT_FALSE(see({vehicle(7, {0.5F, 0, 0})}).tripped);
    EXPECT_FALSE(see({vehicle(7, {1.5F, 0, 0}), vehicle(8, {0.5F, 0, 0})}).tripped);
    EXPECT_FALSE(see({vehicle(8, {1.5F, 0, 0})}, {piece(8, {0.5F, 0, 0})}).tripped) << "a piece of the same number";
    EXPECT_TRUE(see({}, {piece(8, {0.5F, 0, 0})}).tripped);
    EXPECT_EQ(monitor->trip().subject, Subject::obstacle);
}
TEST_F(MonitorTest, StaysTrippedUntilItIsAcknowledged)
{
    static_cast<void>(see({vehicle(7, {0.5F, 0, 0})}));
    static_cast<void>(see({vehicle(7, {0.5F, 0, 0})}));
    for (int i = 0; i < 10; ++i) {
        const MonitorReport report = see({vehicle(7, {5, 0, 0})});
        EXPECT_TRUE(report.tripped);
        EXPECT_FALSE(report.just_now);
    }
    monitor->acknowledge();
    EXPECT_FALSE(see({vehicle(7, {0.5F, 0, 0})}).tripped);
    EXPECT_TRUE(see({vehicle(7, {0.5F, 0, 0})}).just_now) << "acknowledged amid a violation it trips again";
    EXPECT_EQ(monitor->trips(), 2U);
}
TEST_F(MonitorTest, TheNumberOfSamplesIsASetting)
{
    MonitorSettings settings;
    settings.samples = 1;
    settings.action = TripAction::land;
    monitor = std::make_unique<Monitor>(settings);
    EXPECT_TRUE(see({vehicle(7, {0.5F, 0, 0})}).tripped);
    EXPECT_EQ(see({}).action, TripAction::land);
    settings.samples = 5;
    monitor = std::make_unique<Monitor>(settings);
    for (int i = 0; i < 4; ++i) {
        EXPECT_FALSE(see({vehicle(7, {0.5F, 0, 0})}).tripped);
    }
    EXPECT_TRUE(see({vehicle(7, {0.5F, 0, 0})}).tripped);
}

/// A wall and a floor: the same as for a point.
TEST_F(MonitorTest, LevelAndUprightFacesOfObstacles)
{
    for (const Vec3& offset : {Vec3(0.89F, 0, 0), Vec3(0, 0, -0.65F)}) {
        monitor = std::make_unique<Monitor>();
        EXPECT_FALSE(see({}, {piece(1, offset)}).tripped);
        EXPECT_FALSE(see({}, {piece(1, offset)}).tripped);
        EXPECT_FALSE(see({}, {piece(1, 0.98F * offset)}).tripped);
        EXPECT_TRUE(see({}, {piece(1, 0.98F * offset)}).tripped);
    }
}
/// A slope whose nearest point is outside of the cylinder, and which is in it all the same: h = 0.5, z = 1.05.
TEST_F(MonitorTest, ASlopeThatReachesIntoTheCylinder)
{
    const Vec3 offset(0.5F * 0.88F, 0, -1.05F * 0.64F);
    EXPECT_FALSE(see({}, {piece(1, offset)}).tripped);
    EXPECT_TRUE(see({}, {piece(1, offset)}).tripped);
    monitor = std::make_unique<Monitor>();
    const Vec3 beyond(1.001F * 0.88F, 0, -1.001F * 0.64F);
    EXPECT_FALSE(see({}, {piece(1, beyond)}).tripped);
    EXPECT_FALSE(see({}, {piece(1, beyond)}).tripped);
}
TEST_F(MonitorTest, InsideOfAnObstacle)
{
    EXPECT_FALSE(see({}, {piece(1, Vec3::Zero())}).tripped);
    EXPECT_TRUE(see({}, {piece(1, Vec3::Zero())}).tripped);
    EXPECT_EQ(monitor->trip().nearest_obstacle, 0.0F);
}

/// T7: numbers that are none are passed over and counted, and do not clear anything.
TEST_F(MonitorTest, PassesOverWhatIsNoNumber)
{
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(see({vehicle(7, {0.5F, 0, 0})}).tripped);
    EXPECT_FALSE(see({vehicle(7, {nan, 0, 0})}).tripped);
    const Vec3 where = own;
    own = Vec3(nan, 0, 0);
    EXPECT_FALSE(see({{7, where}}).tripped);
    own = where;
    EXPECT_EQ(monitor->bad_inputs(), 2U);
    EXPECT_TRUE(see({vehicle(7, {0.5F, 0, 0})}).tripped);
}
/// More violated pairs than can be counted: it trips at once.
TEST_F(MonitorTest, TripsAtOnceWhenItCannotCount)
{
    std::vector<MonitoredVehicle> crowd;
    for (std::uint16_t id = 0; id < Monitor::kMostViolated; ++id) {
        crowd.push_back(vehicle(id, {0.5F, 0, 0}));
    }
    EXPECT_FALSE(see(crowd).tripped);
    monitor->acknowledge();
    crowd.push_back(vehicle(500, {0.5F, 0, 0}));
    EXPECT_TRUE(see(crowd).tripped);
    EXPECT_EQ(monitor->trip().id, 500);
}

/// The log: 256 records, the tightest pair of each tick.
TEST_F(MonitorTest, KeepsTheLast256Ticks)
{
    for (int i = 0; i < 300; ++i) {
        static_cast<void>(
            see({vehicle(1, {20, 0, 0}), vehicle(2, {3.0F + static_cast<float>(i), 0, 1})}, {piece(3, {0, 30, 0})}));
    }
    ASSERT_EQ(monitor->records(), Monitor::kRecords);
    const MonitorRecord& oldest = monitor->record(0);
    EXPECT_EQ(oldest.id, 1) << "record 44: the other one is 47 m away";
    const MonitorRecord& newest = monitor->record(Monitor::kRecords - 1);
    EXPECT_EQ(newest.stamp, now);
    EXPECT_NEAR(newest.nearest_obstacle, 30.0F, 1e-4F);
    EXPECT_EQ(oldest.stamp.us + 255 * 25'000, newest.stamp.us);
}
/// After a trip it goes on for 128 ticks and then waits for the acknowledgement.
TEST_F(MonitorTest, KeepsWhatLedToATrip)
{
    for (int i = 0; i < 300; ++i) {
        static_cast<void>(see({vehicle(1, {2, 0, 0})}));
    }
    static_cast<void>(see({vehicle(1, {0.5F, 0, 0})}));
    static_cast<void>(see({vehicle(1, {0.5F, 0, 0})}));
    const TimePoint tripped = now;
    for (int i = 0; i < 1000; ++i) {
        static_cast<void>(see({vehicle(1, {2, 0, 0})}));
    }
    ASSERT_EQ(monitor->records(), Monitor::kRecords);
    EXPECT_EQ(monitor->record(127).stamp, tripped);
    EXPECT_NEAR(monitor->record(127).horizontal, 0.5F, 1e-4F);
    monitor->acknowledge();
    static_cast<void>(see({vehicle(1, {2, 0, 0})}));
    EXPECT_EQ(monitor->record(Monitor::kRecords - 1).stamp, now);
}
TEST_F(MonitorTest, NobodyAroundIsRecordedAsSuch)
{
    const MonitorReport report = see({});
    EXPECT_EQ(report.subject, Subject::nobody);
    EXPECT_GT(report.ellipsoid, 1e30F);
    ASSERT_EQ(monitor->records(), 1U);
    EXPECT_EQ(monitor->record(0).subject, Subject::nobody);
}

}  // namespace
}  // namespace jink::orca
