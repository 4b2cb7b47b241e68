// SPDX-License-Identifier: BSD-3-Clause
// Uploads of tasks: which part is refused, which ends the upload, when it is given up.
#include <gtest/gtest.h>

#include "tests/numbers.hpp"
#include "tests/unit/app/mission_edges.hpp"

namespace jink::app::test {
namespace {

TEST_F(MissionEdges, OnlyOneOfItsPartsMayBeWrongForAnUploadToBeRefused)
{
    const auto refuses = [&](const std::function<void(TaskUpload&)>& change) {
        auto parts = parts_of(5, line(30));
        EXPECT_EQ(line_.status(parts[0]), TaskStatus::more);
        change(parts[1]);
        const bool refused = line_.status(parts[1]) == TaskStatus::inconsistent;
        EXPECT_FALSE(refused && protocol_.upload().is_open()) << "the upload is over";
        if (protocol_.upload().is_open()) {
            parts[1].parts = 0;
            EXPECT_EQ(line_.status(parts[1]), TaskStatus::inconsistent);  // for the next case
        }
        return refused;
    };
    EXPECT_FALSE(refuses([](TaskUpload&) {}));
    EXPECT_TRUE(refuses([](TaskUpload& p) { p.parts = 4; }));
    EXPECT_TRUE(refuses([](TaskUpload& p) { p.crc ^= 1U; }));
    EXPECT_TRUE(refuses([](TaskUpload& p) { p.cruise_speed = 1.5F; }));
    EXPECT_TRUE(refuses([](TaskUpload& p) { p.time_limit = 9.0F; }));
    EXPECT_TRUE(refuses([](TaskUpload& p) { p.flags = kLast | kContinues; }));
    EXPECT_TRUE(refuses([](TaskUpload& p) { p.part = p.parts; }));
    EXPECT_TRUE(refuses([](TaskUpload& p) { p.time_limit = kNan; }));
}

TEST_F(MissionEdges, AnImpossiblePartOfAnotherTaskEndsNoUpload)
{
    const auto parts = parts_of(5, line(30));
    EXPECT_EQ(line_.status(parts[0]), TaskStatus::more);
    TaskUpload other = parts_of(6, line(30))[0];
    other.points = 0;
    const TaskAck ack = line_.ack(other);
    EXPECT_EQ(static_cast<TaskStatus>(ack.status), TaskStatus::inconsistent);
    EXPECT_EQ(ack.task, 6U);
    EXPECT_EQ(ack.next, 0U) << "of that one nothing is awaited";
    EXPECT_EQ(line_.ack(parts[0]).next, 1U);
    EXPECT_EQ(line_.ack(parts_of(6, line(30))[0]).next, 0U) << "busy";
    EXPECT_EQ(line_.status(parts[1]), TaskStatus::more);
    EXPECT_EQ(line_.ack(parts[2]).next, 3U);
    EXPECT_FALSE(protocol_.upload().is_open());
}

TEST_F(MissionEdges, AnUploadIsGivenUpAfterItsSilence)
{
    const auto first = parts_of(5, line(30));
    const auto second = parts_of(6, line(30));
    ASSERT_EQ(line_.status(first[0]), TaskStatus::more);
    const TimePoint heard = line_.now;
    line_.now = {heard.us + 4'000'000};
    EXPECT_EQ(line_.status(second[0]), TaskStatus::busy) << "which is no part of the first";
    line_.now = {heard.us + 5'000'000};
    line_.send(second[0]);
    protocol_.step(line_.now);
    EXPECT_EQ(static_cast<TaskStatus>(line_.heard().all<TaskAck>()[0].status), TaskStatus::busy)
        << "5 s to the microsecond";
    line_.now.us += 1;
    line_.send(second[0]);
    protocol_.step(line_.now);
    const TaskAck ack = line_.heard().all<TaskAck>()[0];
    EXPECT_EQ(static_cast<TaskStatus>(ack.status), TaskStatus::more);
    EXPECT_EQ(ack.next, 1U);
    EXPECT_EQ(line_.status(second[1]), TaskStatus::more);
    EXPECT_EQ(line_.status(second[2]), TaskStatus::accepted);
}

TEST_F(MissionEdges, TheSameTaskAgainIsKnownByNumberPartsAndChecksum)
{
    const auto parts = parts_of(5, line(20));
    ASSERT_EQ(parts.size(), 2U);
    ASSERT_EQ(line_.upload(parts), TaskStatus::accepted);
    EXPECT_EQ(line_.ack(parts[1]).next, 2U);
    const std::uint32_t generation = line_.generator.path().generation();
    auto other = parts_of(5, line(20, 1.0F));  // the number again, another path
    EXPECT_EQ(line_.upload(other), TaskStatus::accepted);
    EXPECT_EQ(line_.generator.path().generation(), generation + 1);
    EXPECT_EQ(line_.upload(parts_of(6, line(20, 1.0F))), TaskStatus::accepted);
    EXPECT_EQ(line_.generator.path().generation(), generation + 2);
    EXPECT_EQ(protocol_.upload().task(), 6U);
    // Task 0 is a number as any other, and nothing before the first.
    const auto fresh = std::make_unique<Line>();
    TaskUpload zero = parts_of(0, line(20))[1];
    zero.parts = zero.part = 0;
    EXPECT_EQ(fresh->status(zero), TaskStatus::inconsistent);
    EXPECT_EQ(fresh->status(parts_of(0, line(20))[1]), TaskStatus::out_of_order);
}

/// Its own speed counts for nothing: it is part of the task that is flown.
TEST_F(MissionEdges, AContinuationKeepsTheSpeedOfTheTaskThatIsFlown)
{
    const auto flown_speed = [](Line& on) {
        vehicle::VehicleState at;
        at.position = Vec3(5, 0, 0);
        at.velocity = Vec3(1, 0, 0);
        return on.generator.step(at, on.now, false).velocity.norm();
    };
    ASSERT_EQ(line_.upload(parts_of(5, line(20), 0, 0.5F)), TaskStatus::accepted);
    const float speed = flown_speed(line_);
    EXPECT_GT(speed, 0.1F);
    EXPECT_EQ(line_.upload(parts_of(6, line(20, 19.0F), kContinues | kLast, 3.0F)), TaskStatus::accepted);
    EXPECT_EQ(line_.generator.path().generation(), 1U) << "one path";
    EXPECT_TRUE(line_.generator.path().is_complete());
    EXPECT_EQ(flown_speed(line_), speed);
    EXPECT_EQ(line_.upload(parts_of(7, line(20, 38.0F), kContinues, 3.0F)), TaskStatus::busy);
    // Where nothing is flown it begins a path of its own.
    const auto fresh = std::make_unique<Line>();
    EXPECT_EQ(fresh->upload(parts_of(6, line(20), kContinues | kLast, 1.0F)), TaskStatus::accepted);
    EXPECT_GT(flown_speed(*fresh), speed + 0.1F);
}

}  // namespace
}  // namespace jink::app::test
