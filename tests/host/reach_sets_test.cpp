// SPDX-License-Identifier: BSD-3-Clause
// Reach sets: shipped sets equal those of the vehicle files, and pass the images' check.
#include <gtest/gtest.h>

#include "firmware/linux/vehicle_file.hpp"
#include "firmware/vehicles/default/reach_sets.hpp"
#include "firmware/vehicles/default/reach_sets_reduced.hpp"
#include "firmware/vehicles/uav2/reach_sets.hpp"
#include "tests/host/scratch.hpp"
#include "toolchain/host/reach_sets_text.hpp"

namespace jink::host {
namespace {

namespace rb = reach::build;

struct Shipped {
    const char* vehicle;
    rb::Profile profile;
    const char* header;
    const reach::VehicleSets* sets;
};
constexpr Shipped kShipped[] = {
    {"default", rb::Profile::full, "reach_sets.hpp", &reach::kDefaultSets},
    {"default", rb::Profile::reduced, "reach_sets_reduced.hpp", &reach::kDefaultReducedSets},
    {"uav2", rb::Profile::full, "reach_sets.hpp", &reach::kUav2Sets},
};

TEST(ReachSets, WhatIsShippedIsWhatTheVehicleFilesGive)
{
    for (const Shipped& shipped : kShipped) {
        files::Complaints complaints;
        const std::string folder = std::string("firmware/vehicles/") + shipped.vehicle + "/";
        const auto vehicle = files::read_vehicle_file(JINK_SOURCES "/" + folder + "vehicle.yaml", complaints);
        ASSERT_TRUE(vehicle) << test::all_of(complaints);
        rb::Recipe recipe;
        recipe.profile = shipped.profile;
        const rb::BuiltVehicle built = rb::build_vehicle(vehicle->name, vehicle->limits, recipe);
        // Compared as a bool, so that a failure does not print a megabyte of text.
        const bool same = reach_sets_header(built) == test::slurp(JINK_SOURCES "/" + folder + shipped.header);
        EXPECT_TRUE(same) << "run: jink reach build " << folder << "vehicle.yaml"
                          << (shipped.profile == rb::Profile::reduced ? " --profile reduced" : "") << " --out "
                          << folder << shipped.header;
        EXPECT_EQ(shipped.sets->checksum, rb::VehicleView(built).sets().checksum);
        EXPECT_EQ(shipped.sets->cruise_speed, vehicle->limits.cruise_speed);
        EXPECT_EQ(shipped.sets->max_acceleration, vehicle->limits.max_acceleration);
    }
}

TEST(ReachSets, WhatIsShippedPassesTheImagesCheck)
{
    for (const Shipped& shipped : kShipped) {
        EXPECT_EQ(check(*shipped.sets), reach::SetStatus::good) << shipped.header;
        EXPECT_EQ(shipped.sets->vehicle, shipped.vehicle);
        for (const float pitch : {-0.07F, 0.0F, 0.07F}) {
            ASSERT_NE(segment_of(*shipped.sets, 0.5F, pitch), nullptr);
            ASSERT_NE(segment_of(*shipped.sets, 1.0F, pitch), nullptr);
        }
    }
}

TEST(ReachSets, DamageToWhatIsShippedIsSeen)
{
    const reach::ReachSet& sound = *segment_of(reach::kDefaultSets, 1.0F, 0.0F)->emergency;
    ASSERT_EQ(check(sound), reach::SetStatus::good);
    std::vector<std::int16_t> position(sound.position.begin(), sound.position.end());
    std::vector<reach::FootprintEntry> entries(sound.entries.begin(), sound.entries.end());
    reach::ReachSet set = sound;
    set.position = position;
    set.entries = entries;
    EXPECT_EQ(check(set), reach::SetStatus::good);
    for (const std::size_t at : {std::size_t{3}, position.size() / 2, position.size() - 1}) {
        position[at] = static_cast<std::int16_t>(position[at] ^ 1);
        EXPECT_EQ(check(set), reach::SetStatus::wrong_checksum) << at;
        position[at] = static_cast<std::int16_t>(position[at] ^ 1);
    }
    entries.back().cell = static_cast<reach::CellIndex>(entries.back().cell ^ 1U);
    EXPECT_EQ(check(set), reach::SetStatus::wrong_checksum);
}

}  // namespace
}  // namespace jink::host
