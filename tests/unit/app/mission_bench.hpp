// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "core/base/crc.hpp"
#include "firmware/app/mission_protocol.hpp"

// The other end of a mission line for tests: makes frames, and reads what comes back.

namespace jink::app::test {

using namespace link::mission;
using Bytes = std::vector<std::byte>;

template <class M>
Bytes frame_of(const M& message, std::uint16_t sender = 100, std::uint16_t sequence = 0)
{
    Frame frame = pack(message);
    frame.sender = sender;
    frame.sequence = sequence;
    Bytes bytes(kMaxFrame);
    bytes.resize(write_frame(frame, bytes));
    return bytes;
}

struct Point {
    Vec3 position;
    std::uint32_t arrival_ms = 0;
};

/// All parts of a task.
inline std::vector<TaskUpload> parts_of(std::uint32_t task, const std::vector<Point>& points,
                                        std::uint8_t flags = kLast, float speed = 1.0F)
{
    Crc crc;
    for (const Point& p : points) {
        crc.add(p.position.x());
        crc.add(p.position.y());
        crc.add(p.position.z());
        crc.add32(p.arrival_ms);
    }
    std::vector<TaskUpload> parts((points.size() + kPointsPerUpload - 1) / kPointsPerUpload);
    for (std::size_t i = 0; i < parts.size(); ++i) {
        TaskUpload& part = parts[i];
        part.task = task;
        part.part = static_cast<std::uint16_t>(i);
        part.parts = static_cast<std::uint16_t>(parts.size());
        part.crc = crc.value();
        part.cruise_speed = speed;
        part.flags = flags;
        for (std::size_t k = i * kPointsPerUpload; k < points.size() && part.points < kPointsPerUpload; ++k) {
            for (int axis = 0; axis < 3; ++axis) {
                part.position[3U * part.points + static_cast<std::size_t>(axis)] = points[k].position[axis];
            }
            part.arrival_ms[part.points++] = points[k].arrival_ms;
        }
    }
    return parts;
}

/// A straight line of `n` points, a metre and a second apart.
inline std::vector<Point> line(std::size_t n, float from = 0.0F)
{
    std::vector<Point> points;
    for (std::size_t i = 0; i < n; ++i) {
        points.push_back({Vec3(from + static_cast<float>(i), 0, 0), static_cast<std::uint32_t>(1000 * i)});
    }
    return points;
}

struct Host final : MissionHost {
    ConfigStatus configure(std::uint16_t key, bool set, float& value) noexcept override
    {
        if (key != 7) {
            return ConfigStatus::unknown_key;
        }
        ConfigStatus status = ConfigStatus::ok;
        if (set && value > 100.0F) {
            status = ConfigStatus::out_of_range;
        } else if (set) {
            setting = value;
        }
        value = setting;
        return status;
    }
    MapInfo map_info() const noexcept override { return {0x12345678, 2, 99}; }
    void acknowledge_trip() noexcept override
    {
        ++acknowledged;
        monitor.acknowledge();
    }
    float setting = 1.5F;
    int acknowledged = 0;
    orca::Monitor monitor;
};

/// Everything that came back.
struct Heard final : FrameSink {
    void take(const Frame& frame, TimePoint /*now*/) noexcept override { frames.push_back(frame); }
    template <class M>
    std::vector<M> all() const
    {
        std::vector<M> found;
        for (const Frame& frame : frames) {
            if (frame.type == M::kType) {
                found.push_back(unpack<M>(frame));
            }
        }
        return found;
    }
    std::vector<Frame> frames;
};

struct Line {
    void send(const Bytes& bytes) { protocol.receive(bytes, now); }
    template <class M>
    void send(const M& message, std::uint16_t sender = 100)
    {
        send(frame_of(message, sender));
    }
    /// All that waits to go out, read as the other end reads it.
    Heard heard()
    {
        Heard all;
        Receiver receiver;
        while (!protocol.pending().empty()) {
            const Bytes bytes(protocol.pending().begin(), protocol.pending().end());
            receiver.receive(bytes, now, all);
            protocol.consume(bytes.size());
        }
        return all;
    }
    Heard step(float dt = 0.025F)
    {
        now = now + dt;
        protocol.step(now);
        return heard();
    }
    TaskAck ack(const TaskUpload& part)
    {
        send(part);
        const std::vector<TaskAck> acks = step().all<TaskAck>();
        return acks.size() == 1 ? acks[0] : TaskAck{0, 0, 255};
    }
    TaskStatus status(const TaskUpload& part) { return static_cast<TaskStatus>(ack(part).status); }
    TaskStatus upload(const std::vector<TaskUpload>& parts)
    {
        TaskStatus last = TaskStatus::more;
        for (std::size_t i = 0; i < parts.size() && last == TaskStatus::more; ++i) {
            last = status(parts[i]);
        }
        return last;
    }
    TimePoint now{10'000'000};
    path::TrajectoryGenerator generator{{}, {}};
    Host host;
    MissionProtocol protocol{1, 0.01F, generator, host};
};

}  // namespace jink::app::test
