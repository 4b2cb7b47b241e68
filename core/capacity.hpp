// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Every capacity in one place. Each may be set on the compiler's command line, to a plain number within the range that
// is asserted below; sizeof figures per target are in the memory report. A full container gives way as its owner's
// header says, and counts it.
//
// Capacities are part of the package: units that were compiled with different ones do not link. The linker then misses
// a symbol whose name lists the capacities of the unit that asks for it, in the order below.

#include <cstddef>

#ifndef JINK_MAX_TRACKS
#define JINK_MAX_TRACKS 64
#endif
#ifndef JINK_MAX_OBSTACLES
#define JINK_MAX_OBSTACLES 96
#endif
#ifndef JINK_MAX_CYLINDERS
#define JINK_MAX_CYLINDERS 32
#endif
#ifndef JINK_MAX_PATH_POINTS
#define JINK_MAX_PATH_POINTS 64
#endif
#ifndef JINK_MAX_ROUTE_SEGMENTS
#define JINK_MAX_ROUTE_SEGMENTS 4
#endif
#ifndef JINK_MAX_CANDIDATES
#define JINK_MAX_CANDIDATES 512
#endif
#ifndef JINK_MAX_HULL_VERTICES
#define JINK_MAX_HULL_VERTICES 64
#endif
#ifndef JINK_MAX_REACH_NODES
#define JINK_MAX_REACH_NODES 4096
#endif
#ifndef JINK_MAX_REACH_CELLS
#define JINK_MAX_REACH_CELLS 512
#endif
#ifndef JINK_MAX_COMMANDS
#define JINK_MAX_COMMANDS 64
#endif
#ifndef JINK_MAX_OBSTACLE_PLANES
#define JINK_MAX_OBSTACLE_PLANES 16
#endif
#ifndef JINK_MAX_ORCA_PLANES
#define JINK_MAX_ORCA_PLANES 54
#endif
#ifndef JINK_MAX_ORCA_NEIGHBOURS
#define JINK_MAX_ORCA_NEIGHBOURS 16
#endif
#ifndef JINK_MAX_MISSION_ITEMS
#define JINK_MAX_MISSION_ITEMS 64
#endif

#define JINK_TEXT_OF(x) #x
#define JINK_CAPACITY(name) "_" JINK_TEXT_OF(name)
/// Name of the symbol that core defines, and every unit that includes this header asks for.
#define JINK_CAPACITIES_SYMBOL                                                                                         \
    "jink_capacities" JINK_CAPACITY(JINK_MAX_TRACKS) JINK_CAPACITY(JINK_MAX_OBSTACLES)                                 \
        JINK_CAPACITY(JINK_MAX_CYLINDERS) JINK_CAPACITY(JINK_MAX_PATH_POINTS) JINK_CAPACITY(JINK_MAX_ROUTE_SEGMENTS)   \
            JINK_CAPACITY(JINK_MAX_CANDIDATES) JINK_CAPACITY(JINK_MAX_HULL_VERTICES)                                   \
                JINK_CAPACITY(JINK_MAX_REACH_NODES) JINK_CAPACITY(JINK_MAX_REACH_CELLS)                                \
                    JINK_CAPACITY(JINK_MAX_COMMANDS) JINK_CAPACITY(JINK_MAX_OBSTACLE_PLANES)                           \
                        JINK_CAPACITY(JINK_MAX_ORCA_PLANES) JINK_CAPACITY(JINK_MAX_ORCA_NEIGHBOURS)                    \
                            JINK_CAPACITY(JINK_MAX_MISSION_ITEMS)
// 4 bytes of flash in all: equal references are one group. Kept by the linker (R) whatever else it leaves out.
asm(".pushsection .jink_capacities, \"aGR\", %progbits, " JINK_CAPACITIES_SYMBOL "_asked, comdat\n\t.balign 4\n"
    "\t.4byte " JINK_CAPACITIES_SYMBOL " - .\n\t.popsection");

