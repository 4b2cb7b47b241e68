// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/mission_protocol.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/finite.hpp"

namespace jink::app {
namespace {

using namespace link::mission;

[[nodiscard]] Vec3 vector_of(const float* numbers) noexcept { return {numbers[0], numbers[1], numbers[2]}; }

void put_vector(const Vec3& vector, float* numbers) noexcept
{
    for (int i = 0; i < 3; ++i) {
        numbers[i] = vector[i];
    }
}

/// Farther away, or faster, nothing is believed [m], [m/s].
constexpr float kFarthest = 100'000.0F;
constexpr float kFastest = 1000.0F;

[[nodiscard]] bool is_place(const Vec3& position) noexcept
{
    return is_finite(position) && position.cwiseAbs().maxCoeff() <= kFarthest;
}
[[nodiscard]] bool is_velocity(const Vec3& velocity) noexcept
{
    return is_finite(velocity) && velocity.cwiseAbs().maxCoeff() <= kFastest;
}

[[nodiscard]] bool is_possible(const StateNeighbour& state) noexcept
{
    bool possible = is_place(vector_of(state.position.data())) && is_velocity(vector_of(state.velocity.data())) &&
                    is_velocity(vector_of(state.preferred.data())) && is_positive(state.radius_xy) &&
                    is_positive(state.radius_z) && is_positive(state.max_speed) &&
                    is_positive(state.max_acceleration) && is_positive(state.horizon) && is_not_negative(state.act) &&
                    state.act <= 10.0F && is_not_negative(state.lag) && state.commands <= kCommandsPerState;
    for (std::size_t i = 0; possible && i < state.commands; ++i) {
        possible = is_velocity(vector_of(&state.command[3 * i])) &&
                   (i == 0 || state.command_age_ms[i] < state.command_age_ms[i - 1]);
    }
    return possible;
}

[[nodiscard]] TimePoint ago(TimePoint now, std::uint16_t age_ms) noexcept
{
    return {now.us - 1000 * std::int64_t{age_ms}};
}

/// Whole milliseconds from `then` to `now`, rounded up: nothing is told younger than it is.
[[nodiscard]] std::int64_t age_of(TimePoint then, TimePoint now) noexcept
{
    return std::max<std::int64_t>(0, (now.us - then.us + 999) / 1000);
}
[[nodiscard]] std::uint16_t short_age(TimePoint then, TimePoint now) noexcept
{
    return static_cast<std::uint16_t>(std::min<std::int64_t>(age_of(then, now), 65535));
}

template <class T, std::size_t N>
[[nodiscard]] T take_first(StaticVector<T, N>& queue) noexcept
{
    const T first = queue.front();
    std::copy(queue.begin() + 1, queue.end(), queue.begin());
    queue.pop_back();
    return first;
}

}  // namespace

void MissionProtocol::take(const Frame& frame, TimePoint now) noexcept
{
    switch (frame.type) {
    case MessageType::state_own: take_state(unpack<StateOwn>(frame), now); return;
    case MessageType::state_neighbour: take_neighbour(frame.sender, unpack<StateNeighbour>(frame), now); return;
    case MessageType::task_upload:
    case MessageType::trip_ack:
    case MessageType::config:
    case MessageType::map_info: queue_event(frame); return;
    case MessageType::task_ack:
    case MessageType::command:
    case MessageType::mission_report:
    case MessageType::monitor_trip:
    case MessageType::config_ack: break;
    }
    ++diagnostics_.unexpected;
}

void MissionProtocol::take_state(const StateOwn& state, TimePoint now) noexcept
{
    vehicle::VehicleState own;
    own.stamp = ago(now, state.age_ms) - link_delay_;
    own.position = vector_of(state.position.data());
    own.velocity = vector_of(state.velocity.data());
    own.yaw = state.yaw;
    take_own_state(own, now);
}

void MissionProtocol::take_own_state(const vehicle::VehicleState& state, TimePoint now) noexcept
{
    if (state.stamp > now || !is_place(state.position) || !is_velocity(state.velocity) || !std::isfinite(state.yaw)) {
        ++diagnostics_.refused;
        return;
    }
    if (has_own_ && state.stamp <= own_.stamp) {
        ++diagnostics_.older;
        return;
    }
    ++diagnostics_.states;
    has_own_ = true;
    own_ = state;
}

void MissionProtocol::take_preferred(const Vec3& velocity, TimePoint now) noexcept
{
    if (!is_velocity(velocity)) {
        ++diagnostics_.refused;
        return;
    }
    has_preferred_ = true;
    preferred_ = velocity;
    preferred_at_ = now;
}

void MissionProtocol::take_neighbour(std::uint16_t sender, const StateNeighbour& state, TimePoint now) noexcept
{
    if (sender == id_ || !is_possible(state)) {
        ++diagnostics_.refused;
        return;
    }
    MissionNeighbour neighbour;
    orca::Broadcast& heard = neighbour.heard;
    heard.id = sender;
    heard.state.stamp = ago(now, state.age_ms) - link_delay_;
    heard.state.position = vector_of(state.position.data());
    heard.state.velocity = vector_of(state.velocity.data());
    heard.preferred = vector_of(state.preferred.data());
    heard.loop = {state.act, state.lag};
    heard.max_speed = state.max_speed;
    heard.max_acceleration = state.max_acceleration;
    for (std::size_t i = 0; i < state.commands; ++i) {
        heard.commands.unchecked_push_back(
            {ago(now, state.command_age_ms[i]) - link_delay_, vector_of(&state.command[3 * i])});
    }
    neighbour.radius_xy = state.radius_xy;
    neighbour.radius_z = state.radius_z;
    neighbour.horizon = state.horizon;
    neighbour.cooperative = state.cooperative != 0;
    neighbour.arrival = now;
    keep(neighbour);
}

/// Newest wins; when full the farthest goes.
void MissionProtocol::keep(const MissionNeighbour& neighbour) noexcept
{
    const auto distance = [&](const MissionNeighbour& n) { return (n.heard.state.position - own_.position).norm(); };
    MissionNeighbour* farthest = nullptr;
    for (MissionNeighbour& known : neighbours_) {
        if (known.heard.id == neighbour.heard.id) {
            if (neighbour.heard.state.stamp <= known.heard.state.stamp) {
                ++diagnostics_.older;
                return;
            }
            ++diagnostics_.neighbour_states;
            known = neighbour;
            return;
        }
        farthest = farthest == nullptr || distance(known) > distance(*farthest) ? &known : farthest;
    }
    ++diagnostics_.neighbour_states;
    if (neighbours_.try_push_back(neighbour)) {
        return;
    }
    ++diagnostics_.neighbours_dropped;
    if (distance(neighbour) < distance(*farthest)) {
        *farthest = neighbour;
    }
}

void MissionProtocol::forget(std::uint16_t id) noexcept
{
    for (std::size_t i = 0; i < neighbours_.size(); ++i) {
        if (neighbours_[i].heard.id == id) {
            neighbours_.swap_erase(i);
            return;
        }
    }
}

void MissionProtocol::queue_event(const Frame& frame) noexcept
{
    if (events_.try_push_back(frame)) {
        ++diagnostics_.events;
        return;
    }
    ++diagnostics_.events_refused;
    if (frame.type == MessageType::task_upload) {
        const TaskUpload part = unpack<TaskUpload>(frame);
        send(pack(TaskAck{part.task, part.part, static_cast<std::uint8_t>(TaskStatus::queue_full)}));
    } else if (frame.type == MessageType::config) {
        const Config config = unpack<Config>(frame);
        send(pack(ConfigAck{config.key, static_cast<std::uint8_t>(ConfigStatus::queue_full), 0.0F}));
    }
    // An acknowledgement and a question that are not answered are repeated anyway.
}

void MissionProtocol::step(TimePoint now) noexcept
{
    for (std::size_t i = 0; i < kEventsPerStep && !events_.empty(); ++i) {
        answer(take_first(events_), now);
    }
}

void MissionProtocol::answer(const Frame& event, TimePoint now) noexcept
{
    if (event.type == MessageType::task_upload) {
        send(pack(upload_.take(unpack<TaskUpload>(event), now)));
    } else if (event.type == MessageType::config) {
        const Config config = unpack<Config>(event);
        float value = config.value;
        const bool is_number = config.set == 0 || std::isfinite(value);
        const ConfigStatus status =
            is_number ? host_.configure(config.key, config.set != 0, value) : ConfigStatus::out_of_range;
        if (!is_number) {
            value = 0.0F;
            static_cast<void>(host_.configure(config.key, false, value));
        }
        send(pack(ConfigAck{config.key, static_cast<std::uint8_t>(status),
                            status == ConfigStatus::unknown_key ? 0.0F : value}));
    } else if (event.type == MessageType::map_info) {
        send(pack(host_.map_info()));
    } else if (tripped_ && unpack<TripAck>(event).trip == told_trip_) {
        // Only the trip that was told: one that came since is not known to whoever acknowledges.
        tripped_ = false;
        host_.acknowledge_trip();
    }
}

MissionInput MissionProtocol::input(TimePoint now) const noexcept
{
    MissionInput input;
    input.own = own_;
    input.hold = !has_own_ || now - own_.stamp > kOwnStateAge;
    const bool wanted = has_preferred_ && now - preferred_at_ <= kPreferredAge;
    input.preferred = wanted && !input.hold ? preferred_ : Vec3(Vec3::Zero());
    const auto fault_if = [](bool condition, MissionFault fault) { return condition ? bit(fault) : 0U; };
    input.faults = static_cast<std::uint16_t>(
        fault_if(input.hold, MissionFault::own_state_stale) | fault_if(!wanted, MissionFault::no_preferred) |
        fault_if(tripped_, MissionFault::tripped) |
        fault_if(diagnostics_.neighbours_dropped > 0 && neighbours_.full(), MissionFault::neighbour_dropped));
    return input;
}

void MissionProtocol::tell_state(const orca::Broadcast& own, float radius_xy, float radius_z, Seconds horizon,
                                 TimePoint now) noexcept
{
    StateNeighbour state;
    state.age_ms = short_age(own.state.stamp, now);
    put_vector(own.state.position, state.position.data());
    put_vector(own.state.velocity, state.velocity.data());
    put_vector(own.preferred, state.preferred.data());
    state.radius_xy = radius_xy;
    state.radius_z = radius_z;
    state.max_speed = own.max_speed;
    state.max_acceleration = own.max_acceleration;
    state.horizon = horizon;
    state.act = own.loop.act;
    state.lag = own.loop.lag;
    std::size_t n = 0;
    for (const orca::IssuedCommand& command : own.commands) {
        const std::uint16_t age = short_age(command.issued, now);
        if (n > 0 && age >= state.command_age_ms[n - 1]) {
            continue;  // within the same millisecond, or too old to tell
        }
        state.command_age_ms[n] = age;
        put_vector(command.velocity, &state.command[3 * n]);
        ++n;
    }
    state.commands = static_cast<std::uint8_t>(n);
    state_out_ = pack(state);
    has_state_out_ = true;
}

void MissionProtocol::tell_command(const Vec3& velocity, std::uint32_t status, std::uint8_t level) noexcept
{
    CommandSent command;
    put_vector(velocity, command.velocity.data());
    command.status = status;
    command.level = level;
    command_out_ = pack(command);
    has_command_out_ = true;
}

void MissionProtocol::tell_progress(const path::GeneratorOutput& output, TimePoint now) noexcept
{
    const std::uint16_t faults = input(now).faults;
    const bool changed =
        !reported_ || output.status != told_status_ || faults != told_faults_ || upload_.task() != told_task_;
    if (!changed && now - told_at_ < kReportPeriod) {
        return;
    }
    reported_ = true;
    told_status_ = output.status;
    told_faults_ = faults;
    told_task_ = upload_.task();
    told_at_ = now;
    send(pack(MissionReport{told_task_, output.left, output.error, faults, static_cast<std::uint8_t>(output.status),
                            static_cast<std::uint16_t>(neighbours_.size())}));
}

void MissionProtocol::tell_monitor(const orca::Monitor& monitor, TimePoint now) noexcept
{
    const auto number = static_cast<std::uint16_t>(monitor.trips());
    const bool is_new = monitor.tripped() && (!tripped_ || number != told_trip_);
    tripped_ = monitor.tripped();
    if (!tripped_ || (!is_new && now - told_trip_at_ < kReportPeriod)) {
        return;
    }
    told_trip_ = number;
    told_trip_at_ = now;
    const orca::MonitorRecord& trip = monitor.trip();
    send(pack(MonitorTrip{static_cast<std::uint32_t>(age_of(trip.stamp, now)), number,
                          static_cast<std::uint8_t>(trip.subject), trip.id, trip.horizontal, trip.vertical}));
}

void MissionProtocol::send(const Frame& frame) noexcept
{
    if (!answers_.try_push_back(frame)) {
        ++diagnostics_.answers_dropped;
    }
}

std::span<const std::byte> MissionProtocol::pending() noexcept
{
    if (out_begin_ == out_end_) {
        Frame frame;
        if (!answers_.empty()) {
            frame = take_first(answers_);
        } else if (has_state_out_ && !(command_next_ && has_command_out_)) {
            frame = state_out_;
            has_state_out_ = false;
            command_next_ = true;
        } else if (has_command_out_) {
            frame = command_out_;
            has_command_out_ = false;
            command_next_ = false;
        } else {
            return {};
        }
        frame.sender = id_;
        frame.sequence = sequence_++;
        out_begin_ = 0;
        out_end_ = write_frame(frame, out_);
    }
    return std::span<const std::byte>(out_).subspan(out_begin_, out_end_ - out_begin_);
}

void MissionProtocol::consume(std::size_t n) noexcept { out_begin_ = std::min(out_end_, out_begin_ + n); }

void MissionProtocol::discard_pending() noexcept
{
    out_begin_ = out_end_;
    answers_.clear();
    has_state_out_ = false;
    has_command_out_ = false;
}

}  // namespace jink::app
