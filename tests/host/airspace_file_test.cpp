// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "firmware/linux/airspace_file.hpp"

#include <cmath>

#include "firmware/link/mavlink/geodesy.hpp"
#include "tests/host/scratch.hpp"

namespace {

using namespace jink;
using namespace jink::files;
using test::with;

constexpr BothClocks kNow{1'800'000'000.0, {90'000'000}};

std::optional<std::vector<app::Constraint>> read(const std::string& text, Complaints& complaints)
{
    return parse_airspace(text, "a.yaml", kNow, complaints);
}

const std::string kCircle = "frame: local\nareas:\n  - {centre: [10, 20], radius: 5, bottom: 1, top: 9";

TEST(AirspaceFile, TheExampleIsReadAsItSays)
{
    Complaints complaints;
    const auto areas = read_airspace_file(JINK_SOURCES "/firmware/airspace/example.yaml", kNow, complaints);
    ASSERT_TRUE(areas) << test::all_of(complaints);
    ASSERT_EQ(areas->size(), 2U);
    const app::Constraint& airfield = (*areas)[0];
    ASSERT_TRUE(airfield.about);
    EXPECT_EQ(airfield.about->alt, 0);
    EXPECT_EQ(airfield.cylinder.margin, 50.0F);
    EXPECT_EQ(airfield.cylinder.top, 600.0F);
    EXPECT_EQ(airfield.stamp, kNow.own);
    // Each corner lies in it, and two at least on its border.
    int on_border = 0;
    for (const auto& [lat, lon] : {std::pair{387380000, -91390000}, std::pair{387400000, -91300000},
                                   std::pair{387350000, -91280000}, std::pair{387330000, -91370000}}) {
        const Vec3 corner = link::mavlink::to_local({lat, lon, 0}, *airfield.about);
        const float off = std::hypot(corner.x(), corner.y());
        EXPECT_LE(off, airfield.cylinder.circle.radius);
        on_border += off > airfield.cylinder.circle.radius - 1.0F ? 1 : 0;
    }
    EXPECT_GE(on_border, 2);
    EXPECT_LT(airfield.cylinder.circle.radius, 600.0F);
    const app::Constraint& storm = (*areas)[1];
    EXPECT_EQ(storm.about->lat, 387600000);
    EXPECT_EQ(storm.about->lon, -91600000);
    EXPECT_EQ(storm.cylinder.circle.radius, 400.0F);
    EXPECT_EQ(storm.cylinder.velocity, world::Vec2(4, -2));
    EXPECT_NEAR(kNow.own - storm.stamp, 1e7F, 2.0F);
    EXPECT_EQ(storm.ends.us - storm.stamp.us, 3'600'000'000);
}

TEST(AirspaceFile, LocalPlacesAreMetres)
{
    Complaints complaints;
    const auto areas = read(kCircle + "}\n  - {polygon: [[0, 0], [8, 0], [8, 6]], bottom: -5, top: -5}\n", complaints);
    ASSERT_TRUE(areas) << test::all_of(complaints);
    EXPECT_FALSE((*areas)[0].about);
    EXPECT_EQ((*areas)[0].cylinder.circle.centre, world::Vec2(10, 20));
    EXPECT_EQ((*areas)[0].cylinder.circle.radius, 5.0F);
    EXPECT_NEAR((*areas)[1].cylinder.circle.centre.x(), 4.0F, 1e-3F);
    EXPECT_NEAR((*areas)[1].cylinder.circle.centre.y(), 3.0F, 1e-3F);
    EXPECT_NEAR((*areas)[1].cylinder.circle.radius, 5.0F, 2e-3F);
    EXPECT_GE((*areas)[1].cylinder.circle.radius, 5.0F);
}

TEST(AirspaceFile, AnEmptyListClosesNothing)
{
    Complaints complaints;
    const auto areas = read("frame: global\nareas: []\n", complaints);
    ASSERT_TRUE(areas) << test::all_of(complaints);
    EXPECT_TRUE(areas->empty());
}

TEST(AirspaceFile, WhatMovesNeedsItsTime)
{
    Complaints complaints;
    EXPECT_FALSE(read(kCircle + ", velocity: [1, 0]}\n", complaints));
    EXPECT_TRUE(with(complaints, "known_at")) << test::all_of(complaints);
    complaints.clear();
    const auto areas = read(kCircle + ", velocity: [1, 0], known_at: 1799999990.5}\n", complaints);
    ASSERT_TRUE(areas) << test::all_of(complaints);
    EXPECT_EQ((*areas)[0].stamp.us, kNow.own.us - 9'500'000);
    complaints.clear();
    EXPECT_FALSE(read(kCircle + ", known_at: 1800000001}\n", complaints));
    EXPECT_TRUE(with(complaints, "future")) << test::all_of(complaints);
}

/// Each by its line; nothing is taken of a file of which anything is wrong.
TEST(AirspaceFile, WhatIsWrongIsNamedByItsLine)
{
    const auto expect = [](const std::string& text, const std::string& what, std::size_t line) {
        Complaints complaints;
        EXPECT_FALSE(read(text, complaints)) << text;
        const Complaint* complaint = with(complaints, what);
        ASSERT_NE(complaint, nullptr) << text << test::all_of(complaints);
        EXPECT_EQ(complaint->line, line) << test::all_of(complaints);
        EXPECT_EQ(complaint->file, "a.yaml");
    };
    expect("areas: []\n", "frame", 1);
    expect("frame: flat\nareas: []\n", "flat", 1);
    expect("frame: local\n", "areas", 1);
    expect("frame: local\nareas:\n  - {bottom: 1, top: 2}\n", "either", 3);
    expect(kCircle + ", polygon: [[0, 0], [1, 0], [1, 1]]}\n", "either", 3);
    expect("frame: local\nareas:\n  - {centre: [10, 20], bottom: 1, top: 9}\n", "radius", 3);
    expect("frame: local\nareas:\n  - {centre: [10, 20], radius: 0, bottom: 1, top: 9}\n", "radius", 3);
    expect("frame: local\nareas:\n  - {centre: [10, 20], radius: .nan, bottom: 1, top: 9}\n", "radius", 3);
    expect("frame: local\nareas:\n  - {centre: [10], radius: 5, bottom: 1, top: 9}\n", "two numbers", 3);
    expect("frame: local\nareas:\n  - {centre: !!set [10, 20], radius: 5, bottom: 1, top: 9}\n", "no tag is wanted", 3);
    expect("frame: local\nareas:\n  - {centre: [10, 20], radius: 5, top: 9}\n", "bottom", 3);
    expect("frame: local\nareas:\n  - {centre: [10, 20], radius: 5, bottom: 10, top: 9}\n", "lies below", 3);
    expect(kCircle + ", margin: -1}\n", "margin", 3);
    expect(kCircle + ", velocity: [900, 0], known_at: 5}\n", "velocity", 3);
    expect(kCircle + ", colour: red}\n", "colour", 3);
    expect("frame: local\nareas:\n  - {polygon: [[0, 0], [1, 0]], bottom: 1, top: 9}\n", "corners", 3);
    expect("frame: local\nareas:\n  - {polygon: [[0, 0], [0, 0], [0, 0]], bottom: 1, top: 9}\n", "no area", 3);
    expect("frame: global\nareas:\n  - {centre: [89, 20], radius: 5, bottom: 1, top: 9}\n", "centre[0]", 3);
    expect("frame: global\nareas:\n  - {centre: [8, 200], radius: 5, bottom: 1, top: 9}\n", "centre[1]", 3);
    expect("frame: global\nareas:\n  - {polygon: [[0, 0], [20, 0], [0, 20]], bottom: 1, top: 9}\n", "no area", 3);
}

TEST(AirspaceFile, TheUserReadsHowManyAreClosedAndHowManyHaveExpired)
{
    Complaints complaints;
    const auto areas =
        read(kCircle + "}\n" + "  - {centre: [0, 0], radius: 5, bottom: 1, top: 9, until: 1700000000}\n" +
                 "  - {centre: [9, 0], radius: 5, bottom: 1, top: 9, until: 1800000000}\n" +
                 "  - {centre: [9, 9], radius: 5, bottom: 1, top: 9, until: 1800000007}\n",
             complaints);
    ASSERT_TRUE(areas) << test::all_of(complaints);
    EXPECT_EQ(areas_text("a.yaml", *areas, kNow.own), "a.yaml: 3 areas are closed, 1 has expired");
    const TimePoint later{kNow.own.us + 8'000'000};
    EXPECT_EQ(areas_text("a.yaml", *areas, later), "a.yaml: 1 area is closed, 3 have expired");
    EXPECT_EQ(areas_text("a.yaml", {}, later), "a.yaml: 0 areas are closed");
}

}  // namespace
