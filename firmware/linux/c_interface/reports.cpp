// SPDX-License-Identifier: BSD-3-Clause
// Tracks, parameters, and what the caller's own sensors see.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/linux/c_interface/handles.hpp"

using jink::c_interface::Session;

namespace {

using namespace jink;
using c_interface::find;
using c_interface::find_sized;

Vec3 vector_of(const float (&from)[3]) noexcept { return {from[0], from[1], from[2]}; }

bool is_within(float value, float low, float high) noexcept { return value >= low && value <= high; }  // false for NaN

bool is_place(const float (&v)[3]) noexcept
{
    return std::ranges::all_of(v,
                               [](float x) { return is_within(x, -link::kLargestPosition, link::kLargestPosition); });
}

bool is_stamp(std::int64_t us) noexcept { return us >= 0 && us <= JINK_LATEST_TIME; }

jink_result check(const jink_track_report& report) noexcept
{
    constexpr float kLargestRadius = 1000.0F;
    const bool velocity_fits = report.has_velocity == 0 ||
                               (is_place(report.velocity) && vector_of(report.velocity).norm() <= link::kLargestSpeed);
    const bool fits = report.id != 0 &&
                      is_within(static_cast<float>(report.source), JINK_SOURCE_ADSB, JINK_SOURCE_UTM) &&
                      report.has_velocity <= 1 && report.is_unmanned <= 1 && is_stamp(report.stamp_us) &&
                      is_place(report.position) && velocity_fits && is_within(report.radius, 0.0F, kLargestRadius) &&
                      is_within(report.sigma_position, 0.0F, link::kLargestPosition) &&
                      is_within(report.sigma_velocity, 0.0F, link::kLargestSpeed);
    return fits ? JINK_OK : JINK_ERROR_VALUE;
}

jink_result check(const jink_range_report& report) noexcept
{
    constexpr std::uint32_t kLastSensor = 255;
    constexpr float kWidestBeam = 1.5F;
    const float length = vector_of(report.direction).stableNorm();
    const bool fits = report.sensor <= kLastSensor && is_stamp(report.stamp_us) && is_place(report.direction) &&
                      length > 0.0F && is_within(report.max_range, 0.0F, link::kLargestPosition) &&
                      is_within(report.range, -link::kLargestPosition, link::kLargestPosition) &&
                      is_within(report.half_angle, 0.0F, kWidestBeam);
    return fits ? JINK_OK : JINK_ERROR_VALUE;
}

link::Constraint constraint_of(const jink_closed_area& area) noexcept
{
    link::Constraint constraint;
    constraint.cylinder.circle.centre = {area.centre[0], area.centre[1]};
    constraint.cylinder.circle.radius = area.radius;
    constraint.cylinder.velocity = {area.velocity[0], area.velocity[1]};
    constraint.cylinder.bottom = area.bottom;
    constraint.cylinder.top = area.top;
    constraint.cylinder.margin = area.margin;
    constraint.stamp = {area.stamp_us};
    if (area.ends_us != 0) {
        constraint.ends = {area.ends_us};
    }
    if (area.has_place != 0) {
        constraint.about = link::GlobalPosition{area.lat, area.lon, area.alt};
    }
    return constraint;
}

bool is_good(const jink_closed_area& area, std::int64_t now_us) noexcept
{
    constexpr std::int32_t kPole = 900000000;
    constexpr std::int32_t kDateLine = 1800000000;
    const bool place_fits = area.has_place == 0 || (area.lat >= -kPole && area.lat <= kPole && area.lon >= -kDateLine &&
                                                    area.lon <= kDateLine);
    return area.has_place <= 1 && area.reserved == 0 && place_fits && is_stamp(area.stamp_us) &&
           area.stamp_us <= now_us && is_stamp(area.ends_us) &&
           app::ConstraintTable::accepts(constraint_of(area), {now_us});
}

}  // namespace

jink_result jink_get_track(jink_coprocessor* jink, std::uint32_t index, jink_track* track)
{
    Session* session = nullptr;
    if (const jink_result result = find_sized(jink, session, track); result != JINK_OK) {
        return result;
    }
    if (index >= session->tracks()) {
        return JINK_ERROR_INDEX;
    }
    const std::span<const world::Track> tracks = session->coprocessor().tracks(*session->last_step());
    if (index >= tracks.size()) {
        return JINK_ERROR_INDEX;
    }
    const world::Track& known = tracks[index];
    *track = {};
    track->size = sizeof *track;
    track->id = known.id;
    track->instance = known.instance;
    track->source = static_cast<std::int32_t>(known.source);
    track->stamp_us = known.stamp.us;
    std::copy_n(known.position.data(), 3, track->position);
    std::copy_n(known.velocity.data(), 3, track->velocity);
    track->radius = known.radius;
    track->sigma_position = known.sigma_position;
    track->sigma_velocity = known.sigma_velocity;
    track->half_height = known.half_height;
    track->is_cooperative = known.cooperative ? 1 : 0;
    return JINK_OK;
}

