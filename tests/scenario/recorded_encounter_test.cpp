// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/recorded_encounter.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "toolchain/sim/recorded_command.hpp"

namespace jink::sim {
namespace {

RecordedEncounter read_text(const std::string& text)
{
    std::istringstream in(text);
    return read_encounter(in, "some.daa");
}

/// The text of the exception.
std::string refusal_of_encounter(const std::string& text)
{
    try {
        static_cast<void>(read_text(text));
    } catch (const std::runtime_error& e) {
        return e.what();
    }
    return "";
}

const std::string kLocalNames = "NAME sx sy sz vx vy vz time\n";
const std::string kMetres = "[none] [m] [m] [m] [m/s] [m/s] [m/s] [s]\n";
const std::string kTwoRows = "Own 0 0 100 10 0 0 0\nOther 500 20 110 -10 0 1 0\n";

TEST(RecordedEncounterFile, ReadsWhatDaidalusWrites)
{
    // Columns that are not read: strings, unknown units, non-numeric values.
    const RecordedEncounter e =
        read_text("## DAAGenerator -lat 40\n"
                  "Conflict_Time = 100 [s]\n"
                  "NAME lat lon alt trk gs vs heading airspeed time alerter pressure phase\n"
                  "[none] [deg] [deg] [ft] [deg] [knot] [fpm] [deg] [knot] [s] [none] [hPa] [none]\n"
                  "Ownship, 40.0, -74.0, 1000.0, 90.0, 100.0, 600.0, 90, 100, 5.0, 1, nan, cruise # a remark\n"
                  "Intruder, 40.01, -74.0, 2000.0, 180.0, 36.0, 0.0, 180, 36, 5.0, default, 990, -\n");
    ASSERT_EQ(e.aircraft.size(), 2U);
    EXPECT_EQ(e.aircraft[0].name, "Ownship");
    const Fix& own = e.aircraft[0].fixes.at(0);
    EXPECT_EQ(own.time, 5.0);
    EXPECT_LT((own.position - Vec(0.0, 0.0, 304.8)).norm(), 1e-9);
    EXPECT_LT((own.velocity - Vec(100.0 * 1852.0 / 3600.0, 0.0, 3.048)).norm(), 1e-9);
    const Fix& other = e.aircraft[1].fixes.at(0);
    EXPECT_NEAR(other.position.y(), 1110.4, 0.5);  // a hundredth of a degree at 40 degrees: 111.04 km to the degree
    EXPECT_NEAR(other.position.z(), 609.6, 1e-9);
    EXPECT_LT((other.velocity - Vec(0.0, -18.52, 0.0)).norm(), 1e-9);
}

/// Each unit of a length, a speed, an angle and a time, by its definition.
TEST(RecordedEncounterFile, ConvertsUnits)
{
    const auto length = [](const std::string& unit) {
        const std::string u = unit.empty() ? "-" : unit;
        return read_text(kLocalNames + "[none] " + u +
                         " [m] [m] [m/s] [m/s] [m/s] [s]\nOwn 2 0 0 0 0 0 0\nB 1 0 0 0 0 0 0\n")
            .aircraft[0]
            .fixes[0]
            .position.x();
    };
    EXPECT_DOUBLE_EQ(length("[m]"), 2.0);
    EXPECT_DOUBLE_EQ(length("m"), 2.0);
    EXPECT_DOUBLE_EQ(length("[km]"), 2000.0);
    EXPECT_DOUBLE_EQ(length("[ft]"), 0.6096);
    EXPECT_DOUBLE_EQ(length("(feet)"), 0.6096);
    EXPECT_DOUBLE_EQ(length("[nmi]"), 3704.0);
    EXPECT_DOUBLE_EQ(length("[NM]"), 3704.0);
    EXPECT_DOUBLE_EQ(length("[mi]"), 3218.688);
    EXPECT_DOUBLE_EQ(length(""), 3704.0) << "of sx where no unit is given";
    const auto speed = [](const std::string& unit) {
        return read_text(kLocalNames + "- [m] [m] [m] " + unit +
                         " [m/s] [m/s] [min]\nOwn 0 0 0 3 0 0 2\nB 1 0 0 0 0 0 0\n")
            .aircraft[0]
            .fixes[0];
    };
    EXPECT_DOUBLE_EQ(speed("[m/s]").velocity.x(), 3.0);
    EXPECT_DOUBLE_EQ(speed("[knot]").velocity.x(), 3.0 * 1852.0 / 3600.0);
    EXPECT_DOUBLE_EQ(speed("[kn]").velocity.x(), 3.0 * 1852.0 / 3600.0);
    EXPECT_DOUBLE_EQ(speed("[kts]").velocity.x(), 3.0 * 1852.0 / 3600.0);
    EXPECT_NEAR(speed("[fpm]").velocity.x(), 0.01524, 1e-12);
    EXPECT_NEAR(speed("[ft/s]").velocity.x(), 0.9144, 1e-12);
    EXPECT_NEAR(speed("[km/h]").velocity.x(), 3.0 / 3.6, 1e-12);
    EXPECT_EQ(speed("[m/s]").time, 120.0);
    const Vec turned = read_text("id x y z track groundspeed hdot clock\n- m m m [rad] [m/s] [m/s] -\n"
                                 "Own 0 0 0 1.5707963267948966 4 0 0:01:30\nB 1 0 0 0 0 0 0:00:00\n")
                           .aircraft[0]
                           .fixes[0]
                           .velocity;
    EXPECT_LT((turned - Vec(4.0, 0.0, 0.0)).norm(), 1e-12);
}

TEST(RecordedEncounterFile, WithoutUnitsItIsDaidalussOwn)
{
    const RecordedEncounter e = read_text(kLocalNames + "Own 1 0 100 60 0 600 7\nOther 2 0 100 0 0 0 7\n");
    const Fix& own = e.aircraft[0].fixes[0];
    EXPECT_DOUBLE_EQ(own.position.x(), 1852.0);
    EXPECT_DOUBLE_EQ(own.position.z(), 30.48);
    EXPECT_NEAR(own.velocity.x(), 1852.0 / 60.0, 1e-9);
    EXPECT_NEAR(own.velocity.z(), 3.048, 1e-9);
}

TEST(RecordedEncounterFile, RefusesWithLineAndColumn)
{
    const std::string units = kLocalNames + kMetres;
    EXPECT_EQ(refusal_of_encounter("NAME sx sy sz vx vy time\n"), "some.daa:1:25: column vz is missing");
    EXPECT_EQ(refusal_of_encounter("# a remark\n\nsx sy sz vx vy vz time\n"), "some.daa:3:23: column name is missing");
    EXPECT_EQ(refusal_of_encounter(kLocalNames + "[none] [m] [furlong] [m] [m/s] [m/s] [m/s] [s]\n" + kTwoRows),
              "some.daa:2:12: unit 'furlong' of column 'sy' is not known");
    EXPECT_EQ(refusal_of_encounter(kLocalNames + "[none] [m] [m] [m] [m/s] [deg] [m/s] [s]\n" + kTwoRows),
              "some.daa:2:26: unit deg is none of column vy");
    EXPECT_EQ(refusal_of_encounter(kLocalNames + "[none] [m] [m]\n" + kTwoRows),
              "some.daa:2:15: expected 8 units, not 3");
    EXPECT_EQ(refusal_of_encounter(units + "Own 0 0 0 1 1 1\n"), "some.daa:3:16: expected 8 fields, not 7");
    EXPECT_EQ(refusal_of_encounter(units + "Own 0 x 0 1 1 1 0\n"),
              "some.daa:3:7: column sy: 'x' is not a number from -1e13 to 1e13");
    EXPECT_EQ(refusal_of_encounter(units + "Own 0 0 0 1 nan 1 0\n"),
              "some.daa:3:13: column vy: 'nan' is not a number from -1e13 to 1e13");
    EXPECT_EQ(refusal_of_encounter(units + "Own 0 0x10 0 1 1 1 0\n"),
              "some.daa:3:7: column sy: '0x10' is not a number from -1e13 to 1e13");
    EXPECT_EQ(refusal_of_encounter(units + "Own 0 1e300 0 1 1 1 0\n"),
              "some.daa:3:7: column sy: '1e300' is not a number from -1e13 to 1e13");
    EXPECT_EQ(refusal_of_encounter(units + std::string("Own\0 0 0 0 1 1 1 0\n", 19)), "some.daa:3:1: a zero byte");
    EXPECT_EQ(refusal_of_encounter(units + "Own 0 0 0 1 1 1 1s\n"),
              "some.daa:3:17: column time: '1s' is not a number from -1e13 to 1e13");
    EXPECT_EQ(refusal_of_encounter(units + kTwoRows + "Own 1 0 0 1 1 1 0\n"),
              "some.daa:5:1: a second fix of Own at 0.000000 s");
    EXPECT_EQ(refusal_of_encounter(units + "\" 0 0 0 1 1 1 0\n"), "some.daa:3:1: no aircraft is named before");
    EXPECT_EQ(refusal_of_encounter(units + "Own 0 0 0 1 1 1 0\n"), "some.daa: fewer than two aircraft");
    EXPECT_EQ(refusal_of_encounter(""), "some.daa: fewer than two aircraft");
    EXPECT_EQ(refusal_of_encounter("NAME lat lon alt vx vy vz time\nOwn 91 0 0 0 0 0 0\n"),
              "some.daa:2:5: a latitude of 91.000000 deg");
}

TEST(RecordedEncounterFile, PutsRowsInOrderAndCountsThem)
{
    const RecordedEncounter e =
        read_text(kLocalNames + kMetres +
                  "Own 0 0 0 0 0 0 0\nOther 5 0 0 0 0 0 2\n\" 4 0 0 0 0 0 1\nOwn 2 0 0 0 0 0 2\n"
                  "Own 1 0 0 0 0 0 1\nOwn 3 0 0 0 0 0 3\n");
    EXPECT_EQ(e.reordered, 2U);
    ASSERT_EQ(e.aircraft[0].fixes.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(e.aircraft[0].fixes[i].time, double(i));
        EXPECT_EQ(e.aircraft[0].fixes[i].position.x(), double(i));
    }
    ASSERT_EQ(e.aircraft[1].fixes.size(), 2U);
    EXPECT_EQ(e.aircraft[1].fixes[0].position.x(), 4.0);
}

/// The other aircraft is recorded at other times, from later on, with a gap: by row it would be elsewhere.
TEST(RecordedEncounterFile, FixesArePairedByTime)
{
    Aircraft own{"own", {}};
    Aircraft other{"other", {}};
    for (int i = 0; i < 40; ++i) {
        own.fixes.push_back({double(i), Vec(10.0 * i, 0.0, 0.0), Vec(10.0, 0.0, 0.0)});
    }
    for (const double t : {4.5, 5.5, 7.0, 9.0, 20.0, 21.0}) {
        other.fixes.push_back({t, Vec(400.0 - 10.0 * t, 3.0, 0.0), Vec(-10.0, t, 0.0)});
    }
    const Paired paired = pair_by_time(own, other);
    std::vector<double> times;
    for (const Paired::Both& both : paired.fixes) {
        const double t = both.own.time;
        times.push_back(t);
        EXPECT_EQ(both.other.time, t);
        EXPECT_LT((both.other.position - Vec(400.0 - 10.0 * t, 3.0, 0.0)).norm(), 1e-9) << t;
        EXPECT_NEAR(both.other.velocity.y(), t, 1e-9) << t;
    }
    EXPECT_EQ(times, (std::vector<double>{5.0, 6.0, 7.0, 8.0, 9.0, 20.0, 21.0}));
    EXPECT_EQ(paired.interpolated, 3U);
    EXPECT_EQ(paired.unmatched, 33U);
    EXPECT_TRUE(pair_by_time(own, {"nobody", {}}).fixes.empty());
}

TEST(RecordedEncounterFile, TheDateLineIsNoDistance)
{
    const RecordedEncounter e =
        read_text("NAME lat lon alt vx vy vz time\nOwn 0 179.999 0 0 0 0 0\nB 0 -179.999 0 0 0 0 0\n");
    EXPECT_NEAR(e.aircraft[1].fixes[0].position.x(), 222.6, 0.5);
}

/// The recordings that the environment has beside this repository, if it has.
TEST(RecordedEncounterFile, TheCommandReadsTheSharedRecordings)
{
    RecordedOptions options;
    for (const char* name : {"C1_0_120.daa", "H1.daa"}) {
        const std::filesystem::path file = std::filesystem::path(JINK_ENCOUNTERS) / name;
        if (!std::filesystem::exists(file)) {
            GTEST_SKIP() << file << " is not there";
        }
        options.files.push_back(file.string());
    }
    std::ostringstream out;
    run_recorded(options, out);
    // Counted and computed by another program, on the ellipsoid at the latitude between both.
    for (const char* said : {"C1_0_120.daa: Ownship, 121 fixes from 0.0 s to 120.0 s; 0 rows put in order",
                             "121 paired (0 interpolated), 0 unmatched; closest at 105.0 s: 772.",
                             "H1.daa: Ownship, 230 fixes from 0.0 s to 229.0 s; 0 rows put in order",
                             "230 paired (0 interpolated), 0 unmatched; closest at 200.0 s: 269."}) {
        EXPECT_NE(out.str().find(said), std::string::npos) << said << "\nin\n" << out.str();
    }
}

}  // namespace
}  // namespace jink::sim
