// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/finite.hpp"
#include "core/geometric/planner.hpp"

namespace jink::geometric {
namespace {

bool has_valid_counts(const Settings& s) noexcept
{
    if (s.offsets < 2 || s.offsets > 64 || s.offsets % 2 != 0 || s.extra_planes >= kMaxPlanes || s.waypoints < 8 ||
        s.waypoints > kMaxPathPoints || s.retries >= kAttempts.size()) {
        return false;
    }
    const std::size_t candidates = count_of_candidates(s);
    return candidates >= 1 && candidates <= kMaxCandidates;
}

}  // namespace

Settings source_settings() noexcept
{
    Settings s;
    s.security = SecurityMode::swept;
    s.offset_rule = OffsetRule::source;
    s.main_swept_to_collision_point = true;
    s.check_acceleration = false;
    s.verify_flight = false;
    s.closeness = cost::ClosenessMethod::swept;
    s.all_terms = true;
    s.evaluate_all = true;
    s.escape_from_margin = false;
    s.retries = 0;
    s.starts_after_latency = false;
    return s;
}

bool Settings::*flag_of(Family family) noexcept
{
    switch (family) {
    case Family::simple: return &Settings::simple;
    case Family::symmetric: return &Settings::symmetric;
    case Family::smooth: return &Settings::smooth;
    case Family::plateau: return &Settings::plateau;
    case Family::wait: break;
    }
    return &Settings::wait;
}

std::size_t count_of_candidates(const Settings& settings) noexcept
{
    const std::size_t each = settings.offsets * (settings.extra_planes + std::size_t{1});
    std::size_t count = settings.wait ? kWaits : 0;
    for (const Family family : kCurves) {
        count += settings.*flag_of(family) ? each : 0;
    }
    return count;
}

bool is_valid(const Settings& s) noexcept
{
    return has_valid_counts(s) && is_not_negative(s.source_drop_margin) && is_not_negative(s.rotation_penalty) &&
           is_not_negative(s.flip_penalty) && cost::is_valid(s.weights) && cost::is_valid(s.caps) &&
           s.max_cost > 0.0F && s.max_cost <= 1.0F;
}

}  // namespace jink::geometric
