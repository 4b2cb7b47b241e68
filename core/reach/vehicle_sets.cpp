// SPDX-License-Identifier: BSD-3-Clause
#include "core/reach/vehicle_sets.hpp"

#include <cmath>

#include "core/base/crc.hpp"

namespace jink::reach {
namespace {

bool share_grid_and_step(const ReachSet& a, const ReachSet& b) noexcept
{
    return a.grid.layers() == b.grid.layers() && a.grid.columns() == b.grid.columns() &&
           a.grid.rows() == b.grid.rows() && a.grid.distance() == b.grid.distance() &&
           a.grid.horizontal() == b.grid.horizontal() && a.grid.vertical() == b.grid.vertical() &&
           a.step.length == b.step.length && a.step.pitch == b.step.pitch && a.step.yaw == b.step.yaw;
}

bool is_positive(float number) noexcept { return std::isfinite(number) && number > 0.0F; }

bool has_numbers(const VehicleSets& s) noexcept
{
    for (const float number : {s.period, s.max_acceleration, s.max_vertical_acceleration, s.max_climb, s.max_descent,
                               s.cruise_speed, s.most_speed}) {
        if (!is_positive(number)) {
            return false;
        }
    }
    for (std::size_t i = 0; i < s.speeds.size(); ++i) {
        const float end = i + 1 < s.speeds.size() ? s.speeds[i + 1] : s.most_speed;
        const std::array<float, 2>& pitch = s.pitch_separators[i];
        if (!is_positive(s.speeds[i]) || !(s.speeds[i] < end) || !(pitch[0] < 0.0F) || !(pitch[1] > 0.0F) ||
            !(s.most_pitch[i] > pitch[1]) || !(-s.most_pitch[i] < pitch[0]) || !std::isfinite(s.most_pitch[i])) {
            return false;
        }
    }
    return true;
}

/// Tables that are referred to twice are checked once.
bool is_new(const VehicleSets& s, std::size_t segment, const ReachSet* set) noexcept
{
    for (std::size_t i = 0; i < segment; ++i) {
        if (s.segments[i].navigation == set || s.segments[i].emergency == set) {
            return false;
        }
    }
    return true;
}

const ReachSet* table_of(const VehicleSets& s, std::size_t table) noexcept
{
    const SegmentSets& segment = s.segments[table / 2];
    return table % 2 == 0 ? segment.navigation : segment.emergency;
}

}  // namespace

const SegmentSets* segment_of(const VehicleSets& sets, float speed_share, float pitch) noexcept
{
    if (sets.speeds.empty() || !(speed_share >= 0.0F && speed_share <= sets.most_speed)) {
        return nullptr;
    }
    std::size_t speed = 0;
    while (speed + 1 < sets.speeds.size() && speed_share >= sets.speeds[speed + 1]) {
        ++speed;
    }
    if (!(std::abs(pitch) <= sets.most_pitch[speed])) {
        return nullptr;
    }
    const std::array<float, 2>& separators = sets.pitch_separators[speed];
    const PitchSegment at = pitch < separators[0]   ? PitchSegment::climbing
                            : pitch < separators[1] ? PitchSegment::level
                                                    : PitchSegment::descending;
    return &sets.segments[kPitchSegments * speed + static_cast<std::size_t>(at)];
}

std::uint32_t checksum_of(const VehicleSets& sets) noexcept
{
    Crc crc;
    for (const float number : {sets.period, sets.max_acceleration, sets.max_vertical_acceleration, sets.max_climb,
                               sets.max_descent, sets.cruise_speed, sets.most_speed}) {
        crc.add(number);
    }
    for (const float speed : sets.speeds) {
        crc.add(speed);
    }
    for (const std::array<float, 2>& separators : sets.pitch_separators) {
        crc.add(separators[0]);
        crc.add(separators[1]);
    }
    for (const float most : sets.most_pitch) {
        crc.add(most);
    }
    for (const SegmentSets& segment : sets.segments) {
        for (const ReachSet* set : {segment.navigation, segment.emergency}) {
            crc.add32(set != nullptr ? set->checksum : 0);
        }
        crc.add(static_cast<std::uint8_t>(segment.upside_down ? 1 : 0));
    }
    return crc.value();
}

SetStatus check(const VehicleSets& sets) noexcept
{
    const std::size_t speeds = sets.speeds.size();
    if (speeds == 0) {
        return SetStatus::empty;
    }
    if (speeds > kMaxSpeedSegments) {
        return SetStatus::too_large;
    }
    if (sets.pitch_separators.size() != speeds || sets.most_pitch.size() != speeds ||
        sets.segments.size() != kPitchSegments * speeds) {
        return SetStatus::sizes_differ;
    }
    if (!has_numbers(sets)) {
        return SetStatus::bad_segments;
    }
    for (std::size_t i = 0; i < sets.segments.size(); ++i) {
        const SegmentSets& segment = sets.segments[i];
        if (segment.navigation == nullptr || segment.emergency == nullptr ||
            !share_grid_and_step(*segment.navigation, *segment.emergency)) {
            return SetStatus::bad_segments;
        }
        for (const ReachSet* set : {segment.navigation, segment.emergency}) {
            if (!is_new(sets, i, set)) {
                continue;
            }
            if (const SetStatus status = check(*set); status != SetStatus::good) {
                return status;
            }
        }
    }
    return checksum_of(sets) == sets.checksum ? SetStatus::good : SetStatus::wrong_checksum;
}

TableCheck::TableCheck(const VehicleSets& sets) noexcept : sets_(&sets), sum_(*table_of(sets, 0)) {}

void TableCheck::go_to(std::size_t table) noexcept
{
    const std::size_t tables = 2 * sets_->segments.size();
    while (table < tables && !is_new(*sets_, table / 2, table_of(*sets_, table))) {
        ++table;
    }
    at_ = table;
    if (table < tables) {
        sum_ = SetChecksum(*table_of(*sets_, table));
    }
}

Progress TableCheck::advance(WorkBudget& budget) noexcept
{
    while (!failed_ && budget.spend(units_of_next())) {
        if (at_ == 2 * sets_->segments.size()) {
            failed_ = checksum_of(*sets_) != sets_->checksum;
            go_to(0);
            return failed_ ? Progress::failed : Progress::done;
        }
        if (sum_.advance(kElements)) {
            failed_ = sum_.value() != table_of(*sets_, at_)->checksum;
            go_to(at_ + 1);
        }
    }
    return failed_ ? Progress::failed : Progress::running;
}

}  // namespace jink::reach
