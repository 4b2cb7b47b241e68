// SPDX-License-Identifier: BSD-3-Clause
// How the simulator's vehicles answer set-points, against PX4 in OFFBOARD as it was recorded.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "tests/replay/recording.hpp"
#include "toolchain/sim/truth_vehicle.hpp"

namespace jink::replay_test {
namespace {

constexpr std::uint32_t kSetPointId = 84;
constexpr std::uint32_t kCustomModeOffboard = 6U << 16U;
constexpr double kLine = 0.1;  // [s] from a set-point on the wire to its effect in a report on the wire
constexpr double kDt = 0.005;

/// A velocity in the frame of the world, from one that points north, east and down on the wire.
struct Said {
    double time = 0.0;
    Vec velocity = Vec::Zero();
};
std::vector<Said> velocities_in(const std::vector<RawFrame>& frames, std::uint32_t message, std::size_t at)
{
    std::vector<Said> out;
    for (const RawFrame& frame : frames) {
        if (frame.message == message) {
            std::array<float, 3> ned{};
            std::memcpy(ned.data(), frame.payload.data() + at, sizeof ned);
            out.push_back({frame.time, Vec(ned[1], ned[0], -ned[2])});
        }
    }
    return out;
}

/// The first and the last HEARTBEAT in OFFBOARD.
std::array<double, 2> in_offboard(const Recording& recording)
{
    std::array<double, 2> span{1e9, 0.0};
    for (const RawFrame& frame : recording.frames) {
        std::uint32_t mode = 0;
        std::memcpy(&mode, frame.payload.data(), sizeof mode);
        if (frame.message == kHeartbeatId && frame.component == 1 && mode == kCustomModeOffboard) {
            span = {std::min(span[0], frame.time), std::max(span[1], frame.time)};
        }
    }
    return span;
}

/// Difference between what is flown by the simulator's vehicle and what was recorded: root mean squares [m/s].
struct Off {
    double level = 0.0;
    double vertical = 0.0;
};
Off fly_along(const std::vector<Said>& commands, const std::vector<Said>& flown, std::array<double, 2> span,
              const sim::TruthLimits& limits)
{
    Off off;
    sim::Truth truth;
    std::size_t command = 0;
    std::size_t count = 0;
    double t = 0.0;
    for (const Said& one : flown) {
        if (one.time < span[0] || one.time > span[1]) {
            continue;
        }
        if (count++ == 0) {
            truth.velocity = one.velocity;
            truth.held = sim::held_at(truth.velocity, limits);
            t = one.time;
        }
        for (; t < one.time; t += kDt) {
            while (command + 1 < commands.size() && commands[command + 1].time + kLine <= t) {
                ++command;
            }
            sim::fly(truth, commands[command].velocity, limits, kDt);
        }
        const Vec difference = truth.velocity - one.velocity;
        off.level += difference.head<2>().squaredNorm();
        off.vertical += difference.z() * difference.z();
    }
    const auto n = static_cast<double>(count);
    return {std::sqrt(off.level / n), std::sqrt(off.vertical / n)};
}

/// The largest level change of velocity over half a second [m/s2].
double most_acceleration(const std::vector<Said>& flown, std::array<double, 2> span)
{
    constexpr double kOver = 0.5;
    double most = 0.0;
    std::size_t before = 0;
    for (const Said& one : flown) {
        while (flown[before].time < one.time - kOver) {
            ++before;
        }
        const double took = one.time - flown[before].time;
        if (one.time - kOver > span[0] && one.time < span[1] && took > 0.8 * kOver) {
            most = std::max(most, (one.velocity - flown[before].velocity).head<2>().norm() / took);
        }
    }
    return most;
}

class Response : public testing::TestWithParam<std::string> {};

TEST_P(Response, Px4AnswersInOffboardAsTheVehicleWithDragDoes)
{
    const Recording* const recording = find_recording(GetParam());
    if (recording == nullptr) {
        GTEST_SKIP() << GetParam() << " is not part of this repository; say with JINK_RECORDINGS where it is";
    }
    std::vector<sim::WireRecord> back = recording->wire.records;
    for (sim::WireRecord& record : back) {
        record.direction = record.direction == sim::WireDirection::from_jink ? sim::WireDirection::from_autopilot
                                                                             : sim::WireDirection::from_jink;
    }
    const std::vector<Said> commands = velocities_in(frames_of(back), kSetPointId, 16);
    const std::vector<Said> flown = velocities_in(recording->frames, kLocalPositionId, 16);
    const std::array<double, 2> span = in_offboard(*recording);
    ASSERT_GT(commands.size(), 100U);
    ASSERT_GT(span[1] - span[0], 4.0);
    sim::TruthLimits limits;
    limits.max_acceleration = limits.max_vertical_acceleration = 8.0;
    limits.max_descent = 1.5;  // MPC_Z_VEL_MAX_DN
    const Off prompt = fly_along(commands, flown, span, limits);
    limits.drag = sim::kRecordedDrag;
    const Off against_drag = fly_along(commands, flown, span, limits);
    EXPECT_LT(against_drag.level, 0.45) << "a vehicle that reaches every command: " << prompt.level;
    EXPECT_LT(against_drag.level, 0.4 * prompt.level);
    EXPECT_LT(against_drag.vertical, 0.3) << prompt.vertical;
    std::printf("%s: off by %.2f m/s (%.2f if it reached every command), at most %.1f m/s2 over half a second\n",
                GetParam().c_str(), against_drag.level, prompt.level, most_acceleration(flown, span));
}

INSTANTIATE_TEST_SUITE_P(Recordings, Response,
                         testing::Values("px4_multirotor_head_on", "px4_multirotor_crossing",
                                         "px4_multirotor_overtaking_items_in_order"));

}  // namespace
}  // namespace jink::replay_test
