// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/closed_area.hpp"

#include <algorithm>
#include <cmath>

#include "toolchain/sim/scenario_parts.hpp"

namespace jink::sim {

double surface_distance(const ClosedArea& area, double t, const Vec& point)
{
    const Vec off = point - area.centre_at(t);
    const double beside = std::hypot(off.x(), off.y()) - area.radius;
    const double beyond = std::max(area.bottom - point.z(), point.z() - area.top);
    if (beside <= 0.0 && beyond <= 0.0) {
        return std::max(beside, beyond);
    }
    return std::hypot(std::max(beside, 0.0), std::max(beyond, 0.0));
}

std::vector<app::Constraint> constraints_of(const std::vector<ClosedArea>& areas, TimePoint start)
{
    std::vector<app::Constraint> constraints;
    for (const ClosedArea& area : areas) {
        app::Constraint constraint;
        constraint.cylinder.circle = {area.centre.head<2>().cast<float>(), static_cast<float>(area.radius)};
        constraint.cylinder.velocity = area.velocity.head<2>().cast<float>();
        constraint.cylinder.bottom = static_cast<float>(area.bottom);
        constraint.cylinder.top = static_cast<float>(area.top);
        constraint.cylinder.margin = static_cast<float>(area.margin);
        constraint.stamp = start;
        constraints.push_back(constraint);
    }
    return constraints;
}

namespace detail {

void read_areas(YamlMap& root, std::vector<ClosedArea>& out, Complaints& complaints)
{
    const auto list = root.list("closed_areas");
    for (std::size_t i = 0; list && i < list->size(); ++i) {
        YamlMap map((*list)[i], item_name("closed_areas", i), root.file(), complaints);
        if (!map.is_map()) {
            continue;
        }
        ClosedArea area;
        area.name = map.text("name").value_or("area_" + std::to_string(i + 1));
        number(map, "radius", area.radius, {0.1F, 1e4F}, kNeed);
        number(map, "bottom", area.bottom, kPlace, kNeed);
        number(map, "top", area.top, kPlace, kNeed);
        number(map, "margin", area.margin, {0.0F, 1e4F});
        vector(map, "centre", area.centre, kPlace, kNeed);
        vector(map, "velocity", area.velocity, {-200.0F, 200.0F});
        if (area.top < area.bottom) {
            map.complain("top", "lies below the bottom");
        }
        if (area.velocity.z() != 0.0) {
            map.complain("velocity", "is level: its third number is 0");
        }
        map.finish();
        out.push_back(area);
    }
}

}  // namespace detail
}  // namespace jink::sim
