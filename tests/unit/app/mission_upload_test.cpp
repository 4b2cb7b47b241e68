// SPDX-License-Identifier: BSD-3-Clause
// Tasks over the mission line (G-ORCA 16: TASK_UPLOAD chunked with CRC, TASK_ACK).
#include "tests/unit/app/mission_bench.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace jink::app::test {
namespace {

class MissionUploadTest : public ::testing::Test {
protected:
    const std::unique_ptr<Line> owned_ = std::make_unique<Line>();
    Line& line_ = *owned_;
    [[nodiscard]] path::GeneratorStatus flown()
    {
        return line_.generator.step(vehicle::VehicleState{}, line_.now, false).status;
    }
};

TEST_F(MissionUploadTest, ATaskOfOnePart)
{
    const auto parts = parts_of(5, line(3));
    ASSERT_EQ(parts.size(), 1U);
    const TaskAck ack = line_.ack(parts[0]);
    EXPECT_EQ(ack.task, 5U);
    EXPECT_EQ(ack.next, 1U);
    EXPECT_EQ(static_cast<TaskStatus>(ack.status), TaskStatus::accepted);
    EXPECT_EQ(flown(), path::GeneratorStatus::tracking);
    EXPECT_EQ(line_.protocol.upload().task(), 5U);
}
TEST_F(MissionUploadTest, ATaskOfManyParts)
{
    const auto parts = parts_of(5, line(40));
    ASSERT_EQ(parts.size(), 4U);
    for (std::uint16_t i = 0; i < 3; ++i) {
        const TaskAck ack = line_.ack(parts[i]);
        EXPECT_EQ(static_cast<TaskStatus>(ack.status), TaskStatus::more);
        EXPECT_EQ(ack.next, i + 1);
        EXPECT_EQ(flown(), path::GeneratorStatus::idle) << "nothing partially accepted";
    }
    EXPECT_EQ(line_.status(parts[3]), TaskStatus::accepted);
    EXPECT_NEAR(line_.generator.path().along(line_.generator.path().size() - 1), 39.0F, 1e-3F);
}
/// Whatever is lost, on the way there or back, is sent again and changes nothing twice.
TEST_F(MissionUploadTest, PartsMayComeTwice)
{
    const auto parts = parts_of(5, line(30));
    EXPECT_EQ(line_.status(parts[0]), TaskStatus::more);
    EXPECT_EQ(line_.ack(parts[0]).next, 1U);
    EXPECT_EQ(line_.status(parts[2]), TaskStatus::out_of_order);
    EXPECT_EQ(line_.ack(parts[2]).next, 1U);
    EXPECT_EQ(line_.status(parts[1]), TaskStatus::more);
    EXPECT_EQ(line_.status(parts[2]), TaskStatus::accepted);
    const std::uint32_t generation = line_.generator.path().generation();
    EXPECT_EQ(line_.status(parts[2]), TaskStatus::accepted) << "its answer was lost";
    EXPECT_EQ(line_.status(parts[0]), TaskStatus::accepted);
    EXPECT_EQ(line_.generator.path().generation(), generation);
}
TEST_F(MissionUploadTest, BeginsWithTheFirstPart)
{
    const auto parts = parts_of(5, line(30));
    const TaskAck ack = line_.ack(parts[1]);
    EXPECT_EQ(static_cast<TaskStatus>(ack.status), TaskStatus::out_of_order);
    EXPECT_EQ(ack.next, 0U);
}

/// A wrong CRC refuses the whole; what was flown before goes on.
TEST_F(MissionUploadTest, AWrongChecksumRefusesTheTask)
{
    auto bad = parts_of(5, line(30));
    for (TaskUpload& part : bad) {
        part.crc ^= 1U;
    }
    EXPECT_EQ(line_.upload(bad), TaskStatus::bad_crc);
    EXPECT_EQ(flown(), path::GeneratorStatus::rejected);
    ASSERT_EQ(line_.upload(parts_of(6, line(30))), TaskStatus::accepted);
    bad[0].task = bad[1].task = bad[2].task = 7;
    EXPECT_EQ(line_.upload(bad), TaskStatus::bad_crc);
    EXPECT_EQ(flown(), path::GeneratorStatus::tracking);
    EXPECT_EQ(line_.protocol.upload().task(), 6U);
    // One bit of one coordinate.
    auto turned = parts_of(8, line(30));
    turned[1].position[4] = 1e-6F;
    EXPECT_EQ(line_.upload(turned), TaskStatus::bad_crc);
}
TEST_F(MissionUploadTest, RefusesWhatCannotBe)
{
    const auto with = [&](auto change) {
        TaskUpload part = parts_of(5, line(3))[0];
        change(part);
        return line_.status(part);
    };
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(with([](TaskUpload& p) { p.parts = 0; }), TaskStatus::inconsistent);
    EXPECT_EQ(with([](TaskUpload& p) { p.part = 1; }), TaskStatus::inconsistent);
    EXPECT_EQ(with([](TaskUpload& p) { p.points = 0; }), TaskStatus::inconsistent);
    EXPECT_EQ(with([](TaskUpload& p) { p.points = 13; }), TaskStatus::inconsistent);
    EXPECT_EQ(with([](TaskUpload& p) { p.flags = 4; }), TaskStatus::inconsistent);
    EXPECT_EQ(with([](TaskUpload& p) { p.cruise_speed = 0.0F; }), TaskStatus::inconsistent);
    EXPECT_EQ(with([&](TaskUpload& p) { p.cruise_speed = nan; }), TaskStatus::inconsistent);
    EXPECT_EQ(with([](TaskUpload& p) { p.time_limit = -1.0F; }), TaskStatus::inconsistent);
    EXPECT_EQ(with([&](TaskUpload& p) { p.position[1] = nan; }), TaskStatus::bad_point);
    EXPECT_EQ(with([](TaskUpload& p) { p.position[1] = 1e6F; }), TaskStatus::bad_point);
    EXPECT_EQ(with([](TaskUpload& p) { p.arrival_ms[1] = 0; }), TaskStatus::bad_point);
    EXPECT_EQ(line_.upload(parts_of(5, line(1))), TaskStatus::no_path);
    EXPECT_EQ(flown(), path::GeneratorStatus::rejected);
}
TEST_F(MissionUploadTest, PartsHaveToAgree)
{
    auto parts = parts_of(5, line(30));
    parts[1].cruise_speed = 2.0F;
    EXPECT_EQ(line_.upload(parts), TaskStatus::inconsistent);
    EXPECT_EQ(line_.status(parts[2]), TaskStatus::out_of_order) << "the upload is over";
}
/// Section 18, PATH_TOO_LONG: a zigzag of which every point is needed.
TEST_F(MissionUploadTest, APathThatIsTooLong)
{
    std::vector<Point> zigzag;
    for (std::uint32_t i = 0; i <= kMaxDensePoints; ++i) {
        zigzag.push_back({Vec3(static_cast<float>(i), i % 2 == 0 ? 0.0F : 1.0F, 0), 1000 * i});
    }
    EXPECT_EQ(line_.upload(parts_of(5, zigzag)), TaskStatus::path_too_long);
    zigzag.pop_back();
    EXPECT_EQ(line_.upload(parts_of(6, zigzag)), TaskStatus::accepted);
}
TEST_F(MissionUploadTest, OneTaskAtATime)
{
    const auto first = parts_of(5, line(30));
    const auto second = parts_of(6, line(30));
    EXPECT_EQ(line_.status(first[0]), TaskStatus::more);
    EXPECT_EQ(line_.status(second[0]), TaskStatus::busy);
    EXPECT_EQ(line_.status(first[1]), TaskStatus::more);
    line_.now = line_.now + 5.1F;
    EXPECT_EQ(line_.upload(second), TaskStatus::accepted) << "whoever sent the first has given up";
    EXPECT_EQ(line_.status(first[2]), TaskStatus::out_of_order);
}
/// Streaming: a continuation waits until the one before it has been flown.
TEST_F(MissionUploadTest, ContinuesThePathThatIsFlown)
{
    EXPECT_EQ(line_.upload(parts_of(5, line(20), 0)), TaskStatus::accepted);
    EXPECT_EQ(line_.upload(parts_of(6, line(20, 30.0F), kContinues)), TaskStatus::gap);
    EXPECT_EQ(line_.upload(parts_of(7, line(20, 19.0F), kContinues)), TaskStatus::accepted);
    EXPECT_EQ(line_.upload(parts_of(8, line(20, 38.0F), kContinues | kLast)), TaskStatus::busy);
    EXPECT_EQ(flown(), path::GeneratorStatus::tracking);
    EXPECT_EQ(line_.generator.path().generation(), 1U);
}

/// More parts at once than the queue holds: refused with a status, none lost without a word.
TEST_F(MissionUploadTest, AFullQueueIsTold)
{
    const auto parts = parts_of(5, line(200));
    for (const TaskUpload& part : parts) {
        line_.send(part);
    }
    const auto refused = line_.heard().all<TaskAck>();
    ASSERT_EQ(refused.size(), parts.size() - MissionProtocol::kMostEvents);
    for (const TaskAck& ack : refused) {
        EXPECT_EQ(static_cast<TaskStatus>(ack.status), TaskStatus::queue_full);
    }
    EXPECT_EQ(line_.step().all<TaskAck>().size(), MissionProtocol::kEventsPerStep);
    EXPECT_EQ(line_.step().all<TaskAck>().size(), MissionProtocol::kEventsPerStep);
    EXPECT_EQ(line_.protocol.diagnostics().events_refused, parts.size() - MissionProtocol::kMostEvents);
    std::uint16_t next = MissionProtocol::kMostEvents;
    while (next < parts.size()) {
        next = line_.ack(parts[next]).next;
    }
    EXPECT_EQ(flown(), path::GeneratorStatus::tracking);
}

}  // namespace
}  // namespace jink::app::test
