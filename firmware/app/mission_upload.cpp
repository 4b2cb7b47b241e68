// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/mission_upload.hpp"

#include "core/base/finite.hpp"

namespace jink::app {
namespace {

using link::mission::TaskStatus;
using link::mission::TaskUpload;

[[nodiscard]] TaskStatus status_of(path::DenseStatus status) noexcept
{
    switch (status) {
    case path::DenseStatus::ok: return TaskStatus::more;
    case path::DenseStatus::busy: return TaskStatus::busy;
    case path::DenseStatus::not_finite:
    case path::DenseStatus::time_not_later: return TaskStatus::bad_point;
    case path::DenseStatus::too_long: return TaskStatus::path_too_long;
    case path::DenseStatus::gap: return TaskStatus::gap;
    case path::DenseStatus::no_path:
    case path::DenseStatus::too_few: break;
    }
    return TaskStatus::no_path;
}

[[nodiscard]] bool is_possible(const TaskUpload& part) noexcept
{
    constexpr std::uint8_t kFlags = link::mission::kContinues | link::mission::kLast;
    return part.parts >= 1 && part.part < part.parts && part.points >= 1 &&
           part.points <= link::mission::kPointsPerUpload && (part.flags & ~kFlags) == 0 &&
           is_positive(part.cruise_speed) && is_not_negative(part.time_limit);
}

[[nodiscard]] bool agrees(const TaskUpload& a, const TaskUpload& b) noexcept
{
    return a.task == b.task && a.parts == b.parts && a.crc == b.crc && a.cruise_speed == b.cruise_speed &&
           a.time_limit == b.time_limit && a.flags == b.flags;
}

}  // namespace

link::mission::TaskAck MissionUpload::take(const TaskUpload& part, TimePoint now) noexcept
{
    const TaskStatus status = judge(part, now);
    link::mission::TaskAck ack;
    ack.task = part.task;
    ack.status = static_cast<std::uint8_t>(status);
    const bool is_open_one = open_ && part.task == first_.task;
    ack.next = status == TaskStatus::accepted ? part.parts : static_cast<std::uint16_t>(is_open_one ? next_ : 0);
    return ack;
}

TaskStatus MissionUpload::judge(const TaskUpload& part, TimePoint now) noexcept
{
    if (!is_possible(part)) {
        return open_ && part.task == first_.task ? fail(TaskStatus::inconsistent) : TaskStatus::inconsistent;
    }
    if (open_ && part.task != first_.task) {
        if (now - last_part_ <= kSilence) {
            return TaskStatus::busy;
        }
        static_cast<void>(fail(TaskStatus::busy));  // whoever sent it has given up
    }
    if (!open_) {
        if (has_task_ && part.task == task_ && part.parts == task_parts_ && part.crc == task_crc_) {
            return TaskStatus::accepted;  // its answer was lost
        }
        if (part.part != 0) {
            return TaskStatus::out_of_order;
        }
        if (const TaskStatus status = open(part); status != TaskStatus::more) {
            return status;
        }
    }
    last_part_ = now;
    if (!agrees(part, first_)) {
        return fail(TaskStatus::inconsistent);
    }
    if (part.part != next_) {
        return part.part < next_ ? TaskStatus::more : TaskStatus::out_of_order;
    }
    if (const TaskStatus status = add_points(part); status != TaskStatus::more) {
        return status;
    }
    ++next_;
    return next_ == first_.parts ? finish(now) : TaskStatus::more;
}

TaskStatus MissionUpload::open(const TaskUpload& part) noexcept
{
    const bool continues = (part.flags & link::mission::kContinues) != 0;
    if (const path::DenseStatus status = generator_.path().begin(continues); status != path::DenseStatus::ok) {
        generator_.reject();
        return status_of(status);
    }
    open_ = true;
    first_ = part;
    next_ = 0;
    crc_ = Crc();
    return TaskStatus::more;
}

TaskStatus MissionUpload::add_points(const TaskUpload& part) noexcept
{
    for (std::size_t i = 0; i < part.points; ++i) {
        const Vec3 position(part.position[3 * i], part.position[3 * i + 1], part.position[3 * i + 2]);
        crc_.add(position.x());
        crc_.add(position.y());
        crc_.add(position.z());
        crc_.add32(part.arrival_ms[i]);
        const path::DenseStatus status = generator_.path().add(position, part.arrival_ms[i]);
        if (status != path::DenseStatus::ok) {
            return fail(status_of(status));
        }
    }
    return TaskStatus::more;
}

TaskStatus MissionUpload::finish(TimePoint now) noexcept
{
    if (crc_.value() != first_.crc) {
        return fail(TaskStatus::bad_crc);
    }
    const bool continues = (first_.flags & link::mission::kContinues) != 0 && !generator_.path().empty();
    const path::DenseStatus status = generator_.path().commit((first_.flags & link::mission::kLast) != 0);
    if (status != path::DenseStatus::ok) {
        return fail(status_of(status));
    }
    // A continuation is part of the task that is flown; its speed and limit stay that one's.
    if (!continues && !generator_.start({first_.cruise_speed, first_.time_limit}, now)) {
        return fail(TaskStatus::no_path);
    }
    open_ = false;
    has_task_ = true;
    task_ = first_.task;
    task_parts_ = first_.parts;
    task_crc_ = first_.crc;
    return TaskStatus::accepted;
}

TaskStatus MissionUpload::fail(TaskStatus why) noexcept
{
    open_ = false;
    generator_.path().abandon();
    generator_.reject();
    return why;
}

}  // namespace jink::app
