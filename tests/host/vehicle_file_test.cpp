// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "firmware/linux/vehicle_file.hpp"

#include "tests/host/scratch.hpp"

namespace {

using namespace jink;
using namespace jink::files;
using app::Param;
using test::Scratch;
using test::with;

const std::string kGoodVehicle =
    "kind: multirotor\ncruise_speed: 6\nmax_climb: 2\nmax_descent: 1.5\nmax_acceleration: 4\n"
    "max_vertical_acceleration: 2\nvelocity_lag: 0.3\nhalf_extent_level: 0.8\nhalf_extent_vertical: 0.6\n"
    "mass: 2\ndrag_coefficient: 0.4\neffective_area: 1.5\n";

std::optional<Vehicle> read_vehicle_text(const std::string& text, Complaints& complaints)
{
    const auto root = parse_yaml(text, "v.yaml", complaints);
    return root ? read_vehicle(*root, "", "v.yaml", complaints) : std::nullopt;
}

void expect_same(const vehicle::VehicleLimits& a, const vehicle::VehicleLimits& b)
{
    EXPECT_EQ(a.kind, b.kind);
    EXPECT_EQ(a.cruise_speed, b.cruise_speed);
    EXPECT_EQ(a.max_climb, b.max_climb);
    EXPECT_EQ(a.max_descent, b.max_descent);
    EXPECT_EQ(a.max_acceleration, b.max_acceleration);
    EXPECT_EQ(a.max_vertical_acceleration, b.max_vertical_acceleration);
    EXPECT_EQ(a.velocity_lag, b.velocity_lag);
    EXPECT_EQ(a.half_extents, b.half_extents);
}

void expect_same(const vehicle::Airframe& a, const vehicle::Airframe& b)
{
    EXPECT_EQ(a.mass, b.mass);
    EXPECT_EQ(a.drag_coefficient, b.drag_coefficient);
    EXPECT_EQ(a.effective_area, b.effective_area);
    EXPECT_EQ(a.blades, b.blades);
    EXPECT_EQ(a.chord, b.chord);
    EXPECT_EQ(a.rotor_radius, b.rotor_radius);
    EXPECT_EQ(a.rotors, b.rotors);
    EXPECT_EQ(a.air_density, b.air_density);
    EXPECT_EQ(a.blade_drag_coefficient, b.blade_drag_coefficient);
    EXPECT_EQ(a.tip_speed, b.tip_speed);
}

TEST(VehicleFile, ShippedFilesAreTheVehiclesOfTheSource)
{
    for (const char* name : {"default", "uav2"}) {
        Complaints complaints;
        const auto file =
            read_vehicle_file(std::string(JINK_SOURCES "/firmware/vehicles/") + name + "/vehicle.yaml", complaints);
        ASSERT_TRUE(file) << test::all_of(complaints);
        EXPECT_EQ(file->name, name);
        const auto built_in = built_in_vehicle(name);
        ASSERT_TRUE(built_in);
        expect_same(file->limits, built_in->limits);
        expect_same(file->airframe, built_in->airframe);
        EXPECT_FLOAT_EQ(file->caps.time_low, built_in->caps.time_low);
        EXPECT_FLOAT_EQ(file->caps.time_high, built_in->caps.time_high);
        EXPECT_FLOAT_EQ(file->caps.energy_low, built_in->caps.energy_low);
        EXPECT_FLOAT_EQ(file->caps.energy_high, built_in->caps.energy_high);
    }
    // Pinheiro tab. 4.5
    EXPECT_EQ(built_in_vehicle("uav2")->limits.cruise_speed, 15.0F);
    EXPECT_EQ(built_in_vehicle("uav2")->airframe.mass, 10.0F);
    EXPECT_FALSE(built_in_vehicle("uav3"));
}

TEST(VehicleFile, TheDefaultVehicleLeavesTheParametersAsTheyAre)
{
    Complaints complaints;
    const ParamValues values = app::Parameters().values();
    const auto applied = apply_vehicle_file(JINK_SOURCES "/firmware/vehicles/default/vehicle.yaml", values, complaints);
    ASSERT_TRUE(applied) << test::all_of(complaints);
    for (std::size_t i = 0; i < values.size(); ++i) {
        EXPECT_EQ((*applied)[i], values[i]) << app::param_table()[i].name;
    }
}

TEST(VehicleFile, EveryKeyReachesItsParameter)
{
    Complaints complaints;
    const auto vehicle = read_vehicle_text(
        kGoodVehicle + "caps: {time_low: 1, time_high: 5, energy_low: 100, energy_high: 900}\n", complaints);
    ASSERT_TRUE(vehicle) << test::all_of(complaints);
    const ParamValues values = apply_vehicle(*vehicle, app::Parameters().values());
    const auto at = [&](Param p) { return values[static_cast<std::size_t>(p)]; };
    EXPECT_EQ(at(Param::cruise), 6.0F);
    EXPECT_EQ(at(Param::climb), 2.0F);
    EXPECT_EQ(at(Param::descent), 1.5F);
    EXPECT_EQ(at(Param::acceleration), 4.0F);
    EXPECT_EQ(at(Param::vertical_acceleration), 2.0F);
    EXPECT_EQ(at(Param::lag), 0.3F);
    EXPECT_EQ(at(Param::half_xy), 0.8F);
    EXPECT_EQ(at(Param::half_z), 0.6F);
    EXPECT_EQ(at(Param::fixed_wing), 0.0F);
    EXPECT_EQ(at(Param::mass), 2.0F);
    EXPECT_EQ(at(Param::drag), 0.4F);
    EXPECT_EQ(at(Param::area), 1.5F);
    EXPECT_EQ(at(Param::time_low), 1.0F);
    EXPECT_EQ(at(Param::time_high), 5.0F);

    // And the co-processor makes of them the vehicle that the file meant.
    app::Parameters parameters;
    ASSERT_EQ(parameters.set_all(values), app::ParamStatus::ok);
    expect_same(parameters.configuration().limits, vehicle->limits);

    const auto wing =
        read_vehicle_text("kind: fixed_wing\n" + kGoodVehicle.substr(kGoodVehicle.find('\n') + 1), complaints);
    ASSERT_TRUE(wing);
    EXPECT_EQ(apply_vehicle(*wing, values)[static_cast<std::size_t>(Param::fixed_wing)], 1.0F);
}

TEST(VehicleFile, CapsAreComputedWhereTheFileHasNone)
{
    Complaints complaints;
    const auto vehicle = read_vehicle_text(kGoodVehicle, complaints);
    ASSERT_TRUE(vehicle);
    const cost::Caps caps = cost::caps_for(vehicle->limits, vehicle->airframe);
    EXPECT_EQ(vehicle->caps.time_high, caps.time_high);
    EXPECT_EQ(vehicle->caps.energy_low, caps.energy_low);
    EXPECT_EQ(vehicle->name, "v");
}

TEST(VehicleFile, EveryRequiredKeyIsMissed)
{
    std::size_t from = 0;
    int lines = 0;
    for (std::size_t end = kGoodVehicle.find('\n'); end != std::string::npos; end = kGoodVehicle.find('\n', from)) {
        const std::string key = kGoodVehicle.substr(from, kGoodVehicle.find(':', from) - from);
        Complaints complaints;
        EXPECT_FALSE(read_vehicle_text(kGoodVehicle.substr(0, from) + kGoodVehicle.substr(end + 1), complaints));
        ASSERT_EQ(complaints.size(), 1U) << key << "\n" << test::all_of(complaints);
        EXPECT_NE(with(complaints, "missing key '" + key + "'"), nullptr) << test::all_of(complaints);
        from = end + 1;
        ++lines;
    }
    EXPECT_EQ(lines, 12);
}

TEST(VehicleFile, EveryComplaintByLine)
{
    const struct {
        const char* more;
        const char* complaint;
    } cases[] = {
        {"max_clmb: 3", "unknown key 'max_clmb'; did you mean 'max_climb'?"},
        {"mass: 3", "mass: given twice"},
        {"air_density: 12", "air_density: '12' is out of range: 0.1 to 2"},
        {"air_density: thick", "air_density: 'thick' is not a number"},
        {"air_density: \"1.2\"", "air_density: a number is wanted, not quoted text"},
        {"air_density: !!int 1", "air_density: a number is wanted, not a value with the tag 'tag:yaml.org,2002:int'"},
        {"name: !other default", "name: no tag is wanted, such as '!other'"},
        {"caps: !!set {time_low: 1}", "caps: no tag is wanted, such as 'tag:yaml.org,2002:set'"},
        {"air_density: [1.2]", "air_density: a number is wanted, not a list"},
        {"air_density: {a: 1}", "air_density: a number is wanted, not a mapping"},
        {"air_density:", "air_density: has no value"},
        {"rotors: 4", "rotors: a mapping of keys to values is wanted, not a single value"},
        {"rotors: {count: 4.5}", "rotors.count: '4.5' is not a whole number"},
        {"rotors: {cuont: 4}", "unknown key 'rotors.cuont'; did you mean 'count'?"},
        {"name: [a]", "name: text is wanted, not a list"},
        {"name: \"a\\x1b[2J\"", "name: text of one line without control characters is wanted"},
        {"caps: {time_low: 1, time_high: 5, energy_low: 100}", "missing key 'caps.energy_high'"},
        {"caps: {time_low: 9, time_high: 5, energy_low: 100, energy_high: 900}", "time_low less than 1.15 time_high"},
        {"caps: {time_low: 1, time_high: 5, energy_low: 900, energy_high: 900}",
         "energy_low must be less than energy_high"},
        {"[1, 2]: 3", "a key must be a word, not a list"},
    };
    for (const auto& c : cases) {
        Complaints complaints;
        EXPECT_FALSE(read_vehicle_text(kGoodVehicle + c.more + "\n", complaints)) << c.more;
        ASSERT_EQ(complaints.size(), 1U) << c.more << "\n" << test::all_of(complaints);
        EXPECT_EQ(complaints[0].line, 13U) << c.more << "\n" << test::all_of(complaints);
        EXPECT_GE(complaints[0].column, 1U);
        EXPECT_NE(with(complaints, c.complaint), nullptr) << c.more << "\n" << test::all_of(complaints);
    }
    Complaints complaints;
    EXPECT_FALSE(read_vehicle_text("kind: balloon\n" + kGoodVehicle.substr(kGoodVehicle.find('\n') + 1), complaints));
    EXPECT_NE(with(complaints, "kind: 'balloon' is none of: multirotor, fixed_wing"), nullptr)
        << test::all_of(complaints);
}

TEST(VehicleFile, RefusesAZeroByteByItsPlace)
{
    Complaints complaints;
    EXPECT_FALSE(read_vehicle_text(kGoodVehicle + "name: a" + std::string(1, '\0') + "b\n", complaints));
    ASSERT_EQ(complaints.size(), 1U);
    EXPECT_EQ(complaints[0].line, 13U);
    EXPECT_EQ(complaints[0].column, 8U);
    EXPECT_NE(with(complaints, "a zero byte: the file has to be text in UTF-8"), nullptr);
}

TEST(VehicleFile, RefusesWhatIsNoYamlMapping)
{
    const struct {
        const char* text;
        const char* complaint;
        std::size_t line;
    } cases[] = {
        {"", "is empty", 0},
        {"# only a comment\n", "a mapping of keys to values is wanted, not nothing", 0},
        {"- a\n- b\n", "a mapping of keys to values is wanted, not a list", 1},
        {"just words", "a mapping of keys to values is wanted, not a single value", 1},
        {"a: [1, 2\nb: 3\n", "is not YAML", 2},
        {"a: 1\n---\nb: 2\n", "holds several documents", 0},
    };
    for (const auto& c : cases) {
        Complaints complaints;
        EXPECT_FALSE(read_vehicle_text(c.text, complaints)) << c.text;
        ASSERT_EQ(complaints.size(), 1U) << c.text << "\n" << test::all_of(complaints);
        const bool empty = std::string(c.text).empty() || c.text[0] == '#';
        EXPECT_TRUE(empty || with(complaints, c.complaint) != nullptr) << c.text << "\n" << test::all_of(complaints);
        EXPECT_TRUE(empty || complaints[0].line == c.line) << c.text << "\n" << test::all_of(complaints);
    }
    std::string many;
    for (int i = 0; i < 300; ++i) {
        many += "k" + std::to_string(i) + ": 1\n";
    }
    Complaints complaints;
    EXPECT_FALSE(read_vehicle_text(many, complaints));
    EXPECT_NE(with(complaints, "more than 256 keys"), nullptr);
}

}  // namespace
