// SPDX-License-Identifier: BSD-3-Clause
// Which method the co-processor plans with: by parameter, and never with reach sets that are damaged or not for its
// vehicle.
#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/app/method_orders.hpp"
#include "firmware/app/reach_sets.hpp"
#include "tests/unit/app/flight.hpp"

namespace jink::app::test {
namespace {

/// A flight past an obstacle on the leg: who planned it, and how near it came.
struct Passed {
    std::uint8_t by = 0;  ///< MethodTraits::id
    float nearest = 1e9F;
    bool warned = false;  ///< that the sets do not suit
    int reported = 0;     ///< that they are damaged
};

Passed pass(std::initializer_list<std::pair<Param, float>> values, bool leave_out = false)
{
    Parameters parameters;
    for (const auto& [param, value] : values) {
        EXPECT_EQ(parameters.set(param, value), ParamStatus::ok);
    }
    const auto f = std::make_unique<Flight>(parameters);
    if (leave_out) {
        f->coprocessor.leave_out_reach_sets();
    }
    Passed passed;
    const auto listen = [&] {
        for (const Statustext& m : f->said_of<Statustext>()) {
            const std::string text(m.text.data(), m.text.size());
            passed.reported += text.find("damaged") != std::string::npos ? 1 : 0;
            passed.warned = passed.warned || text.find("do not suit") != std::string::npos;
        }
    };
    EXPECT_TRUE(f->until(
        [&](const StepReport& r) {
            listen();
            return r.faults == 0;
        },
        200));
    f->obstacles = {f->position + Vec3(0.4F, 40.0F, 0.0F)};
    EXPECT_TRUE(f->until([](const StepReport& r) { return r.control == Control::ours; }));
    passed.by = f->coprocessor.flying() != nullptr ? f->coprocessor.flying()->by : std::uint8_t{0};
    f->until([&](const StepReport& r) {
        listen();
        passed.nearest = std::min(passed.nearest, (f->position - f->obstacles[0]).norm());
        return r.control == Control::autopilot;
    });
    EXPECT_GT(f->position.y(), f->obstacles[0].y()) << "gone by";
    return passed;
}

TEST(CoprocessorMethods, PlanAsTheParameterSays)
{
    const std::pair<float, std::uint8_t> methods[] = {{1.0F, kGeometric}, {2.0F, kReach}, {4.0F, kOrca}};
    for (const auto& [value, by] : methods) {
        const Passed passed = pass({{Param::methods, value}});
        EXPECT_EQ(passed.by, by) << value;
        EXPECT_GT(passed.nearest, 2.0F) << value;
        EXPECT_FALSE(passed.warned);
    }
}

/// The choice is reported once, with how many answers there were.
TEST(CoprocessorMethods, TheChosenMethodIsReported)
{
    for (const float methods : {2.0F, 7.0F}) {
        Parameters parameters;
        ASSERT_EQ(parameters.set(Param::methods, methods), ParamStatus::ok);
        const auto f = std::make_unique<Flight>(parameters);
        std::vector<std::string> reported;
        const auto listen = [&] {
            for (const Statustext& m : f->said_of<Statustext>()) {
                const std::string text(m.text.data());
                if (text.starts_with("jink: by ")) {
                    reported.push_back(text);
                }
            }
        };
        ASSERT_TRUE(f->until([](const StepReport& r) { return r.faults == 0; }, 200));
        f->obstacles = {f->position + Vec3(0.4F, 40.0F, 0.0F)};
        f->until([&](const StepReport& r) {
            listen();
            return r.control == Control::ours;
        });
        ASSERT_EQ(reported.size(), 1U) << methods;
        const world::Manoeuvre* flying = f->coprocessor.flying();
        ASSERT_NE(flying, nullptr);
        EXPECT_EQ(reported[0].find(method_name(flying->by)), 9U) << reported[0];
        EXPECT_EQ(reported[0].find(", best of ") != std::string::npos, methods == 7.0F) << reported[0];
    }
}

/// Made in memory that holds something from before.
struct OldMemory {
    OldMemory(std::byte left, const Parameters& parameters) : storage(std::make_unique<Storage>())
    {
        volatile std::byte* const bytes = storage->bytes;
        for (std::size_t i = 0; i < sizeof(Flight); ++i) {
            bytes[i] = left;
        }
        flight = new (storage->bytes) Flight(parameters);
    }
    OldMemory(const OldMemory&) = delete;
    OldMemory& operator=(const OldMemory&) = delete;
    ~OldMemory() { flight->~Flight(); }

