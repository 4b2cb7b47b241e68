// SPDX-License-Identifier: BSD-3-Clause
// Sizes of the types that hold the co-processor's memory, as the sizes of symbols: compiled for a target and read with
// nm, never linked (toolchain/report/memory).
#include "firmware/app/coprocessor.hpp"
#include "firmware/link/mavlink/endpoint.hpp"

using namespace jink;

// NOLINTBEGIN(cppcoreguidelines-avoid-c-arrays)
extern "C" {
char size_of_Coprocessor[sizeof(app::Coprocessor)];
char size_of_Planner[sizeof(geometric::Planner)];
char size_of_ReachPlanner[sizeof(reach::Planner)];
char size_of_ReciprocalPlanner[sizeof(orca::Planner)];
char size_of_Supervisor[sizeof(avoid::Supervisor<geometric::Planner, reach::Planner, orca::Planner>)];
char size_of_TrackTable[sizeof(world::TrackTable)];
char size_of_ObstacleTable[sizeof(world::ObstacleTable)];
char size_of_Endpoint[sizeof(link::mavlink::Endpoint)];
}
// NOLINTEND(cppcoreguidelines-avoid-c-arrays)
