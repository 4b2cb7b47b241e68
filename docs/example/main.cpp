// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>

#include "core/avoid/supervisor.hpp"
#include "core/geometric/planner.hpp"

int main()
{
    using namespace jink;
    const vehicle::VehicleLimits limits;  // 5 m/s cruise, 3 m/s climb, a safety box of 2 m
    const vehicle::Airframe airframe;
    const world::Reference reference({{0, 0, 30}, {100, 0, 30}, 5.0F});  // a level leg eastwards
    world::Airspace airspace;
    airspace.has_floor = true;
    airspace.floor = 2.0F;
    vehicle::VehicleState own;
    own.position = {0, 0, 30};
    own.velocity = {5, 0, 0};
    world::Track intruder;
    intruder.position = {40, 0.5F, 30};
    intruder.velocity = {-5, 0, 0};
    intruder.radius = 1.0F;

    geometric::Planner planner{geometric::Settings{}};
    avoid::Supervisor supervisor{avoid::Settings{}, planner};
    const world::FlightRules rules;  // 8 s of look-ahead, 3 standard deviations
    static world::ThreatSet threats;
    world::Situation now{{}, own, limits, airframe, reference, rules};
    if (threats.collect(now, {{&intruder, 1}, {}, airspace})) {
        now.threats = threats.all();  // else everything counts as contact
    }
    const avoid::Guidance guidance = supervisor.update(now, true);  // once per tick, with the vehicle under our control
    std::printf("conflict in %.1f s, fly (%.2f, %.2f, %.2f) m/s\n",
                double(guidance.conflict ? guidance.conflict->time_to_loss : 0.0F), double(guidance.velocity.x()),
                double(guidance.velocity.y()), double(guidance.velocity.z()));
    return guidance.wants_control ? 0 : 1;
}