    struct Storage {
        alignas(Flight) std::byte bytes[sizeof(Flight)];
    };
    std::unique_ptr<Storage> storage;
    Flight* flight = nullptr;
};

TEST(CoprocessorMethods, DoNotDependOnWhatTheMemoryHeldBefore)
{
    Parameters parameters;
    ASSERT_EQ(parameters.set(Param::methods, 2.0F), ParamStatus::ok);
    for (const int left : {0x00, 0x01, 0xA5, 0xFF}) {
        const OldMemory old(static_cast<std::byte>(left), parameters);
        Flight& f = *old.flight;
        ASSERT_TRUE(f.until([](const StepReport& r) { return r.faults == 0; }, 200));
        f.obstacles = {f.position + Vec3(0.4F, 40.0F, 0.0F)};
        ASSERT_TRUE(f.until([](const StepReport& r) { return r.control == Control::ours; }));
        ASSERT_NE(f.coprocessor.flying(), nullptr);
        EXPECT_EQ(f.coprocessor.flying()->by, kReach) << left;
    }
}

TEST(CoprocessorMethods, DamagedSetsAreLeftOut)
{
    const Passed passed = pass({{Param::methods, 2.0F}}, true);
    EXPECT_EQ(passed.by, kGeometric);
    EXPECT_EQ(passed.reported, 1);
    EXPECT_GT(passed.nearest, 2.0F);
}

/// A bit that flips in flight is found, and the flight goes on without the sets.
TEST(CoprocessorMethods, SetsThatGetDamagedInFlightAreLeftOut)
{
    const reach::VehicleSets& whole = reach_sets();
    std::vector<reach::SegmentSets> segments(whole.segments.begin(), whole.segments.end());
    const reach::ReachSet* const last = segments.back().emergency;
    std::vector<std::uint16_t> costs(last->cost.begin(), last->cost.end());
    reach::ReachSet worn = *last;
    worn.cost = costs;
    for (reach::SegmentSets& segment : segments) {
        segment.emergency = segment.emergency == last ? &worn : segment.emergency;
        segment.navigation = segment.navigation == last ? &worn : segment.navigation;
    }
    reach::VehicleSets sets = whole;
    sets.segments = segments;
    Parameters parameters;
    ASSERT_EQ(parameters.set(Param::methods, 2.0F), ParamStatus::ok);
    parameters.use(sets);
    const auto f = std::make_unique<Flight>(parameters);
    const auto damaged = [&] {
        const auto said = f->said_of<Statustext>();
        return std::count_if(said.begin(), said.end(), [](const Statustext& m) {
            return std::string(m.text.data(), m.text.size()).find("damaged") != std::string::npos;
        });
    };
    ASSERT_TRUE(f->until([](const StepReport& r) { return r.faults == 0; }, 200));
    ASSERT_TRUE(f->until(
        [&](const StepReport&) { return f->coprocessor.diagnostics().tables_checked > 0 || damaged() > 0; }, 20'000));
    ASSERT_EQ(f->coprocessor.diagnostics().tables_checked, 1U) << "good ones";
    costs[costs.size() / 2] ^= 0x0100;
    int found = 0;
    f->until(
        [&](const StepReport&) {
            found += static_cast<int>(damaged());
            return found > 0;
        },
        20'000);
    EXPECT_EQ(found, 1);
    EXPECT_EQ(f->coprocessor.diagnostics().tables_checked, 1U);
    f->obstacles = {f->position + Vec3(0.4F, 40.0F, 0.0F)};
    ASSERT_TRUE(f->until([](const StepReport& r) { return r.control == Control::ours; }));
    ASSERT_NE(f->coprocessor.flying(), nullptr);
    EXPECT_EQ(f->coprocessor.flying()->by, kGeometric);
}

TEST(CoprocessorMethods, SetsThatDoNotSuitTheVehicleAreLeftOutAndItIsReported)
{
    const Passed passed = pass({{Param::methods, 2.0F}, {Param::acceleration, 4.0F}});
    EXPECT_EQ(passed.by, kGeometric);
    EXPECT_TRUE(passed.warned);
    EXPECT_FALSE(pass({{Param::methods, 1.0F}, {Param::acceleration, 4.0F}}).warned) << "nobody asked for them";
}

}  // namespace
}  // namespace jink::app::test