std::uint32_t jink_parameter_count(void) { return static_cast<std::uint32_t>(app::kParamCount); }

jink_result jink_get_parameter_info(std::uint32_t index, jink_parameter* info)
{
    if (info == nullptr) {
        return JINK_ERROR_NULL;
    }
    if (info->size != sizeof *info) {
        return JINK_ERROR_SIZE;
    }
    if (index >= app::kParamCount) {
        return JINK_ERROR_INDEX;
    }
    const app::ParamInfo& known = app::param_table()[index];
    // Both views are of literals, which end with a zero.
    *info = {sizeof *info,      known.integer ? 1U : 0U,
             known.name.data(), known.text.data(),
             known.initial,     known.low,
             known.high,        0};
    return JINK_OK;
}

jink_result jink_get_parameter(const jink_coprocessor* jink, const char* name, float* value)
{
    Session* session = nullptr;
    if (const jink_result result = find(jink, session, name, value); result != JINK_OK) {
        return result;
    }
    const std::size_t index = app::Parameters::find(name);
    if (index == app::kParamCount) {
        return JINK_ERROR_NAME;
    }
    *value = session->parameters().values()[index];
    return JINK_OK;
}

jink_result jink_set_parameter(jink_coprocessor* jink, const char* name, float value)
{
    return jink_set_parameters(jink, &name, &value, 1);
}

jink_result jink_set_parameters(jink_coprocessor* jink, const char* const* names, const float* values,
                                std::size_t count)
{
    if (count > 0 && (names == nullptr || values == nullptr)) {
        return JINK_ERROR_NULL;
    }
    Session* session = nullptr;
    if (const jink_result result = find(jink, session); result != JINK_OK) {
        return result;
    }
    for (std::size_t i = 0; i < count; ++i) {
        if (names[i] == nullptr) {
            return JINK_ERROR_NULL;
        }
    }
    return count > 0 ? session->set_parameters(names, values, count) : JINK_OK;
}

jink_result jink_report_track(jink_coprocessor* jink, const jink_track_report* report)
{
    Session* session = nullptr;
    if (const jink_result result = find_sized(jink, session, report); result != JINK_OK) {
        return result;
    }
    if (const jink_result checked = check(*report); checked != JINK_OK) {
        return checked;
    }
    link::TrackReport track;
    track.id = report->id;
    track.stamp = {report->stamp_us};
    track.position = vector_of(report->position);
    track.has_velocity = report->has_velocity != 0;
    track.velocity = track.has_velocity ? vector_of(report->velocity) : Vec3::Zero();
    track.radius = report->radius;
    track.sigma_position = report->sigma_position;
    track.sigma_velocity = report->sigma_velocity;
    track.source = static_cast<world::TrackSource>(report->source);
    track.unmanned = report->is_unmanned != 0;
    return session->link().report(track) ? JINK_OK : JINK_ERROR_FULL;
}

jink_result jink_report_range(jink_coprocessor* jink, const jink_range_report* report)
{
    Session* session = nullptr;
    if (const jink_result result = find_sized(jink, session, report); result != JINK_OK) {
        return result;
    }
    if (const jink_result checked = check(*report); checked != JINK_OK) {
        return checked;
    }
    link::RangeReading reading;
    reading.stamp = {report->stamp_us};
    reading.direction = vector_of(report->direction).stableNormalized();
    reading.range = report->range < 0.0F ? link::RangeScan::kNothing : report->range;
    reading.max_range = report->max_range;
    reading.half_angle = report->half_angle;
    reading.sensor = static_cast<std::uint8_t>(report->sensor);
    return session->link().report(reading) ? JINK_OK : JINK_ERROR_FULL;
}

jink_result jink_set_closed_areas(jink_coprocessor* jink, std::int64_t now_us, const jink_closed_area* areas,
                                  std::size_t count)
{
    if (areas == nullptr && count > 0) {
        return JINK_ERROR_NULL;
    }
    Session* session = nullptr;
    if (const jink_result result = find(jink, session); result != JINK_OK) {
        return result;
    }
    if (!is_stamp(now_us) || (session->last_step() && now_us < session->last_step()->us)) {
        return JINK_ERROR_TIME;
    }
    if (count > JINK_MAX_CLOSED_AREAS) {
        return JINK_ERROR_FULL;
    }
    std::array<link::Constraint, JINK_MAX_CLOSED_AREAS> constraints;
    for (std::size_t i = 0; i < count; ++i) {
        if (areas[i].size != sizeof areas[i]) {
            return JINK_ERROR_SIZE;
        }
        if (!is_good(areas[i], now_us)) {
            return JINK_ERROR_VALUE;
        }
        constraints[i] = constraint_of(areas[i]);
    }
    session->coprocessor().set_constraints(std::span(constraints).first(count), {now_us});
    return JINK_OK;
}
