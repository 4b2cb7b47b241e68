// SPDX-License-Identifier: BSD-3-Clause
// The method of docs/guides/writing_a_method.md, asked by a supervisor: with height to spare, and between a floor and a
// ceiling that leave none.
#include <cmath>
#include <cstdio>

#include "core/avoid/supervisor.hpp"
#include "vertical_escape.hpp"

namespace {

using namespace jink;

/// Guidance against a head-on intruder 40 m away, with this much height above and below [m].
avoid::Guidance guidance_with(float height)
{
    const vehicle::VehicleLimits limits;
    const vehicle::Airframe airframe;
    const world::Reference leg({{0, 0, 30}, {100, 0, 30}, 5.0F});
    world::Airspace airspace;
    airspace.has_floor = airspace.has_ceiling = true;
    airspace.floor = 30.0F - height;
    airspace.ceiling = 30.0F + height;
    vehicle::VehicleState own;
    own.position = {0, 0, 30};
    own.velocity = {5, 0, 0};
    world::Track intruder;
    intruder.position = {40, 0, 30};
    intruder.velocity = {-5, 0, 0};
    intruder.radius = 1.0F;
    const world::FlightRules rules;
    static world::ThreatSet threats;
    world::Situation now{{}, own, limits, airframe, leg, rules};
    if (threats.collect(now, {{&intruder, 1}, {}, airspace})) {
        now.threats = threats.all();
    }
    static VerticalEscape method;
    avoid::Supervisor supervisor{avoid::Settings{}, method};
    return supervisor.update(now, true);
}

bool has_no_answer_without_threats()
{
    const vehicle::VehicleState own;
    const vehicle::VehicleLimits limits;
    const vehicle::Airframe airframe;
    const world::Reference leg({{0, 0, 30}, {100, 0, 30}, 5.0F});
    const world::FlightRules rules;
    const world::Situation never_collected{{}, own, limits, airframe, leg, rules};
    VerticalEscape method;
    WorkBudget budget(100'000);
    world::Manoeuvre out;
    return method.plan(never_collected, budget, out) == world::PlanStatus::bad_input;
}

}  // namespace

int main()
{
    const avoid::Guidance free = guidance_with(28.0F);
    const avoid::Guidance narrow = guidance_with(2.5F);
    std::printf("28 m of height: method %d, climb %.1f m/s\n2.5 m of height: method %d, climb %.1f m/s\n", free.by,
                double(free.velocity.z()), narrow.by, double(narrow.velocity.z()));
    const bool climbs = free.by == VerticalEscape::kTraits.id && std::abs(free.velocity.z()) > 1.0F;
    const bool refuses = narrow.by == 0 && narrow.plan_status == world::PlanStatus::none_available;
    return climbs && refuses && has_no_answer_without_threats() ? 0 : 1;
}
