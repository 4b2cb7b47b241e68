// SPDX-License-Identifier: BSD-3-Clause
// The co-processor's belief in every second of recorded streams of real autopilots, against the records of their ground
// stations and simulators: true positions, modes, homes.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <set>

#include "tests/replay/recording.hpp"

namespace jink::replay_test {
namespace {

/// The autopilots' estimators lie this far from the truth at most [m]: 0.47 m in all recordings, of which GPS noise.
constexpr double kEstimator = 0.75;
/// HEARTBEATs come once a second, and the ground station's clock is read some time later [s].
constexpr double kHeartbeatPeriod = 1.2;

class Beliefs : public testing::TestWithParam<std::string> {
protected:
    void SetUp() override
    {
        recording_ = find_recording(GetParam());
        if (recording_ == nullptr) {
            GTEST_SKIP() << GetParam() << " is not part of this repository; say with JINK_RECORDINGS where it is";
        }
        ASSERT_EQ(recording_->wire.fault, "");
        ASSERT_GT(recording_->truth.size(), 30U);
    }

    /// A frame of this message came within `age` before `time`.
    [[nodiscard]] bool fresh(std::uint32_t message, double time, double age) const
    {
        const RawFrame* const frame = recording_->newest(message, time);
        return frame != nullptr && time - frame->time <= age;
    }