namespace jink {

/// Tracks kept at once: 31 vehicles of a swarm, 25 obstacles that move, and traffic beside them. 32, which boards have,
/// cover an ADS-B receiver's nearest traffic plus own detections.
/// When full, the least urgent track gives way (TrackTable), and TrackTable counts it.
inline constexpr std::size_t kMaxTracks = JINK_MAX_TRACKS;
static_assert(kMaxTracks >= 1 && kMaxTracks <= 256);

/// Tracks kept under one id: two aircraft with one address, the ghost that a jump leaves, and one more. Beyond that the
/// least urgent track of the id gives way, and TrackTable counts it.
inline constexpr std::size_t kMaxSameId = 4;

/// Obstacles known at once: a 72-sector range scan, and 24 surveyed ones.
/// When full, the obstacle farthest from the vehicle gives way, and ObstacleTable counts it.
inline constexpr std::size_t kMaxObstacles = JINK_MAX_OBSTACLES;
static_assert(kMaxObstacles >= 1 && kMaxObstacles <= 1024);

/// Places among the obstacles that are kept for a map, where there is one; sensed obstacles then have the others. When
/// the map has more pieces within reach, boxes that hold several of them stand for those farthest away (append_map):
/// nothing is lost, more than needed may be closed.
inline constexpr std::size_t kMaxMapObstacles = kMaxObstacles < 4 ? 1 : kMaxObstacles / 4;

/// Closed volumes and storm cells at once (Gomola 6.6.5). When there are more, the two farthest become one that holds
/// both, and CylinderTable::merged() counts it: nothing is lost, more than needed may be closed.
inline constexpr std::size_t kMaxCylinders = JINK_MAX_CYLINDERS;
static_assert(kMaxCylinders >= 2 && kMaxCylinders <= 256);

/// Points of a timed path. 57 reproduce the geometric planner's distribution study, 64 leave space for a tail.
inline constexpr std::size_t kMaxPathPoints = JINK_MAX_PATH_POINTS;
static_assert(kMaxPathPoints >= 34 && kMaxPathPoints <= 1024);

/// Legs and arcs of a route: the one being flown and those that a manoeuvre may reach past its end. One more is
/// refused.
inline constexpr std::size_t kMaxRouteSegments = JINK_MAX_ROUTE_SEGMENTS;
static_assert(kMaxRouteSegments >= 1 && kMaxRouteSegments <= 16);

/// Candidates of one geometric plan: l (n + 1) per family. A setting that asks for more is refused as a whole.
inline constexpr std::size_t kMaxCandidates = JINK_MAX_CANDIDATES;
static_assert(kMaxCandidates >= 8 && kMaxCandidates <= 4096);

/// Vertices of one convex hull in a constant table; a larger one is refused.
inline constexpr std::size_t kMaxHullVertices = JINK_MAX_HULL_VERTICES;
static_assert(kMaxHullVertices >= 4 && kMaxHullVertices <= 1024);

/// Nodes of a reach set that is flown; a larger set is refused. A byte each.
inline constexpr std::size_t kMaxReachNodes = JINK_MAX_REACH_NODES;
static_assert(kMaxReachNodes >= 16 && kMaxReachNodes <= 65534);

/// Cells of its grid: 10 layers of 7 columns and 5 rows are 350. Two bytes each, and a bit for each threat.
inline constexpr std::size_t kMaxReachCells = JINK_MAX_REACH_CELLS;
static_assert(kMaxReachCells >= 16 && kMaxReachCells <= 4096);

/// Velocity commands that a vehicle remembers to predict itself across its delay: 1.6 s at 40 Hz, where 22 bridge the
/// half second that was measured in flight (Alejo 8.4). When full the oldest is overwritten, and a prediction that
/// would need it says so. 24 bytes each.
inline constexpr std::size_t kMaxCommands = JINK_MAX_COMMANDS;
static_assert(kMaxCommands >= 8 && kMaxCommands <= 1024);

/// Half-spaces of static obstacles that one velocity has to keep to. When more pieces are within
/// reach, the nearest ones count and a bound of the speed stands in for all others (ObstaclePlanes::speed_cap). 32
/// bytes each.
inline constexpr std::size_t kMaxObstaclePlanes = JINK_MAX_OBSTACLE_PLANES;
static_assert(kMaxObstaclePlanes >= 4 && kMaxObstaclePlanes <= 64);

/// Half-spaces of one velocity program: 6 of limits, 16 of obstacles, two for each of 16 neighbours. 38 bytes each of
/// scratch; a program with more is refused.
inline constexpr std::size_t kMaxOrcaPlanes = JINK_MAX_ORCA_PLANES;
static_assert(kMaxOrcaPlanes >= 8 && kMaxOrcaPlanes <= 1024);

/// Neighbours that get half-spaces of their own. When there are more, those that could be met last give way, and the
/// own speed is capped for their sake: nothing is lost.
inline constexpr std::size_t kMaxOrcaNeighbours = JINK_MAX_ORCA_NEIGHBOURS;
static_assert(kMaxOrcaNeighbours >= 1 && kMaxOrcaNeighbours <= 256);

/// Mission items kept at once, 20 bytes each. A longer mission is kept around its current item, a quarter of the items
/// before it; when the current item leaves what is kept, the mission is read again.
inline constexpr std::size_t kMaxMissionItems = JINK_MAX_MISSION_ITEMS;
static_assert(kMaxMissionItems >= 4 && kMaxMissionItems <= 4096);

}  // namespace jink
