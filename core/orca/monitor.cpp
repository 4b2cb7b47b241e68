// SPDX-License-Identifier: BSD-3-Clause
#include "core/orca/monitor.hpp"

#include <algorithm>
#include <cmath>

namespace jink::orca {
namespace {

constexpr std::size_t kRecordsAfterTrip = Monitor::kRecords / 2;

}  // namespace

MonitorReport Monitor::update(TimePoint now, const Vec3& own, std::span<const MonitoredVehicle> vehicles,
                              std::span<const MonitoredPiece> pieces) noexcept
{
    Tick tick;
    tick.record.stamp = now;
    tick.report.action = settings_.action;
    if (is_finite(own)) {
        for (const MonitoredVehicle& vehicle : vehicles) {
            look_at(tick, Subject::vehicle, vehicle.id, vehicle.position - own);
        }
        for (const MonitoredPiece& piece : pieces) {
            look_at(tick, Subject::obstacle, piece.id, piece.nearest - own);
        }
    } else {
        ++bad_inputs_;
    }
    if (tick.trips && !tripped_) {
        tripped_ = true;
        ++trips_;
        trip_ = tick.culprit;
        since_trip_ = 0;
        tick.report.just_now = true;
    }
    tick.report.tripped = tripped_;
    remember(tick.record);
    return tick.report;
}

void Monitor::look_at(Tick& tick, Subject subject, std::uint16_t id, const Vec3& offset) noexcept
{
    if (!is_finite(offset)) {
        ++bad_inputs_;
        return;
    }
    const bool is_obstacle = subject == Subject::obstacle;
    const float horizontal = offset.head<2>().norm();
    const float vertical = std::abs(offset.z());
    const float h = horizontal / (is_obstacle ? settings_.obstacle_horizontal : settings_.stop_horizontal);
    const float z = vertical / (is_obstacle ? settings_.obstacle_vertical : settings_.stop_vertical);
    // At the piece itself both sides are 0, which is a violation.
    const bool in_cylinder = h < 1.0F && z < 1.0F;
    const bool violated = in_cylinder || (is_obstacle && h * h + z * z < h + z);

    if (is_obstacle) {
        tick.record.nearest_obstacle = std::min(tick.record.nearest_obstacle, offset.norm());
    }
    const float ellipsoid = std::hypot(h, z);
    if (ellipsoid < tick.report.ellipsoid) {
        tick.report.subject = subject;
        tick.report.id = id;
        tick.report.horizontal = h;
        tick.report.vertical = z;
        tick.report.ellipsoid = ellipsoid;
        tick.record.subject = subject;
        tick.record.id = id;
        tick.record.horizontal = horizontal;
        tick.record.vertical = vertical;
    }
    if (count(subject, id, violated) && !tick.trips) {
        tick.trips = true;
        tick.culprit = {tick.record.stamp, subject, id, horizontal, vertical, tick.record.nearest_obstacle};
    }
}

/// Whether the samples in a row suffice.
bool Monitor::count(Subject subject, std::uint16_t id, bool violated) noexcept
{
    std::size_t i = 0;
    while (i < counts_.size() && !(counts_[i].subject == subject && counts_[i].id == id)) {
        ++i;
    }
    if (!violated) {
        if (i < counts_.size()) {
            counts_.swap_erase(i);
        }
        return false;
    }
    if (i == counts_.size() && !counts_.try_push_back({subject, id, 0})) {
        return true;
    }
    Count& found = counts_[i];
    found.samples = static_cast<std::uint8_t>(std::min<int>(found.samples + 1, settings_.samples));
    return found.samples >= settings_.samples;
}

void Monitor::remember(const MonitorRecord& record) noexcept
{
    if (tripped_) {
        if (since_trip_ > kRecordsAfterTrip) {
            return;
        }
        ++since_trip_;
    }
    if (log_size_ < kRecords) {
        log_[(log_first_ + log_size_++) % kRecords] = record;
    } else {
        log_[log_first_] = record;
        log_first_ = (log_first_ + 1) % kRecords;
    }
}

void Monitor::acknowledge() noexcept
{
    tripped_ = false;
    counts_.clear();
}

}  // namespace jink::orca