    const Recording* recording_ = nullptr;
};

TEST_P(Beliefs, OwnPositionIsTheTrueOne)
{
    unsigned seconds = 0;
    for (const sim::Belief& belief : beliefs_of(*recording_)) {
        const auto truth = recording_->truth_at(belief.time);
        if (!truth || !belief.position) {
            continue;
        }
        ++seconds;
        EXPECT_LT((*belief.position - truth->position).norm(), kEstimator) << belief.time << " s";
    }
    EXPECT_GT(seconds, 60U);
}

TEST_P(Beliefs, OwnPositionIsKnownWhileItIsStreamed)
{
    for (const sim::Belief& belief : beliefs_of(*recording_)) {
        // Streamed for a second without a pause: data after a pause may be old.
        bool streamed = true;
        for (double back = 0.0; back < 1.0; back += 0.2) {
            streamed = streamed && fresh(kLocalPositionId, belief.time - back, 0.2) &&
                       fresh(kHeartbeatId, belief.time, kHeartbeatPeriod);
        }
        if (streamed) {
            EXPECT_TRUE(belief.position && belief.velocity) << belief.time << " s";
        }
        if (!fresh(kLocalPositionId, belief.time, 1.5)) {
            EXPECT_FALSE(belief.position) << belief.time << " s: too old to be believed";
        }
    }
}

TEST_P(Beliefs, OwnVelocityIsTheTrueOne)
{
    // Between true points, a second apart, the truth is known within the interpolation error of 5 m/s2; at them
    // exactly.
    for (const sim::Belief& belief : beliefs_of(*recording_)) {
        const auto truth = recording_->truth_at(belief.time);
        if (truth && belief.velocity) {
            EXPECT_LT((*belief.velocity - truth->velocity).norm(), 1.5) << belief.time << " s";
        }
    }
}

TEST_P(Beliefs, ModeAndArmingAreTheGroundStations)
{
    unsigned seconds = 0;
    for (const sim::Belief& belief : beliefs_of(*recording_)) {
        const RawFrame* const heartbeat = recording_->newest(kHeartbeatId, belief.time);
        if (heartbeat == nullptr || !belief.mode) {
            EXPECT_FALSE(fresh(kHeartbeatId, belief.time, kHeartbeatPeriod)) << belief.time << " s";
            continue;
        }
        // This HEARTBEAT's mode; the ground station's own HEARTBEAT may show it a second later.
        std::set<std::string> names;
        std::set<bool> armed;
        for (const SeenMode& mode : recording_->modes) {
            if (mode.time < heartbeat->time - 0.15) {
                names.clear();
                armed.clear();
            }
            if (mode.time < heartbeat->time + kHeartbeatPeriod) {
                names.insert(mode.name);
                armed.insert(mode.armed);
            }
        }
        if (names.empty()) {
            continue;
        }
        ++seconds;
        EXPECT_EQ(names.count(*belief.mode), 1U) << belief.time << " s: " << *belief.mode << ", not " << *names.begin();
        EXPECT_EQ(armed.count(*belief.armed), 1U) << belief.time << " s: " << *belief.armed;
    }
    EXPECT_TRUE(seconds > 60U || recording_->modes.empty());
}

TEST_P(Beliefs, StackAndVehicleAreRight)
{
    const bool px4 = GetParam().rfind("px4", 0) == 0;
    for (const sim::Belief& belief : beliefs_of(*recording_)) {
        if (recording_->newest(kHeartbeatId, belief.time - 0.02) != nullptr) {
            EXPECT_EQ(belief.stack, px4 ? sim::Stack::px4 : sim::Stack::ardupilot) << belief.time << " s";
            EXPECT_EQ(belief.vehicle, 2U) << belief.time << " s";
        }
    }
}

TEST_P(Beliefs, ControlIsOursOnlyInTheExternalMode)
{
    for (const sim::Belief& belief : beliefs_of(*recording_)) {
        const bool external = belief.mode == "GUIDED" || belief.mode == "OFFBOARD";
        if (belief.control == "ours" || belief.control == "returning") {
            EXPECT_TRUE(external) << belief.time << " s: " << belief.mode.value_or("none");
        }
    }
}

TEST_P(Beliefs, TracksAreTheAircraftThatAreHeard)
{
    for (const sim::Belief& belief : beliefs_of(*recording_)) {
        std::set<std::uint32_t> now;
        std::set<std::uint32_t> lately;
        for (const RawFrame& frame : recording_->frames) {
            if (frame.message == kAdsbId && frame.time <= belief.time && frame.time > belief.time - 20.0) {
                std::uint32_t address = 0;
                std::memcpy(&address, frame.payload.data(), sizeof address);
                lately.insert(address);
                if (frame.system == 1 && frame.time > belief.time - 1.0 && frame.time < belief.time - 0.1) {
                    now.insert(address);
                }
            }
        }
        if (belief.position) {
            EXPECT_GE(belief.tracks, now.size()) << belief.time << " s";
        }
        EXPECT_LE(belief.tracks, lately.size()) << belief.time << " s";
    }
}

/// Where home truly is comes from its latitude, longitude and altitude.
/// @return how far the belief lies from it [m]; nothing while home or origin were not received
std::optional<double> home_error(const Recording& recording, const sim::Belief& belief)
{
    const RawFrame* const home = recording.newest(kHomeId, belief.time - 0.02);
    if (home == nullptr || !belief.home) {
        return std::nullopt;
    }
    const std::array<std::int32_t, 3> place = place_in(*home);
    return local_of({belief.home->lat, belief.home->lon, belief.home->alt}, place).norm();
}

TEST_P(Beliefs, HomeIsKnownOnceItWasReceived)
{
    for (const sim::Belief& belief : beliefs_of(*recording_)) {
        const bool streamed = fresh(kHomeId, belief.time - 0.02, 5.5) && fresh(kOriginId, belief.time - 0.02, 1e6) &&
                              fresh(kLocalPositionId, belief.time, 0.5);
        if (streamed) {
            EXPECT_TRUE(belief.home) << belief.time << " s";
        }
        if (recording_->newest(kHomeId, belief.time) == nullptr) {
            EXPECT_FALSE(belief.home) << belief.time << " s";
        }
    }
}

TEST_P(Beliefs, HomeOfAnArmedVehicleIsWhereItsLatitudeLongitudeAndAltitudeAre)
{
    for (const sim::Belief& belief : beliefs_of(*recording_)) {
        if (const auto error = home_error(*recording_, belief); error && belief.armed == true) {
            EXPECT_LT(*error, 0.05) << belief.time << " s";
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Recordings, Beliefs, testing::ValuesIn(recording_names()),
                         [](const auto& name) { return name.param; });

}  // namespace
}  // namespace jink::replay_test
