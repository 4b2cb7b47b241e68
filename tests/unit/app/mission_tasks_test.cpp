// SPDX-License-Identifier: BSD-3-Clause
// Tasks over the mission line: which one is open, accepted, answered and flown; and what is held before anything came.
#include <gtest/gtest.h>

#include "tests/unit/app/mission_edges.hpp"

namespace jink::app::test {
namespace {

TEST_F(MissionEdges, AnImpossiblePartOfAnotherTaskLeavesTheUploadOpen)
{
    EXPECT_EQ(line_.status(parts_of(5, line(30))[0]), TaskStatus::more);
    TaskUpload other = parts_of(6, line(30))[0];
    other.points = 0;
    EXPECT_EQ(line_.status(other), TaskStatus::inconsistent);
    EXPECT_TRUE(protocol_.upload().is_open());
    EXPECT_EQ(line_.status(parts_of(5, line(30))[1]), TaskStatus::more);
    other = parts_of(5, line(30))[2];
    other.points = 0;
    EXPECT_EQ(line_.status(other), TaskStatus::inconsistent);
    EXPECT_FALSE(protocol_.upload().is_open()) << "a part of its own ends it";
}

TEST_F(MissionEdges, ALaterPartOpensNoUpload)
{
    const TaskAck ack = line_.ack(parts_of(5, line(30))[1]);
    EXPECT_EQ(static_cast<TaskStatus>(ack.status), TaskStatus::out_of_order);
    EXPECT_EQ(ack.next, 0U);
    EXPECT_FALSE(protocol_.upload().is_open());
    EXPECT_EQ(line_.status(parts_of(6, line(30))[0]), TaskStatus::more) << "no other task is under way";
}

TEST_F(MissionEdges, AnUploadThatFailedAwaitsNothing)
{
    auto parts = parts_of(5, line(30));
    ASSERT_EQ(line_.status(parts[0]), TaskStatus::more);
    ASSERT_EQ(line_.ack(parts[1]).next, 2U);
    parts[2].position[0] = std::numeric_limits<float>::quiet_NaN();
    const TaskAck ack = line_.ack(parts[2]);
    EXPECT_EQ(static_cast<TaskStatus>(ack.status), TaskStatus::bad_point);
    EXPECT_EQ(ack.next, 0U);
    EXPECT_EQ(line_.generator.status(), path::GeneratorStatus::rejected) << "and nothing else is flown";
    EXPECT_EQ(line_.upload(parts_of(6, line(30))), TaskStatus::accepted) << "the next one is free to come";
}

TEST_F(MissionEdges, TheSameNumberAndChecksumInOtherPartsIsAnotherUpload)
{
    const auto parts = parts_of(5, line(3));
    ASSERT_EQ(parts.size(), 1U);
    ASSERT_EQ(line_.upload(parts), TaskStatus::accepted);
    TaskUpload first = parts[0];
    first.parts = 2;
    EXPECT_EQ(line_.status(first), TaskStatus::more);
    EXPECT_TRUE(protocol_.upload().is_open());
}

TEST_F(MissionEdges, ANewTaskIsFlownAtItsOwnSpeed)
{
    const auto speed = [&] {
        vehicle::VehicleState at;
        at.position = Vec3(5, 0, 0);
        at.velocity = Vec3(1, 0, 0);
        return line_.generator.step(at, line_.now, false).velocity.norm();
    };
    ASSERT_EQ(line_.upload(parts_of(5, line(20), kLast, 0.5F)), TaskStatus::accepted);
    EXPECT_NEAR(speed(), 0.5F, 0.05F);
    ASSERT_EQ(line_.upload(parts_of(6, line(20), kLast, 1.5F)), TaskStatus::accepted);
    EXPECT_NEAR(speed(), 1.5F, 0.15F) << "it replaces the one before";
}

TEST_F(MissionEdges, WhatContinuesAPathThatIsOverIsRefusedAndThatIsShown)
{
    ASSERT_EQ(line_.upload(parts_of(5, line(3))), TaskStatus::accepted);
    EXPECT_TRUE(line_.generator.path().is_complete());
    const TaskStatus status = line_.status(parts_of(6, line(3, 2.0F), kContinues | kLast)[0]);
    EXPECT_NE(status, TaskStatus::accepted);
    EXPECT_NE(status, TaskStatus::more);
    EXPECT_FALSE(protocol_.upload().is_open());
}

TEST_F(MissionEdges, EverythingThatTheOwnStateSaysIsKept)
{
    StateOwn s;
    s.age_ms = 120;
    s.position = {1, 2, 3};
    s.velocity = {4, 5, 6};
    s.yaw = -2.5F;
    line_.send(s);
    const vehicle::VehicleState own = input().own;
    EXPECT_EQ(own.stamp.us, (line_.now - 0.01F).us - 120'000) << "its age, and the way";
    EXPECT_EQ(own.position, Vec3(1, 2, 3));
    EXPECT_EQ(own.velocity, Vec3(4, 5, 6));
    EXPECT_EQ(own.yaw, -2.5F);
    EXPECT_FALSE(input().hold);
}

/// The clock begins at zero: what never came is not young then.
TEST_F(MissionEdges, NothingHeardIsHeldFromTheStartOfTheClockOn)
{
    line_.now = {50'000};
    EXPECT_TRUE(input().hold);
    EXPECT_TRUE(has(MissionFault::own_state_stale));
    EXPECT_TRUE(has(MissionFault::no_preferred));
}

TEST_F(MissionEdges, ProgressIsReportedFromTheStartOfTheClockOn)
{
    line_.now = {50'000};
    protocol_.take_own_state(own(), line_.now);
    protocol_.take_preferred(Vec3(1, 0, 0), line_.now);
    ASSERT_EQ(input().faults, 0U);
    protocol_.tell_progress({}, line_.now);
    EXPECT_EQ(line_.heard().all<MissionReport>().size(), 1U) << "the first one is news";
    protocol_.tell_progress({}, line_.now);
    EXPECT_TRUE(line_.heard().all<MissionReport>().empty());
}

TEST_F(MissionEdges, AnotherTaskIsReportedAtOnce)
{
    path::GeneratorOutput output;
    output.status = path::GeneratorStatus::tracking;
    for (const std::uint32_t task : {5U, 6U}) {
        ASSERT_EQ(line_.upload(parts_of(task, line(3))), TaskStatus::accepted);
        protocol_.tell_progress(output, line_.now);
        const auto told = line_.heard().all<MissionReport>();
        ASSERT_EQ(told.size(), 1U) << task;
        EXPECT_EQ(told[0].task, task);
        line_.now.us += 1000;
        protocol_.tell_progress(output, line_.now);
        EXPECT_TRUE(line_.heard().all<MissionReport>().empty());
    }
}

}  // namespace
}  // namespace jink::app::test
