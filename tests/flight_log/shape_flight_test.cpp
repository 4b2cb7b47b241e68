// SPDX-License-Identifier: BSD-3-Clause
// Flights whose log, and its page, are held against the obstacles and closed areas that the co-processor believed.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <set>

#include "firmware/linux/flight_log/shown_shapes.hpp"
#include "tests/flight_log/recorded_flight.hpp"
#include "tests/host/scratch.hpp"
#include "toolchain/host/flight_page.hpp"
#include "toolchain/sim/scenario_file.hpp"

namespace {

using namespace jink;
using namespace jink::test;
using namespace jink::flightlog;
using geometry::ShapeKind;

/// The tables of each step, by its time on the clock of the log.
struct Belief {
    std::vector<world::Obstacle> obstacles;
    std::vector<world::Cylinder> areas;
};

struct BelievedFlight {
    RecordedFlight flight;
    std::map<std::uint64_t, Belief> belief;
};

BelievedFlight fly_believed(const char* scenario_name, double duration)
{
    sim::Scenario scenario = sim::load_scenario(std::string(JINK_SCENARIOS "/") + scenario_name);
    scenario.duration = duration;
    BelievedFlight flown;
    std::uint64_t last = 0;
    FlightOptions options;
    options.beside = [&](std::uint64_t, TimePoint now, app::Coprocessor& coprocessor, HalRecorder&) {
        const std::span<const world::Obstacle> o = coprocessor.obstacles();
        const std::span<const world::Cylinder> a = coprocessor.closed_areas();
        flown.belief[last] = {{o.begin(), o.end()}, {a.begin(), a.end()}};  // after the step before
        last = static_cast<std::uint64_t>(now.us);
    };
    flown.flight = fly_recorded(scenario, {}, options);
    return flown;
}

/// Compares each message with what was believed, and counts.
void expect_believed(const BelievedFlight& flown, std::size_t& obstacles, std::size_t& areas)
{
    std::istringstream in(flown.flight.log);
    ulog::Reader log(in);
    std::set<std::pair<std::uint64_t, std::uint16_t>> seen;
    while (const auto message = log.next()) {
        if (message->type != ulog::Type::data) {
            continue;
        }
        const std::string& name = log.topic(ulog::read_number<std::uint16_t>(message->content))->name;
        const auto content = message->content.subspan(2);
        if (name == "jink_obstacle") {
            ObstacleTopic o;
            std::memcpy(static_cast<void*>(&o), content.data(), kBytesOf<ObstacleTopic>);
            const Belief& belief = flown.belief.at(o.known);
            ASSERT_EQ(o.obstacles, belief.obstacles.size());
            ASSERT_EQ(o.areas, belief.areas.size());
            const world::Obstacle& truly = belief.obstacles.at(o.number);
            ASSERT_EQ(o.id, truly.id);
            ASSERT_EQ(o.centre, xyz_of(truly.shape.centre));
            ASSERT_EQ(o.radius, truly.shape.radius);
            ASSERT_EQ(o.uncertainty, truly.uncertainty);
            ASSERT_FALSE(o.of_map);
            ASSERT_TRUE(seen.emplace(o.known, o.number).second);
            ++obstacles;
        } else if (name == "jink_area") {
            AreaTopic a;
            std::memcpy(static_cast<void*>(&a), content.data(), kBytesOf<AreaTopic>);
            const Belief& belief = flown.belief.at(a.known);
            ASSERT_EQ(a.areas, belief.areas.size());
            const world::Cylinder& truly = belief.areas.at(a.number);
            ASSERT_EQ(a.centre, (std::array{truly.circle.centre.x(), truly.circle.centre.y()}));
            ASSERT_EQ(a.velocity, (std::array{truly.velocity.x(), truly.velocity.y()}));
            ASSERT_EQ(a.radius, truly.circle.radius);
            ASSERT_EQ(a.margin, truly.margin);
            ++areas;
        }
    }
}

/// Each solid of the page was believed at its beginning, and the page has as many as a round at each.
void expect_page(const BelievedFlight& flown, unsigned kind)
{
    const Scratch scratch;
    const host::PageFlight page = host::read_flight_log(scratch.write("flight.ulg", flown.flight.log)).flights.at(0);
    ASSERT_GT(page.shapes.size(), 0U);
    const std::uint64_t start = std::next(flown.belief.begin())->first;  // the first entry is of before
    std::set<double> begins;
    for (const host::PageShape& shape : page.shapes) {
        const auto at = start + static_cast<std::uint64_t>(std::llround(shape.from * 1e6));
        const Belief& belief = flown.belief.at(at);
        const bool is_believed =
            shape.kind == host::PageShape::kArea
                ? std::any_of(belief.areas.begin(), belief.areas.end(),
                              [&](const world::Cylinder& c) {
                                  return double(c.circle.centre.x()) == shape.centre[0] &&
                                         double(c.circle.centre.y()) == shape.centre[1] &&
                                         double(c.top - c.bottom) == 2.0 * shape.half[2];
                              })
                : std::any_of(belief.obstacles.begin(), belief.obstacles.end(), [&](const world::Obstacle& o) {
                      return double(o.shape.centre.x()) == shape.centre[0] && double(o.shape.radius) == shape.radius;
                  });
        EXPECT_TRUE(is_believed) << shape.from;
        EXPECT_GT(shape.until, shape.from);
        EXPECT_LE(begins.empty() ? 0.0 : *begins.rbegin(), shape.from) << "in order";
        begins.insert(shape.from);
    }
    EXPECT_GT(
        std::count_if(page.shapes.begin(), page.shapes.end(), [&](const host::PageShape& s) { return s.kind == kind; }),
        0);
    for (const double time : begins) {
        const Belief& belief = flown.belief.at(start + static_cast<std::uint64_t>(std::llround(time * 1e6)));
        const auto shown = std::count_if(page.shapes.begin(), page.shapes.end(),
                                         [&](const host::PageShape& s) { return s.from <= time && time < s.until; });
        EXPECT_EQ(static_cast<std::size_t>(shown), belief.obstacles.size() + belief.areas.size()) << time;
    }
}

TEST(ShapeFlight, ALogSaysWhatWasBelievedOfAWallThatIsSeen)
{
    const BelievedFlight flown = fly_believed("scan_wall.yaml", 20.0);
    std::size_t obstacles = 0;
    std::size_t areas = 0;
    expect_believed(flown, obstacles, areas);
    EXPECT_GT(obstacles, 20U);
    EXPECT_EQ(areas, 0U);
    expect_page(flown, static_cast<unsigned>(ShapeKind::capsule));
    EXPECT_TRUE(replay(flown.flight.log).is_identical());
}

TEST(ShapeFlight, ALogSaysWhatWasBelievedOfAStormThatMoves)
{
    const BelievedFlight flown = fly_believed("storm_crossing.yaml", 25.0);
    std::size_t obstacles = 0;
    std::size_t areas = 0;
    expect_believed(flown, obstacles, areas);
    EXPECT_GT(areas, 10U);
    EXPECT_EQ(obstacles, 0U);
    expect_page(flown, host::PageShape::kArea);
    EXPECT_TRUE(replay(flown.flight.log).is_identical());
}

}  // namespace
