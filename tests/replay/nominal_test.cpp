// SPDX-License-Identifier: BSD-3-Clause
// The co-processor's nominal path of a recorded vehicle, against the mission items in the recording and the vehicle's
// true motion.
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <map>

#include "firmware/link/mavlink/encoder.hpp"
#include "tests/replay/recording.hpp"
#include "toolchain/sim/recorded_mission.hpp"

namespace jink::replay_test {
namespace {

constexpr std::uint32_t kMissionCurrentId = 42;
constexpr std::uint32_t kMissionItemId = 73;
constexpr std::uint16_t kWaypointCommand = 16;

template <class T>
T field(const RawFrame& frame, std::size_t at)
{
    T value;
    std::memcpy(&value, frame.payload.data() + at, sizeof value);
    return value;
}

class Nominal : public testing::TestWithParam<std::string> {
protected:
    void SetUp() override
    {
        recording_ = find_recording(GetParam());
        if (recording_ == nullptr) {
            GTEST_SKIP() << GetParam() << " is not part of this repository; say with JINK_RECORDINGS where it is";
        }
    }
    /// Items of these numbers, anywhere in the recording: its missions do not change in flight.
    [[nodiscard]] std::map<std::uint16_t, const RawFrame*> waypoints() const
    {
        std::map<std::uint16_t, const RawFrame*> found;
        for (const RawFrame& frame : recording_->frames) {
            if (frame.message == kMissionItemId && field<std::uint16_t>(frame, 30) == kWaypointCommand) {
                found[field<std::uint16_t>(frame, 28)] = &frame;
            }
        }
        return found;
    }
    [[nodiscard]] static bool flies_mission(const sim::Belief& belief)
    {
        return belief.armed == true && (belief.mode == "AUTO" || belief.mode == "MISSION");
    }

    const Recording* recording_ = nullptr;
};

TEST_P(Nominal, ARouteEndsAtTheCurrentItem)
{
    const auto items = waypoints();
    const RawFrame* const origin = recording_->newest(kOriginId, 1e9);
    unsigned seconds = 0;
    unsigned routes = 0;
    for (const sim::Belief& belief : beliefs_of(*recording_)) {
        const RawFrame* const current = recording_->newest(kMissionCurrentId, belief.time - 0.02);
        if (!flies_mission(belief) || !belief.nominal || current == nullptr || origin == nullptr) {
            continue;
        }
        const auto item = items.find(field<std::uint16_t>(*current, 0));
        seconds += item != items.end() ? 1U : 0U;
        if (!belief.nominal->is_route || item == items.end()) {
            continue;
        }
        ++routes;
        const std::array<double, 3> place{field<std::int32_t>(*item->second, 16) * 1e-7,
                                          field<std::int32_t>(*item->second, 20) * 1e-7, 0.0};
        const Vec truth = local_of(place, place_in(*origin));
        // ArduPilot and PX4 place on spheres whose radii differ by 0.11 %; the product knows one of them.
        const double sphere = 1.2e-3 * truth.head<2>().norm();
        EXPECT_LT((belief.nominal->end - truth).head<2>().norm(), 0.1 + sphere) << belief.time << " s";
    }
    // ArduPilot's item is compared anew at each switch, and belief returns a second after the motion agrees.
    EXPECT_GE(routes + 4, seconds * 9 / 10) << routes << " of " << seconds << " seconds";
}

TEST_P(Nominal, OutsideOfTheMissionThereIsNoRoute)
{
    for (const sim::Belief& belief : beliefs_of(*recording_)) {
        if (belief.nominal && belief.mode && belief.control == "autopilot" && !flies_mission(belief)) {
            const bool external = belief.mode == "GUIDED" || belief.mode == "OFFBOARD";
            EXPECT_TRUE(!belief.nominal->is_route || external) << belief.time << " s: " << *belief.mode;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Recordings, Nominal, testing::ValuesIn(recording_names()),
                         [](const auto& name) { return name.param; });

// RecordedMission on records made here.

template <class M>
sim::WireRecord record_of(double time, const M& message)
{
    sim::WireRecord record{time, sim::WireDirection::from_autopilot, std::vector<std::byte>(300)};
    record.bytes.resize(link::mavlink::encode(message, {1, 1, 0}, record.bytes));
    return record;
}

sim::WireRecord count_at(double time, std::uint16_t count, std::uint32_t id = 0)
{
    link::mavlink::MissionCount m;
    m.count = count;
    m.opaque_id = id;
    return record_of(time, m);
}

sim::WireRecord item_at(double time, std::uint16_t sequence, std::int32_t x)
{
    link::mavlink::MissionItemInt m;
    m.seq = sequence;
    m.command = kWaypointCommand;
    m.x = x;
    return record_of(time, m);
}

sim::WireRecord current_at(double time, std::uint16_t total, std::uint32_t id = 0)
{
    link::mavlink::MissionCurrent m;
    m.total = total;
    m.mission_id = id;
    return record_of(time, m);
}

TEST(RecordedMissionTest, AnswersWithTheNewestItemElseWithTheFirstOneToCome)
{
    const std::vector<sim::WireRecord> records{count_at(1.0, 2), item_at(2.0, 0, 10), item_at(4.0, 0, 20)};
    const sim::RecordedMission mission(records);
    EXPECT_EQ(mission.item(0, sim::to_micros(1.0))->x, 10);
    EXPECT_EQ(mission.item(0, sim::to_micros(3.0))->x, 10);
    EXPECT_EQ(mission.item(0, sim::to_micros(5.0))->x, 20);
}

TEST(RecordedMissionTest, AnItemThatWasNotRecordedIsNoCommand)
{
    const std::vector<sim::WireRecord> records{count_at(1.0, 2), item_at(2.0, 0, 10)};
    const sim::RecordedMission mission(records);
    ASSERT_TRUE(mission.item(1, 0));
    EXPECT_EQ(mission.item(1, 0)->command, 0);
    EXPECT_EQ(mission.item(1, 0)->seq, 1);
    EXPECT_FALSE(mission.item(2, 0)) << "the mission has two items";
    EXPECT_FALSE(sim::RecordedMission(std::vector<sim::WireRecord>{}).count(0));
}

TEST(RecordedMissionTest, TheAnnouncedMissionCountsAndNotAnEarlierOne)
{
    const std::vector<sim::WireRecord> records{current_at(0.5, 65535), count_at(1.0, 2, 7), item_at(1.5, 0, 10),
                                               current_at(2.0, 3, 9),  count_at(8.0, 3, 9), item_at(8.5, 0, 20)};
    const sim::RecordedMission mission(records);
    EXPECT_EQ(mission.count(sim::to_micros(1.5))->count, 2);
    EXPECT_EQ(mission.count(sim::to_micros(3.0))->count, 3);
    EXPECT_EQ(mission.count(sim::to_micros(3.0))->opaque_id, 9U);
    EXPECT_EQ(mission.item(0, sim::to_micros(3.0))->x, 20);
    EXPECT_EQ(mission.item(1, sim::to_micros(3.0))->command, 0) << "of the announced mission it was not recorded";
}

TEST(RecordedMissionTest, WithoutAnIdTheAnnouncedLengthDecides)
{
    const std::vector<sim::WireRecord> records{count_at(1.0, 1), current_at(2.0, 4), count_at(8.0, 4)};
    const sim::RecordedMission mission(records);
    EXPECT_EQ(mission.count(sim::to_micros(3.0))->count, 4);
}

}  // namespace
}  // namespace jink::replay_test
