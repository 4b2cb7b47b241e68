// SPDX-License-Identifier: BSD-3-Clause
#include "tests/target/board/full_line.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/random.hpp"
#include "firmware/app/parameters.hpp"
#include "firmware/link/mavlink/catalogue.hpp"
#include "firmware/link/mavlink/checksum.hpp"
#include "toolchain/sim/scenario_file.hpp"

namespace jink::target {

using namespace link::mavlink;

namespace {

constexpr std::uint8_t kJink = 196;
// Per second; kMaxUnread bytes bring at most 11 of the 16 parameters that fit into a step, 6 of 8 commands, one
// scan.
constexpr double kParams = 300.0;
constexpr double kCommands = 130.0;
constexpr double kTimesyncs = 900.0;
constexpr double kScans = 10.0;

constexpr std::size_t kLengthAt = 1;
constexpr std::size_t kSequenceAt = 4;
constexpr std::size_t kIdAt = 7;

std::size_t size_of(std::span<const std::byte> frame)
{
    return kHeaderV2 + std::to_integer<std::size_t>(frame[kLengthAt]) + kChecksumSize;
}

}  // namespace

sim::Scenario crowd_for(double seconds)
{
    constexpr int kAircraft = 32;
    Random random(20);
    const auto between = [&random](double low, double high) {
        return low + (high - low) * static_cast<double>(random.uniform());
    };
    sim::Scenario s;
    s.name = "full_line";
    s.duration = seconds + 10.0;
    s.mission = {sim::Vec(0, 0, 40), sim::Vec(s.vehicle.cruise * s.duration, 0, 40)};
    s.start_position = s.mission[0];
    s.start_velocity = sim::Vec(s.vehicle.cruise, 0, 0);
    for (int i = 0; i < kAircraft; ++i) {
        sim::Threat threat;
        threat.name = std::string("aircraft_").append(std::to_string(i + 1));
        const double meets_at = 4.0 + seconds * i / kAircraft;
        const double course = between(-std::numbers::pi, std::numbers::pi);
        threat.velocity = between(3.0, 8.0) * sim::Vec(std::cos(course), std::sin(course), between(-0.1, 0.1));
        threat.position = s.start_position + s.start_velocity * meets_at - threat.velocity * meets_at;
        s.threats.push_back(threat);
    }
    sim::default_radii(s);
    sim::default_noise(s);
    s.parameters.clear();
    return s;
}

bool FullLine::due(double rate, std::uint32_t sent) const noexcept
{
    const double time = static_cast<double>(bytes_) / kLineBytesPerSecond;
    return static_cast<double>(sent) < rate * time;
}

/// Sets the sequence number and then the checksum.
void FullLine::add(std::span<const std::byte> frame)
{
    std::vector<std::byte> numbered(frame.begin(), frame.end());
    numbered[kSequenceAt] = std::byte{sequences_[{numbered[kSequenceAt + 1], numbered[kSequenceAt + 2]}]++};
    std::uint32_t id = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        id |= std::to_integer<std::uint32_t>(numbered[kIdAt + i]) << (8U * i);
    }
    Checksum checksum;
    checksum.add(std::span<const std::byte>(numbered).subspan(1, numbered.size() - 1 - kChecksumSize));
    checksum.add(std::byte{find_message(id)->crc_extra});
    numbered[numbered.size() - 2] = static_cast<std::byte>(checksum.value() & 0xFFU);
    numbered[numbered.size() - 1] = static_cast<std::byte>(checksum.value() >> 8U);
    waiting_.insert(waiting_.end(), numbered.begin(), numbered.end());
    bytes_ += numbered.size();
    ++frames_;
}

