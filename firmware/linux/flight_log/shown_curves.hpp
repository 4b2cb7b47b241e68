// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/geometric/candidate.hpp"
#include "core/path/route.hpp"
#include "firmware/linux/flight_log/topics.hpp"

// Curves that pages draw of what a flight log says: the page of `jink report` and the live page of jinkd.

namespace jink::flightlog {

/// Values beyond are not drawn [m, s, m/s].
inline constexpr double kMaxShown = 1e7;

/// Points, column by column [m].
struct Columns3 {
    std::vector<double> x, y, z;
};

/// What became of a candidate of the geometric planner's plan.
enum class Fate {
    chosen,
    clear,           ///< checked: touches nothing, but costs more than the chosen one
    contact,         ///< would touch something
    not_flyable,     ///< more than the vehicle can fly
    more_expensive,  ///< not checked: a cheaper one was clear, or it costs more than GEO_MAX_COST
    budget_spent,    ///< not checked: the work budget was used up
};
[[nodiscard]] std::string_view name_of(Fate fate) noexcept;

/// The fate of a candidate that is not evaluated. A plan evaluates costs first and then checks candidates, cheapest
/// first, until one is clear: with a chosen one, those that have a cost were not checked because they cost as much or
/// more. All others were left out when the budget was used up.
[[nodiscard]] Fate fate_of_unchecked(bool has_cost, bool plan_found, bool above_max_cost) noexcept;
/// Of a status in a log. Not evaluated, or no status at all: budget_spent, until fate_of_unchecked is asked.
[[nodiscard]] Fate fate_of(geometric::CandidateStatus status) noexcept;

/// The curve of a candidate about the line from `start` to `to`, own position at the predicted closest approach [m].
/// @return 25 points, at equal distances along the line; none where the line or the shape is not finite, or has no
/// length
[[nodiscard]] Columns3 candidate_curve(const geometric::CandidateShape& shape, const std::array<double, 3>& start,
                                       const std::array<double, 3>& to);

/// A nominal path: the segments that are not flown yet, and the speed along them.
struct NominalRoute {
    std::vector<path::RouteSegment> segments;
    float speed = 0.0F;     ///< [m/s]
    std::uint8_t last = 0;  ///< number of the last segment in the log
    bool on_route = false;  ///< as the link reports it; else the measured motion
};
/// @return false, and nothing added: the segment has values that no route has, or does not follow those before it
bool add_segment(NominalRoute& route, const NominalTopic& topic);
/// The path from the point abeam of `own` on, as far as it leads in `ahead` seconds [m]. Ends and corners are points,
/// and arcs have a point every 15 degrees.
/// @param own  not finite: from the route's start
/// @return 2 to kMaxNominalPoints; none of an empty route
[[nodiscard]] Columns3 nominal_curve(const NominalRoute& route, const Vec3& own, Seconds ahead);
inline constexpr std::size_t kMaxNominalPoints = 64;

}  // namespace jink::flightlog
