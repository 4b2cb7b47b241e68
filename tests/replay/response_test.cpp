// SPDX-License-Identifier: BSD-3-Clause
// How vehicles of the simulator and of core/vehicle answer set-points, against PX4 in OFFBOARD and ArduCopter in GUIDED
// as they were recorded.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>

#include "core/vehicle/vehicle.hpp"
#include "tests/replay/recording.hpp"
#include "toolchain/sim/truth_vehicle.hpp"

namespace jink::replay_test {
namespace {

constexpr std::uint32_t kSetPointId = 84;
constexpr std::uint32_t kOffboard = 6U << 16U;
constexpr std::uint32_t kGuided = 4;
constexpr double kLine = 0.1;      // [s] from a set-point on the wire to its effect in a report on the wire
constexpr double kStreamed = 0.5;  // older set-points are those of a stream that has ended [s]
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

/// Set-points and the velocities that were reported of one recording.
struct Flight {
    std::vector<Said> commands;
    std::vector<Said> flown;  ///< in the external mode, under a stream of set-points
};

/// Whether the autopilot's HEARTBEATs before and after a time were both in this mode.
class ModeAt {
public:
    ModeAt(const std::vector<RawFrame>& frames, std::uint32_t mode)
    {
        for (const RawFrame& frame : frames) {
            if (frame.message == kHeartbeatId && frame.component == 1) {
                std::uint32_t custom_mode = 0;
                std::memcpy(&custom_mode, frame.payload.data(), sizeof custom_mode);
                modes_[frame.time] = custom_mode == mode;
            }
        }
    }
    [[nodiscard]] bool operator()(double time) const
    {
        const auto after = modes_.upper_bound(time);
        return after != modes_.begin() && after != modes_.end() && std::prev(after)->second && after->second;
    }

private:
    std::map<double, bool> modes_;
};

Flight flight_of(const Recording& recording, std::uint32_t mode)
{
    std::vector<sim::WireRecord> back = recording.wire.records;
    for (sim::WireRecord& record : back) {
        record.direction = record.direction == sim::WireDirection::from_jink ? sim::WireDirection::from_autopilot
                                                                             : sim::WireDirection::from_jink;
    }
    Flight flight{velocities_in(frames_of(back), kSetPointId, 16), {}};
    const ModeAt in_mode(recording.frames, mode);
    std::size_t command = 0;
    for (const Said& one : velocities_in(recording.frames, kLocalPositionId, 16)) {
        while (command + 1 < flight.commands.size() && flight.commands[command + 1].time + kLine <= one.time) {
            ++command;
        }
        const double age = flight.commands.empty() ? -1.0 : one.time - flight.commands[command].time;
        if (age >= kLine && age < kStreamed && in_mode(one.time)) {
            flight.flown.push_back(one);
        }
    }
    return flight;
}

/// Difference between what is flown by a vehicle and what was recorded: root mean squares [m/s].
struct Off {
    double level = 0.0;
    double vertical = 0.0;
};
/// @param begin  puts the vehicle at a velocity
/// @param fly    gives its velocity after kDt under a command
template <class Begin, class Fly>
Off fly_along(const Flight& flight, const Begin& begin, const Fly& fly)
{
    Off off;
    std::size_t command = 0;
    std::size_t count = 0;
    double t = -1e9;
    Vec velocity = Vec::Zero();
    for (const Said& one : flight.flown) {
        if (one.time - t > kStreamed) {
            begin(one.velocity);
            velocity = one.velocity;
            t = one.time;
        }
        for (; t < one.time; t += kDt) {
            while (command + 1 < flight.commands.size() && flight.commands[command + 1].time + kLine <= t) {
                ++command;
            }
            velocity = fly(flight.commands[command].velocity);
        }
        ++count;
        const Vec difference = velocity - one.velocity;
        off.level += difference.head<2>().squaredNorm();
        off.vertical += difference.z() * difference.z();
    }
    const auto n = static_cast<double>(count);
    return {std::sqrt(off.level / n), std::sqrt(off.vertical / n)};
}

/// The simulator's vehicle.
Off fly_along(const Flight& flight, const sim::TruthLimits& limits)
{
    sim::Truth truth;
    return fly_along(
        flight,
        [&](const Vec& velocity) {
            truth = {};
            truth.velocity = velocity;
            truth.held = sim::held_at(velocity, limits);
        },
        [&](const Vec& command) {
            sim::fly(truth, command, limits, kDt);
            return truth.velocity;
        });
}

/// The vehicle that jink predicts.
Off fly_along(const Flight& flight, const vehicle::VehicleLimits& limits)
{
    vehicle::VehicleState state;
    return fly_along(
        flight, [&](const Vec& velocity) { state.velocity = velocity.cast<float>(); },
        [&](const Vec& command) {
            vehicle::advance(state, command.cast<float>(), limits, static_cast<float>(kDt));
            return Vec(state.velocity.cast<double>());
        });
}

/// The largest change of velocity over half a second, level and vertical [m/s2].
struct Acceleration {
    double level = 0.0;
    double vertical = 0.0;
};
Acceleration most_acceleration(const std::vector<Said>& flown)
{
    constexpr double kOver = 0.5;
    Acceleration most;
    std::size_t before = 0;
    for (const Said& one : flown) {
        while (flown[before].time < one.time - kOver) {
            ++before;
        }
        const double took = one.time - flown[before].time;
        if (took > 0.8 * kOver) {
            const Vec change = one.velocity - flown[before].velocity;
            most.level = std::max(most.level, change.head<2>().norm() / took);
            most.vertical = std::max(most.vertical, std::abs(change.z()) / took);
        }
    }
    return most;
}

double fastest_descent(const std::vector<Said>& flown)
{
    double most = 0.0;
    for (const Said& one : flown) {
        most = std::max(most, -one.velocity.z());
    }
    return most;
}

class Px4Response : public testing::TestWithParam<std::string> {};

TEST_P(Px4Response, Px4AnswersInOffboardAsTheVehicleWithDragDoes)
{
    const Recording* const recording = find_recording(GetParam());
    if (recording == nullptr) {
        GTEST_SKIP() << GetParam() << " is not part of this repository; say with JINK_RECORDINGS where it is";
    }
    const Flight flight = flight_of(*recording, kOffboard);
    ASSERT_GT(flight.flown.size(), 100U);
    sim::TruthLimits limits;
    sim::answer_as_px4(limits);
    const Off against_drag = fly_along(flight, limits);
    limits.drag = 0.0;
    const Off prompt = fly_along(flight, limits);
    EXPECT_LT(against_drag.level, 0.45) << "a vehicle that reaches every command: " << prompt.level;
    EXPECT_LT(against_drag.level, 0.4 * prompt.level);
    EXPECT_LT(against_drag.vertical, 0.3) << prompt.vertical;
    std::printf("%s: off by %.2f m/s (%.2f if it reached every command), at most %.1f m/s2 over half a second\n",
                GetParam().c_str(), against_drag.level, prompt.level, most_acceleration(flight.flown).level);
}

INSTANTIATE_TEST_SUITE_P(Recordings, Px4Response,
                         testing::Values("px4_multirotor_head_on", "px4_multirotor_crossing",
                                         "px4_multirotor_overtaking_items_in_order"));

class ArduCopterResponse : public testing::TestWithParam<std::string> {};

TEST_P(ArduCopterResponse, ArduCopterAnswersInGuidedAsItsParametersSay)
{
    const Recording* const recording = find_recording(GetParam());
    if (recording == nullptr) {
        GTEST_SKIP() << GetParam() << " is not part of this repository; say with JINK_RECORDINGS where it is";
    }
    const Flight flight = flight_of(*recording, kGuided);
    ASSERT_GT(flight.flown.size(), 100U);
    const Off delivered = fly_along(flight, vehicle::VehicleLimits());
    vehicle::VehicleLimits reported;
    reported.max_acceleration = 2.5F;
    reported.max_vertical_acceleration = 1.0F;
    reported.velocity_lag = 0.6F;
    const Off believed = fly_along(flight, reported);
    sim::TruthLimits truth;
    sim::answer_as_arducopter(truth);
    const Off simulated = fly_along(flight, truth);
    EXPECT_LT(believed.level, 0.45 * delivered.level) << delivered.level;
    EXPECT_LT(simulated.level, 0.45 * delivered.level) << delivered.level;
    EXPECT_LT(believed.vertical, std::max(0.01, delivered.vertical));
    EXPECT_LT(simulated.vertical, std::max(0.01, delivered.vertical));
    std::printf("%s: off by %.2f m/s level and %.2f m/s vertically (%.2f and %.2f by the parameters as delivered), the "
                "simulator's by %.2f and %.2f; descends by up to %.1f m/s, changes it by up to %.1f m/s2\n",
                GetParam().c_str(), believed.level, believed.vertical, delivered.level, delivered.vertical,
                simulated.level, simulated.vertical, fastest_descent(flight.flown),
                most_acceleration(flight.flown).vertical);
}

INSTANTIATE_TEST_SUITE_P(Recordings, ArduCopterResponse,
                         testing::Values("arducopter_10_m_s", "arducopter_cable_pulled", "arducopter_companion_killed",
                                         "arducopter_first_leg", "arducopter_off_leg", "arducopter_pilot_takes_over",
                                         "arducopter_reboot", "arducopter_takeoff_item", "arducopter_three_encounters",
                                         "arducopter_wall"));

}  // namespace
}  // namespace jink::replay_test
