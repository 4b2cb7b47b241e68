// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

// Cost of each kind of work, in the units of WorkBudget: about 100 instructions of a Cortex-M7 each, and never more
// than 170. A weight is the cost of the most expensive path through its code, not of the usual one.
// toolchain/report/units measures the weights again.

namespace jink::units {

/// Doubles are computed in software: the Cortex-M4F's floating-point unit supports floats alone. Such a target has a
/// higher weight for libccd's work, so that a budget bounds its time too. All other targets have the same weights and
/// decide the same.
#if defined(__ARM_FP) && (__ARM_FP & 8) == 0
inline constexpr bool kSoftDoubles = true;
#else
inline constexpr bool kSoftDoubles = false;
#endif

// --- shapes (core/geometry) ---
inline constexpr std::uint32_t kSphereQuery = 10;   ///< box along a segment against a sphere or an upright capsule
inline constexpr std::uint32_t kCapsuleQuery = 28;  ///< against a capsule of any direction
inline constexpr std::uint32_t kSolidQuery = 11;    ///< against any other solid, before the first support call
/// One turn of libccd's loops: a support call of either solid and libccd's work on both results, in doubles.
inline constexpr std::uint32_t kExactTurn = kSoftDoubles ? 330 : 12;
inline constexpr std::uint32_t kBoxDepth = 3;    ///< a box along a segment against a box, before any query
inline constexpr std::uint32_t kSearchTurn = 8;  ///< the same of the distance search, in floats
/// Additional cost of each such turn for a hull.
constexpr std::uint32_t hull_units(std::size_t vertices) noexcept
{
    constexpr std::size_t kVerticesPerUnit = 4;
    return static_cast<std::uint32_t>((vertices + kVerticesPerUnit - 1) / kVerticesPerUnit);
}

// --- separation along a path (core/world/separation) ---
inline constexpr std::uint32_t kPathPiece = 2;     ///< of a path that is checked
inline constexpr std::uint32_t kBoundPiece = 1;    ///< and each bound of the airspace
inline constexpr std::uint32_t kThreat = 3;        ///< track or obstacle
inline constexpr std::uint32_t kThreatChunk = 2;   ///< and eight pieces at once
inline constexpr std::uint32_t kThreatPiece = 3;   ///< and one piece of eight that may be near
inline constexpr std::uint32_t kBoxBound = 2;      ///< and part of a piece, where a box may be far by its own axes
inline constexpr std::uint32_t kSpherePart = 8;    ///< and part of a piece, where the threat is a sphere
inline constexpr std::uint32_t kCylinderPart = 6;  ///< or a cylinder: both ends of it
inline constexpr std::uint32_t kCylinderTurn = 3;  ///< and each instant between them that is checked

// --- conflicts (core/world/conflict) ---
inline constexpr std::uint32_t kConflictLook = 6;      ///< pieces of the nominal path, before any threat
inline constexpr std::uint32_t kConflict = 16;         ///< of the nominal path with a track
inline constexpr std::uint32_t kConflictPart = 8;      ///< and each half second in which it grows
inline constexpr std::uint32_t kConflictSphere = 9;    ///< of the nominal path with a sphere or an upright capsule
inline constexpr std::uint32_t kConflictMet = 24;      ///< and the details of a conflict that is found
inline constexpr std::uint32_t kConflictSolid = 10;    ///< with any other obstacle, but for its queries
inline constexpr std::uint32_t kConflictCylinder = 8;  ///< with a cylinder, but for the instants that are checked

// --- aircraft that are kept well clear of (core/world/well_clear) ---
inline constexpr std::uint32_t kAircraftLook = 14;     ///< a piece of the nominal path with one
inline constexpr std::uint32_t kAircraftCommand = 26;  ///< a command with one

// --- flights predicted by the supervisor (core/avoid) ---
inline constexpr std::uint32_t kFlightPart = 4;      ///< a tenth of a second along a path
inline constexpr std::uint32_t kCommandStep = 3;     ///< a step under a constant command
inline constexpr std::uint32_t kTurnStep = 8;        ///< a step of a turn
inline constexpr std::uint32_t kStopFlight = 40;     ///< whether all can stop: the own flight
inline constexpr std::uint32_t kStopLook = 8;        ///< and a cooperative track, but for its check
inline constexpr std::uint32_t kObjective = 5;       ///< of a flight that is costed
inline constexpr std::uint32_t kObjectivePoint = 1;  ///< and each of its points, and each leg of the route there
inline constexpr std::uint32_t kObjectiveArc = 2;    ///< or arc

// --- candidates (core/geometric) ---
inline constexpr std::uint32_t kPlan = 14;           ///< a plan, before anything else
inline constexpr std::uint32_t kThreatValid = 1;     ///< threat whose numbers are checked, before it is planned for
inline constexpr std::uint32_t kAttempt = 24;        ///< an attempt, before its candidates
inline constexpr std::uint32_t kPlanned = 1;         ///< and a candidate, before it is made
inline constexpr std::uint32_t kPlaneOffsets = 8;    ///< and a family's offsets in a plane
inline constexpr std::uint32_t kMainExtent = 3;      ///< and each extent of the main threat
inline constexpr std::uint32_t kCandidatePoint = 1;  ///< of a curve that is made, each waypoint
inline constexpr std::uint32_t kRoutePoint = 4;      ///< more, where it follows a route
inline constexpr std::uint32_t kRoute = 100;         ///< checks of an attempt along a route before its curves
inline constexpr std::uint32_t kCostPoint = 1;       ///< of a curve that is costed
/// Each waypoint and moving threat of a curve that is costed: a third of a unit.
constexpr std::uint32_t closeness_units(std::size_t points, std::size_t moving) noexcept
{
    return static_cast<std::uint32_t>(points * moving + 2) / 3;
}
inline constexpr std::uint32_t kTableLookUp = 8;      ///< length, duration and smoothness of a curve out of the tables
inline constexpr std::uint32_t kTableEnergy = 24;     ///< its energy, with the limits binding on all of it
inline constexpr std::uint32_t kCollected = 2;        ///< threat or obstacle whose distance from the reach is checked
inline constexpr std::uint32_t kItem = 4;             ///< sphere that a curve is checked against, all of it far
inline constexpr std::uint32_t kFarItem = 2;          ///< and one whose bounds are out of reach of the whole curve
inline constexpr std::uint32_t kSphereCheck = 2;      ///< a closer check of a segment against a sphere
inline constexpr std::uint32_t kSphereCheckPart = 1;  ///< and each part of a segment that is checked by itself
inline constexpr std::uint32_t kSphereContact = 7;    ///< and an exact contact test
inline constexpr std::uint32_t kSolidCheck = 3;       ///< solid that a curve is checked against, all of it far
inline constexpr std::uint32_t kSolidNear = 5;        ///< and one whose bounds are within reach: its planes
inline constexpr std::uint32_t kSolidSegment = 1;     ///< and each segment of one that may be near
inline constexpr std::uint32_t kSolidPlanes = 3;      ///< and a closer check of such a segment, before any query
/// All points of a curve against the airspace's bounds.
constexpr std::uint32_t bounds_units(std::size_t points) noexcept { return static_cast<std::uint32_t>(points / 5 + 1); }
/// All points of a curve against a solid's planes.
constexpr std::uint32_t points_units(std::size_t points) noexcept { return static_cast<std::uint32_t>(points / 3 + 1); }
/// Factor by which a solid lengthens the checks of an attempt: the same number of turns on every target.
inline constexpr std::uint32_t kSolidShares = kSoftDoubles ? 28 : 1;
inline constexpr std::uint32_t kCandidatePart = 3;  ///< part of a candidate's flight
inline constexpr std::uint32_t kCandidateStep = 1;  ///< and each of its points

// --- reach sets (core/reach) ---
inline constexpr std::uint32_t kReachMark = 150;     ///< a set that is placed: its cells' spheres
inline constexpr std::uint32_t kReachDepths = 2;     ///< and sixteen of its nodes
inline constexpr std::uint32_t kReachCells = 2;      ///< and four of its cells and a threat that may come near to them
inline constexpr std::uint32_t kReachSolidCell = 1;  ///< and one of its cells and a solid
inline constexpr std::uint32_t kReachThreat = 2;     ///< threat that may be within a set's reach
inline constexpr std::uint32_t kReachNode = 3;       ///< node that is checked
inline constexpr std::uint32_t kReachQuickRejects = 1;  ///< and three threats that may come near, each a quick reject
inline constexpr std::uint32_t kReachCheck = 3;         ///< and a sphere near it
inline constexpr std::uint32_t kReachContact = 9;       ///< and an exact contact test
inline constexpr std::uint32_t kReachSolid = 6;         ///< or any other solid, or a cylinder
inline constexpr std::uint32_t kReachEntries = 2;       ///< eight entries of footprints, when a set is evaluated
/// When a trajectory is chosen, for each run that is tried.
constexpr std::uint32_t reach_choice_units(std::size_t entries, std::size_t cells) noexcept
{
    return static_cast<std::uint32_t>(entries / 8 + cells / 4 + 4);
}
inline constexpr std::uint32_t kReachPath = 30;      ///< trajectory that is made a path, with a stop at its end
inline constexpr std::uint32_t kReachScanCell = 20;  ///< cell of a set or of a scan, when one is laid over the other

// --- checks of tables in the background (core/reach/vehicle_sets) ---
inline constexpr std::uint32_t kTableElements = 11;  ///< 32 numbers of a table that is checked
inline constexpr std::uint32_t kTableNumbers = 20;   ///< and the numbers of a vehicle's sets

// --- cost to go (core/world/cost_to_go_field) ---
inline constexpr std::uint32_t kFieldSweep = 1;  ///< cell that is swept, blocked or not
inline constexpr std::uint32_t kFieldMark = 1;   ///< cell that is checked against a block
inline constexpr std::uint32_t kFieldCells =
    1;                                      ///< two cells whose bounds are checked, or where the goal is looked for
inline constexpr std::uint32_t kLost = 30;  ///< what obstacles cost from a place on
inline constexpr std::uint32_t kWayAround = 320;  ///< a point on the way past them

// --- maps of convex pieces (core/geometry/mesh_map) ---
inline constexpr std::uint32_t kMeshNode = 2;  ///< node of the tree that is checked: both its children's boxes

// --- orca ---
inline constexpr std::uint32_t kOrcaPair = 4;          ///< another vehicle's half-spaces
inline constexpr std::uint32_t kOrcaSelect = 4;        ///< another vehicle that is kept or left out
inline constexpr std::uint32_t kOrcaPlane = 4;         ///< a plane that is searched for its best point
inline constexpr std::uint32_t kOrcaLine = 4;          ///< and a line
inline constexpr std::uint32_t kOrcaTurn = 2;          ///< a turn of the search, but for these
inline constexpr std::uint32_t kOrcaExchange = 8;      ///< a turn of the search among four half-spaces
inline constexpr std::uint32_t kOrcaDoubleFloat = 16;  ///< each of these in double-float numbers
/// Half-spaces checked.
constexpr std::uint32_t orca_rows(std::size_t rows) noexcept { return static_cast<std::uint32_t>(rows + 3) / 4; }

}  // namespace jink::units
