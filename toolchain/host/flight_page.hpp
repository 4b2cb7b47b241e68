// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/linux/flight_log/shown_curves.hpp"

// Flights as the page of `jink report` shows them, whichever file they come from: a run of jink-sim (run.json) or a
// flight log of jinkd (ULog). World frame: x east, y north, z up; metres, seconds, metres per second.

namespace jink::host {

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// An input that gives no page; the text names file, place and what was expected.
struct BadFlight : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Values beside PageFlight::t; kUnknown where there is none.
using Column = std::vector<double>;
using flightlog::Columns3;
using flightlog::Fate;
using flightlog::fate_of_unchecked;
using flightlog::kMaxShown;

struct PageCandidate {
    Fate fate = Fate::budget_spent;
    double cost = kUnknown;  ///< without the penalty for changing sides
    Columns3 points;         ///< empty: its shape is unknown
};

struct PageDecision {
    double time = 0.0;
    std::string text;
    std::vector<PageCandidate> candidates;
    double known = kUnknown;  ///< candidates of the plan, those that the input does not have too
};

/// A path that conflicts were looked for along.
struct PageNominal {
    double time = 0.0;
    bool on_route = false;  ///< as the link reports it; else from the measured motion
    Columns3 points;
};

/// An obstacle or a closed area as jink believed it, while it did.
struct PageShape {
    /// A geometry::ShapeKind, or this.
    static constexpr unsigned kArea = 5;
    double from = 0.0;
    double until = 0.0;
    unsigned kind = 0;
    bool of_map = false;
    std::array<double, 3> centre{};   ///< at `from`
    std::array<double, 3> half{};     ///< as in flightlog::ObstacleTopic; of an area: z
    std::array<double, 4> turn{1.0};  ///< w, x, y, z: from its own axes into the world's
    double radius = 0.0;
    std::array<double, 2> velocity{};  ///< of an area: east, north
};

struct PageEvent {
    double time = 0.0;
    std::string kind;  ///< "text" (STATUSTEXT), "state", "threat", "closest"
    std::string text;
};

struct PageThreat {
    std::string name;
    std::string form = "sphere";  ///< "sphere" (with half_height: upright capsule), "cylinder", "box"
    double radius = 0.0;
    double half_height = 0.0;
    std::vector<double> half_extents;  ///< of a box
    bool moves = false;
    std::size_t first = 0;  ///< sample of the first position
    Columns3 position;      ///< from sample `first` on; one position where it is at rest
};

/// The mode from a time on.
struct PagePhase {
    double from = 0.0;
    std::string mode;
    bool in_control = false;  ///< jink's commands are flown
};

struct PageFlight {
    std::string name;
    std::string title;
    std::string origin;   ///< where it was flown, or the file
    std::string outcome;  ///< of a simulated flight, in one word
    std::vector<std::string> complaints;
    bool as_expected = true;
    double safety_distance = kUnknown;
    std::string safety_text;  ///< what the distance is kept from what
    double least = kUnknown;  ///< least separation
    double least_time = kUnknown;
    std::string least_threat;
    double alone = kUnknown;          ///< least separation of the same flight without jink
    double planning_time = kUnknown;  ///< longest step that planned [ms]
    Columns3 mission;
    Column t;
    Columns3 own, velocity, command;  ///< command: NaN while jink does not command
    Column separation;                ///< to the nearest surface
    Column work;                      ///< most work units of a step since the last sample; empty: not recorded
    std::vector<PagePhase> phases;
    std::vector<PageEvent> events;
    std::vector<PageDecision> decisions;
    std::vector<PageThreat> threats;
    std::vector<PageNominal> nominal;  ///< in order of time; of a flight log
    std::vector<PageShape> shapes;     ///< in order of `from`; of a flight log
};

/// One input: its flights, in its order.
struct PageSource {
    std::string name;
    std::vector<PageFlight> flights;
};

/// Flights of a run.json. Missing keys are left out; a value of another type than expected is a BadFlight
/// with its line and column.
[[nodiscard]] PageSource read_run(const std::filesystem::path& file);
/// The flight of a ULog file of jinkd, sampled at 10 Hz, up to its damage. BadFlight where nothing can be read.
[[nodiscard]] PageSource read_flight_log(const std::filesystem::path& file);

/// The page: the viewer's page with the data in place of its mark, and nothing that is fetched.
/// @param viewer  viewer.html, which contains kDataMark once
[[nodiscard]] std::string make_page(std::string_view viewer, const std::vector<PageSource>& sources);
inline constexpr std::string_view kDataMark = "\"JINK_FLIGHTS\"";

/// The flights as JSON text that may stand in a script element. Columns are `{from, step, bytes, data}`: little-endian
/// codes of 2 or 4 bytes in base64, value = from + step * code, the greatest code for kUnknown.
[[nodiscard]] std::string page_data(const std::vector<PageSource>& sources);

}  // namespace jink::host