void FullLine::add_telemetry()
{
    const std::size_t n = size_of(telemetry_);
    const auto payload = std::span<const std::byte>(telemetry_).subspan(kHeaderV2, 8);
    const bool asks_time = std::to_integer<std::uint32_t>(telemetry_[kIdAt]) == Timesync::kInfo.id &&
                           std::all_of(payload.begin(), payload.end(), [](std::byte b) { return b == std::byte{0}; });
    requests_.own_timesyncs += asks_time ? 1U : 0U;
    add({telemetry_.data(), n});
    telemetry_.erase(telemetry_.begin(), telemetry_.begin() + static_cast<std::ptrdiff_t>(n));
}

/// Something within 12 to 28 m in every sector, another place in each scan.
void FullLine::add_scan()
{
    ObstacleDistance scan;
    scan.time_usec = static_cast<std::uint64_t>(plant_.now());
    scan.min_distance = 20;
    scan.max_distance = 3000;
    scan.increment = 5;
    scan.increment_f = 5.0F;
    scan.frame = 12;  // body
    for (std::size_t i = 0; i < scan.distances.size(); ++i) {
        scan.distances[i] = static_cast<std::uint16_t>(1200U + (i * 370U + scans_ * 13U) % 1600U);
    }
    ++scans_;
    write(scan, sim::kRangefinder);
}

/// All of its fields, so that none of its bytes is cut; stamped since 1970, which counts as just arrived.
void FullLine::add_odometry()
{
    const sim::Truth& own = plant_.world().own();
    Odometry m;
    m.time_usec = 1'700'000'000'000'000ULL + static_cast<std::uint64_t>(plant_.now());
    m.x = static_cast<float>(own.position.y());
    m.y = static_cast<float>(own.position.x());
    m.z = static_cast<float>(-own.position.z());
    m.vx = static_cast<float>(own.velocity.y());
    m.vy = static_cast<float>(own.velocity.x());
    m.vz = static_cast<float>(-own.velocity.z());
    const double half = 0.5 * (0.5 * std::numbers::pi - own.yaw);
    m.q = {static_cast<float>(std::cos(half)), 0.0F, 0.0F, static_cast<float>(std::sin(half))};
    m.pose_covariance.fill(0.001F);
    m.velocity_covariance.fill(0.001F);
    m.frame_id = m.child_frame_id = 1;  // local NED
    m.estimator_type = 3;
    m.quality = 100;
    write(m, sim::kAutopilot);
}

void FullLine::add_next()
{
    while (static_cast<double>(plant_.now()) * 1e-6 <= static_cast<double>(bytes_) / kLineBytesPerSecond) {
        plant_.step();
        const std::vector<std::byte> fresh = plant_.collect();
        telemetry_.insert(telemetry_.end(), fresh.begin(), fresh.end());
    }
    // HEARTBEAT first: the board answers nothing before receiving it. Bursts of telemetry come last, so that requests
    // stay spread out.
    if (frames_ == 0) {
        add_telemetry();
    } else if (due(kTimesyncs, requests_.timesyncs)) {
        ++requests_.timesyncs;
        write(Timesync{0, kPlaceMark + static_cast<std::int64_t>(bytes_), 0, 0}, sim::kAutopilot);
    } else if (due(kScans, scans_)) {
        add_scan();
    } else if (due(kParams, requests_.params)) {
        ParamRequestRead read;
        read.param_index = static_cast<std::int16_t>(requests_.params++ % app::kParamCount);
        read.target_system = sim::kAutopilot.system;
        read.target_component = kJink;
        write(read, sim::kGroundStation);
    } else if (due(kCommands, requests_.commands)) {
        ++requests_.commands;
        CommandLong command;  // a message that is not sent on request: denied, and therefore answered
        command.command = 512;
        command.param1 = 1.0F;
        command.target_system = sim::kAutopilot.system;
        command.target_component = kJink;
        write(command, sim::kGroundStation);
    } else if (!telemetry_.empty()) {
        add_telemetry();
    } else {
        add_odometry();
    }
}

std::span<const std::byte> FullLine::ahead(std::size_t n)
{
    while (waiting_.size() < n) {
        add_next();
    }
    return waiting_;
}

void FullLine::take(std::size_t n)
{
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(n));
}

}  // namespace jink::target
