// SPDX-License-Identifier: BSD-3-Clause
#include "core/path/prediction.hpp"

#include <array>
#include <cmath>

#include "core/base/work_units.hpp"
#include "core/path/flight.hpp"

namespace jink::path {
namespace {

/// Periods of the first two chords.
constexpr std::array<std::uint32_t, 2> kFirstChords{1, 2};
constexpr std::uint32_t kInFirstChords = kFirstChords[0] + kFirstChords[1];

/// Periods of each chord after the first two, so that `setpoints` fit into `most` points.
std::uint32_t chord_length(std::uint32_t setpoints, Seconds step, std::size_t most) noexcept
{
    constexpr float kRounding = 1e-3F;
    const float wanted = std::clamp(step / kSetpointPeriod + kRounding, 1.0F, static_cast<float>(kMaxSetpoints));
    const auto chords = static_cast<std::uint32_t>(std::clamp<std::size_t>(most, 4, kMaxPathPoints) - 3);
    const std::uint32_t left = setpoints > kInFirstChords ? setpoints - kInFirstChords : 0;
    return std::max(static_cast<std::uint32_t>(wanted), (left + chords - 1) / chords);
}

}  // namespace

void ChordWriter::fly(const Vec3& command, Seconds dt) noexcept
{
    const Vec3 goal = vehicle::detail::goal_of(command, velocity_, limits_);
    const Vec3 error = velocity_ - goal;
    note_acceleration(error);
    vehicle::detail::decay_to(goal, error, position_, velocity_, limits_, dt, fading_);
}

void ChordWriter::end_chord(Seconds time) noexcept
{
    constexpr float kChord = 1.0F / 8.0F;
    PathPoint& last = out_.path.points.back();
    const Seconds dt = time - last.time;
    last.velocity = (position_ - last.position) / dt;
    out_.sagittas.unchecked_push_back(
        {kChord * dt * dt * std::sqrt(squared_any_), kChord * dt * dt * std::sqrt(squared_vertical_)});
    out_.path.points.unchecked_push_back({position_, last.velocity, time});
    out_.velocity = velocity_;
    squared_any_ = squared_vertical_ = 0.0F;
}

std::uint32_t setpoints_of(Seconds rest) noexcept
{
    const float count = std::ceil(rest / kSetpointPeriod);
    if (!(count > 0.0F)) {
        return 0;
    }
    return count < static_cast<float>(kMaxSetpoints) ? static_cast<std::uint32_t>(count) : kMaxSetpoints;
}

bool predict_flight(const vehicle::VehicleState& state, const TimedPath& path, Seconds start, Seconds step,
                    const vehicle::VehicleLimits& limits, const FollowerGains& gains, std::size_t most,
                    WorkBudget& budget, Prediction& out) noexcept
{
    ChordWriter writer(limits, out);
    writer.begin(state);
    const std::uint32_t setpoints = setpoints_of(path.duration() - start);
    if (setpoints == kMaxSetpoints) {
        budget.exhaust();
        return false;
    }
    const std::uint32_t length = chord_length(setpoints, step, most);
    std::size_t next = 1;
    std::size_t next_ahead = 1;
    std::size_t chord = 0;
    std::uint32_t end = 0;
    for (std::uint32_t i = 0; i < setpoints; ++i) {
        if (i == end) {
            end = std::min(i + (chord < std::size(kFirstChords) ? kFirstChords[chord] : length), setpoints);
            ++chord;
            if (!budget.spend((end - i) * units::kFlightPart)) {
                return false;
            }
        }
        const Seconds t = start + static_cast<float>(i) * kSetpointPeriod;
        const Seconds ahead = t + limits.velocity_lag;
        next = detail::next_after(path, next, t);
        next_ahead = detail::next_after(path, next_ahead, ahead);
        writer.fly(detail::command(path, t, next, ahead, next_ahead, writer.position(), limits, gains),
                   kSetpointPeriod);
        if (i + 1 == end) {
            writer.end_chord(static_cast<float>(end) * kSetpointPeriod);
        }
    }
    return true;
}

void extend_by_velocity_command(const Vec3& command, Seconds horizon, Seconds step,
                                const vehicle::VehicleLimits& limits, Prediction& out) noexcept
{
    ChordWriter writer(limits, out);
    const Seconds begin = out.path.duration();
    const detail::Steps steps(horizon, step, kMaxPathPoints - 1);
    Seconds from = 0.0F;
    for (std::size_t i = 1; i <= steps.count && !out.path.points.full(); ++i) {
        const Seconds to = steps.end_of(i);
        writer.fly(command, to - from);
        writer.end_chord(begin + to);
        from = to;
    }
}

void predict_velocity_command(const vehicle::VehicleState& state, const Vec3& command, Seconds horizon, Seconds step,
                              const vehicle::VehicleLimits& limits, Prediction& out) noexcept
{
    ChordWriter(limits, out).begin(state);
    for (const std::uint32_t periods : kFirstChords) {
        const Seconds chord = std::min(static_cast<float>(periods) * kSetpointPeriod, step);
        const Seconds left = horizon - out.path.duration();
        if (left > chord) {
            extend_by_velocity_command(command, chord, chord, limits, out);
        }
    }
    extend_by_velocity_command(command, horizon - out.path.duration(), step, limits, out);
}

}  // namespace jink::path
