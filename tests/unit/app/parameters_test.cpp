// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/app/parameters.hpp"
#include "tests/numbers.hpp"

namespace jink::app {
namespace {

using Values = std::array<float, kParamCount>;
using Changes = std::vector<std::pair<Param, float>>;

std::size_t index_of(Param p) { return static_cast<std::size_t>(p); }

Values initial_with(const Changes& changes)
{
    Values values{};
    for (std::size_t i = 0; i < kParamCount; ++i) {
        values[i] = param_table()[i].initial;
    }
    for (const auto& [param, value] : changes) {
        values[index_of(param)] = value;
    }
    return values;
}

/// Changes required with a parameter at its limit, so that the set is consistent.
Changes company_of(Param p, float value)
{
    switch (p) {
    case Param::floor: return {{Param::ceiling, 5000.0F}, {Param::bounds, value > 0.0F ? 1.0F : 3.0F}};
    case Param::ceiling: return {{Param::floor, -500.0F}, {Param::bounds, value > 0.0F ? 3.0F : 2.0F}};
    case Param::bounds: return {{Param::floor, 2.0F}, {Param::ceiling, 120.0F}};
    case Param::weight_smoothness: return {{Param::weight_time, value > 0.5F ? 0.1F : 0.4F}};
    case Param::weight_time: return {{Param::weight_smoothness, value > 0.5F ? 0.0F : 0.3F}};
    case Param::weight_passing:
    case Param::weight_beyond:
        return {{Param::weight_smoothness, value > 0.5F ? 0.0F : 0.3F}, {Param::weight_time, 0.1F}};
    case Param::offsets: return {{Param::planes, 0.0F}};
    case Param::planes: return {{Param::offsets, 2.0F}, {Param::families, 1.0F}};
    case Param::time_low: return {{Param::time_high, 1000.0F}};
    case Param::time_high: return {{Param::time_low, 0.0F}};
    case Param::track_age: return {{Param::track_latency, 0.0F}};
    default: return {};
    }
}

/// A refused change leaves every trace as it was.
void expect_refused(Parameters& parameters, ParamStatus expected, const std::function<ParamStatus()>& change)
{
    const Values before = parameters.values();
    const std::uint32_t generation = parameters.generation();
    const float lookahead = parameters.configuration().rules.lookahead;
    const float weight = parameters.configuration().planner.weights.closeness;
    EXPECT_EQ(change(), expected);
    EXPECT_EQ(parameters.values(), before);
    EXPECT_EQ(parameters.generation(), generation);
    EXPECT_EQ(parameters.configuration().rules.lookahead, lookahead);
    EXPECT_EQ(parameters.configuration().planner.weights.closeness, weight);
}

TEST(ParamTable, NamesFitTheWireAndAreUnique)
{
    std::set<std::string_view> names;
    for (const ParamInfo& info : param_table()) {
        EXPECT_FALSE(info.name.empty());
        EXPECT_LE(info.name.size(), 16U) << info.name;
        EXPECT_EQ(info.name.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_"), std::string_view::npos)
            << info.name;
        EXPECT_TRUE(names.insert(info.name).second) << info.name;
        EXPECT_FALSE(info.text.empty()) << info.name;
    }
}

TEST(ParamTable, InitialValuesLieWithinLimitsAndFitTogether)
{
    for (const ParamInfo& info : param_table()) {
        EXPECT_LT(info.low, info.high) << info.name;
        EXPECT_GE(info.initial, info.low) << info.name;
        EXPECT_LE(info.initial, info.high) << info.name;
        if (info.integer) {
            EXPECT_EQ(info.initial, std::floor(info.initial)) << info.name;
            EXPECT_EQ(info.low, std::floor(info.low)) << info.name;
            EXPECT_EQ(info.high, std::floor(info.high)) << info.name;
        }
    }
    Parameters parameters;
    EXPECT_EQ(parameters.generation(), 0U);
    EXPECT_EQ(parameters.values(), initial_with({}));
    EXPECT_EQ(parameters.set_all(initial_with({})), ParamStatus::ok);
}

TEST(Parameters, FindsNames)
{
    for (std::size_t i = 0; i < kParamCount; ++i) {
        const std::string name(param_table()[i].name);
        EXPECT_EQ(Parameters::find(name), i);
        EXPECT_EQ(Parameters::find(name + std::string(3, '\0')), i) << name;
        EXPECT_EQ(Parameters::find(name + std::string("\0rest", 5)), i) << name;
        EXPECT_NE(Parameters::find(name.substr(0, name.size() - 1)), i) << name;
        EXPECT_EQ(Parameters::find(name + "Z"), kParamCount) << name;
    }
    for (const char* unknown : {"", "jnk_mode", " JNK_MODE", "JNK_MODE ", "JNK"}) {
        EXPECT_EQ(Parameters::find(unknown), kParamCount) << unknown;
    }
}

TEST(Parameters, SetsByName)
{
    Parameters parameters;
    EXPECT_EQ(parameters.set("JNK_LOOKAHEAD", 12.0F), ParamStatus::ok);
    EXPECT_EQ(parameters.get(Param::lookahead), 12.0F);
    expect_refused(parameters, ParamStatus::unknown_name, [&] { return parameters.set("JNK_LOOK", 12.0F); });
    expect_refused(parameters, ParamStatus::out_of_range, [&] { return parameters.set("JNK_LOOKAHEAD", 61.0F); });
}

TEST(Parameters, EveryLimitIsAcceptedAndNothingBeyond)
{
    for (std::size_t i = 0; i < kParamCount; ++i) {
        const ParamInfo& info = param_table()[i];
        const Param p = static_cast<Param>(i);
        for (const float limit : {info.low, info.high}) {
            Parameters parameters;
            Changes changes = company_of(p, limit);
            changes.emplace_back(p, limit);
            EXPECT_EQ(parameters.set_all(initial_with(changes)), ParamStatus::ok) << info.name << " = " << limit;
            EXPECT_EQ(parameters.get(p), limit) << info.name;
            EXPECT_EQ(parameters.generation(), 1U) << info.name;
            const float beyond = std::nextafter(limit, limit == info.low ? -kInfinity : kInfinity);
            expect_refused(parameters, ParamStatus::out_of_range, [&] { return parameters.set(p, beyond); });
            const float far = limit == info.low ? -3e38F : 3e38F;
            expect_refused(parameters, ParamStatus::out_of_range, [&] { return parameters.set(p, far); });
        }
    }
}

TEST(Parameters, RefusesWhatIsNotFiniteOrNotWhole)
{
    Parameters parameters;
    for (std::size_t i = 0; i < kParamCount; ++i) {
        const ParamInfo& info = param_table()[i];
        const Param p = static_cast<Param>(i);
        for (const float value : {kNan, -kNan, kInfinity, -kInfinity}) {
            expect_refused(parameters, ParamStatus::not_finite, [&] { return parameters.set(p, value); });
        }
        if (info.integer) {
            const float between = info.low + 0.5F;
            expect_refused(parameters, ParamStatus::out_of_range, [&] { return parameters.set(p, between); });
            const float nearly = std::nextafter(info.high, -kInfinity);
            if (nearly != std::floor(nearly)) {  // near 2^24 the next float is a whole number too
                expect_refused(parameters, ParamStatus::out_of_range, [&] { return parameters.set(p, nearly); });
            }
        }
    }
}

TEST(Parameters, RefusesSetsThatDoNotFitTogether)
{
    const std::vector<Changes> sets{
        {{Param::weight_smoothness, 0.0F}},   // closeness 0.8
        {{Param::weight_smoothness, 0.09F}},  // closeness 0.71
        {{Param::weight_time, 0.71F}},        // closeness -0.01
        {{Param::weight_passing, 0.51F}},     // the same
        {{Param::weight_beyond, 0.51F}},
        {{Param::weight_passing, 0.3F}, {Param::weight_beyond, 0.3F}},
        {{Param::weight_smoothness, 0.9F}},                 // closeness -0.1
        {{Param::offsets, 3.0F}},                           // odd
        {{Param::offsets, 64.0F}, {Param::planes, 31.0F}},  // more candidates than the capacity
        {{Param::time_low, 8.15F}},                         // 7.0814 * 1.15 = 8.1436
        {{Param::time_high, 1.0F}},                         // 1.15 < 1.2530
        {{Param::bounds, 3.0F}, {Param::ceiling, 2.0F}},    // no space between floor and ceiling
        {{Param::bounds, 3.0F}, {Param::ceiling, 5.99F}},   // 4 half heights are 4 m
        {{Param::bounds, 7.0F}, {Param::half_z, 20.0F}, {Param::ceiling, 81.9F}},
        {{Param::bounds, 3.0F}, {Param::floor, 130.0F}},
        {{Param::track_age, 1.0F}},  // no second after the latency of 0.1 s
        {{Param::track_age, 2.9F}, {Param::track_latency, 2.0F}},
    };
    for (const Changes& changes : sets) {
        Parameters parameters;
        expect_refused(parameters, ParamStatus::inconsistent,
                       [&] { return parameters.set_all(initial_with(changes)); });
        if (changes.size() == 1) {
            expect_refused(parameters, ParamStatus::inconsistent,
                           [&] { return parameters.set(changes[0].first, changes[0].second); });
        }
    }
}

TEST(Parameters, AnyLatencyOfTrafficFitsTheInitialAge)
{
    Parameters parameters;
    EXPECT_EQ(parameters.set(Param::track_latency, 2.0F), ParamStatus::ok);
    EXPECT_EQ(parameters.set(Param::track_latency, 0.1F), ParamStatus::ok);
    EXPECT_EQ(parameters.set(Param::track_age, 1.1F), ParamStatus::ok);
}

TEST(Parameters, AcceptsSetsThatFitOnlyTogether)
{
    for (const Changes& changes :
         std::vector<Changes>{{{Param::weight_smoothness, 0.0F}, {Param::weight_time, 0.3F}},
                              {{Param::weight_smoothness, 0.9F}, {Param::weight_time, 0.1F}},
                              {{Param::weight_smoothness, 0.1F}},  // closeness 0.7, its greatest
                              {{Param::weight_smoothness, 0.0F}, {Param::weight_beyond, 0.1F}},
                              {{Param::weight_passing, 0.25F}, {Param::weight_beyond, 0.25F}},  // closeness 0
                              {{Param::time_low, 8.14F}},
                              {{Param::bounds, 3.0F}, {Param::ceiling, 6.0F}},
                              {{Param::bounds, 1.0F}, {Param::floor, 130.0F}},
                              {{Param::bounds, 2.0F}, {Param::ceiling, -100.0F}},
                              {{Param::bounds, 4.0F}, {Param::floor, 130.0F}, {Param::ceiling, -100.0F}}}) {
        Parameters parameters;
        EXPECT_EQ(parameters.set_all(initial_with(changes)), ParamStatus::ok)
            << param_table()[index_of(changes[0].first)].name << " = " << changes[0].second;
    }
}

TEST(Parameters, OneBadValueRefusesAll)
{
    Parameters parameters;
    ASSERT_EQ(parameters.set(Param::cruise, 7.0F), ParamStatus::ok);
    const Changes good{{Param::lookahead, 20.0F}, {Param::cruise, 9.0F}, {Param::mass, 4.0F}};
    for (std::size_t i = 0; i < kParamCount; ++i) {
        Values values = initial_with(good);
        values[i] = param_table()[i].high * 2.0F + 1.0F;
        expect_refused(parameters, ParamStatus::out_of_range, [&] { return parameters.set_all(values); });
        values[i] = kNan;
        expect_refused(parameters, ParamStatus::not_finite, [&] { return parameters.set_all(values); });
    }
    EXPECT_EQ(parameters.configuration().limits.cruise_speed, 7.0F);
}

TEST(Parameters, GenerationCountsAcceptedChangesOnly)
{
    Parameters parameters;
    EXPECT_EQ(parameters.set(Param::lookahead, 9.0F), ParamStatus::ok);
    EXPECT_EQ(parameters.generation(), 1U);
    EXPECT_EQ(parameters.set(Param::lookahead, 0.0F), ParamStatus::out_of_range);
    EXPECT_EQ(parameters.set(Param::offsets, 5.0F), ParamStatus::inconsistent);
    EXPECT_EQ(parameters.generation(), 1U);
    EXPECT_EQ(parameters.set("TRK_AGE", 5.0F), ParamStatus::ok);
    EXPECT_EQ(parameters.set_all(initial_with({})), ParamStatus::ok);
    EXPECT_EQ(parameters.generation(), 3U);
}

struct Route {
    Param param;
    float value;
    std::function<float(const Configuration&)> read;
    float expected;
};

std::vector<Route> routes()
{
    using C = const Configuration&;
    const auto same = [](Param p, float value, std::function<float(C)> read) {
        return Route{p, value, std::move(read), value};
    };
    return {
        same(Param::mode, 1, [](C c) { return static_cast<float>(c.mode); }),
        same(Param::lookahead, 11, [](C c) { return c.rules.lookahead; }),
        same(Param::half_xy, 1.5F, [](C c) { return c.limits.half_extents.x(); }),
        same(Param::half_xy, 1.6F, [](C c) { return c.limits.half_extents.y(); }),
        same(Param::half_z, 1.7F, [](C c) { return c.limits.half_extents.z(); }),
        same(Param::k_sigma, 2.5F, [](C c) { return c.rules.k_sigma; }),
        {Param::bounds, 1, [](C c) { return c.floor_on && !c.ceiling_on && !c.keep_in_on ? 1.0F : 0.0F; }, 1},
        {Param::bounds, 2, [](C c) { return !c.floor_on && c.ceiling_on && !c.keep_in_on ? 1.0F : 0.0F; }, 1},
        {Param::bounds, 4, [](C c) { return !c.floor_on && !c.ceiling_on && c.keep_in_on ? 1.0F : 0.0F; }, 1},
        same(Param::floor, 3, [](C c) { return c.floor; }),
        same(Param::ceiling, 99, [](C c) { return c.ceiling; }),
        same(Param::keep_in, 321, [](C c) { return c.keep_in; }),
        same(Param::reserve, 0.9F, [](C c) { return c.supervisor.reserve; }),
        same(Param::settle, 1.9F, [](C c) { return c.supervisor.settle; }),
        {Param::rate, 10, [](C c) { return c.setpoint_period; }, 0.1F},
        {Param::standby, 0, [](C c) { return c.stands_by ? 1.0F : 0.0F; }, 0},
        {Param::ask_rates, 0, [](C c) { return c.ask_rates ? 1.0F : 0.0F; }, 0},
        {Param::methods, 2, [](C c) { return static_cast<float>(c.supervisor.order.size()); }, 1},
        {Param::methods, 3, [](C c) { return static_cast<float>(c.supervisor.order.size()); }, 2},
        {Param::methods, 7, [](C c) { return static_cast<float>(c.supervisor.order.size()); }, 3},
        {Param::unseen, 0, [](C c) { return c.blocks_unseen ? 1.0F : 0.0F; }, 0},
        {Param::coop, 1,
         [](C c) { return c.coop_systems && !c.coop_utm && !c.coop_unmanned && !c.coop_all ? 1.0F : 0.0F; }, 1},
        {Param::coop, 2,
         [](C c) { return !c.coop_systems && c.coop_utm && !c.coop_unmanned && !c.coop_all ? 1.0F : 0.0F; }, 1},
        {Param::coop, 4,
         [](C c) { return !c.coop_systems && !c.coop_utm && c.coop_unmanned && !c.coop_all ? 1.0F : 0.0F; }, 1},
        {Param::coop, 8,
         [](C c) { return !c.coop_systems && !c.coop_utm && !c.coop_unmanned && c.coop_all ? 1.0F : 0.0F; }, 1},
        same(Param::own_address, 16777215, [](C c) { return static_cast<float>(c.own_address); }),
        same(Param::latency, 0.3F, [](C c) { return c.rules.latency; }),
        {Param::acceleration, 4, [](C c) { return c.reach_unsuited ? 1.0F : 0.0F; }, 1},
        {Param::acceleration, 6, [](C c) { return c.reach_unsuited ? 1.0F : 0.0F; }, 0},
        {Param::tell_near, 1, [](C c) { return c.tell_near ? 1.0F : 0.0F; }, 1},
        same(Param::track_radius, 2.1F, [](C c) { return c.track_radius; }),
        same(Param::point_radius, 2.2F, [](C c) { return c.point_radius; }),
        same(Param::track_sigma_p, 2.3F, [](C c) { return c.track_sigma_position; }),
        same(Param::track_sigma_v, 2.4F, [](C c) { return c.track_sigma_velocity; }),
        same(Param::track_acceleration, 2.5F, [](C c) { return c.track_acceleration; }),
        same(Param::track_latency, 1.1F, [](C c) { return c.track_latency; }),
        same(Param::track_age, 7.7F, [](C c) { return c.tracks.max_age; }),
        same(Param::scan_height, 12, [](C c) { return c.scan_height; }),
        same(Param::scan_latency, 0.4F, [](C c) { return c.scan_latency; }),
        same(Param::scan_keep, 2.6F, [](C c) { return c.scan_keep; }),
        same(Param::own_age, 0.7F, [](C c) { return c.own_age; }),
        same(Param::heartbeat_age, 3.5F, [](C c) { return c.heartbeat_age; }),
        same(Param::cruise, 6.1F, [](C c) { return c.limits.cruise_speed; }),
        same(Param::climb, 6.2F, [](C c) { return c.limits.max_climb; }),
        same(Param::descent, 6.3F, [](C c) { return c.limits.max_descent; }),
        same(Param::acceleration, 6.4F, [](C c) { return c.limits.max_acceleration; }),
        same(Param::vertical_acceleration, 6.5F, [](C c) { return c.limits.max_vertical_acceleration; }),
        same(Param::lag, 0.3F, [](C c) { return c.limits.velocity_lag; }),
        {Param::fixed_wing, 1, [](C c) { return c.limits.kind == vehicle::VehicleKind::fixed_wing ? 1.0F : 0.0F; }, 1},
        {Param::fixed_wing, 0, [](C c) { return c.limits.kind == vehicle::VehicleKind::multirotor ? 1.0F : 0.0F; }, 1},
        {Param::fixed_wing, 1, [](C c) { return c.supervisor.on_leg; }, 10},
        {Param::fixed_wing, 0, [](C c) { return c.supervisor.on_leg; }, 1},
        same(Param::mass, 4.1F, [](C c) { return c.airframe.mass; }),
        same(Param::drag, 0.6F, [](C c) { return c.airframe.drag_coefficient; }),
        same(Param::area, 2.7F, [](C c) { return c.airframe.effective_area; }),
        same(Param::offsets, 6, [](C c) { return static_cast<float>(c.planner.offsets); }),
        same(Param::planes, 2, [](C c) { return static_cast<float>(c.planner.extra_planes); }),
        {Param::families, 1, [](C c) { return c.planner.simple && !c.planner.symmetric ? 1.0F : 0.0F; }, 1},
        {Param::families, 2, [](C c) { return !c.planner.simple && c.planner.symmetric ? 1.0F : 0.0F; }, 1},
        {Param::families, 4, [](C c) { return !c.planner.symmetric && c.planner.smooth ? 1.0F : 0.0F; }, 1},
        {Param::families, 8, [](C c) { return !c.planner.smooth && c.planner.plateau ? 1.0F : 0.0F; }, 1},
        {Param::families, 16, [](C c) { return !c.planner.plateau && c.planner.wait ? 1.0F : 0.0F; }, 1},
        same(Param::waypoints, 21, [](C c) { return static_cast<float>(c.planner.waypoints); }),
        {Param::swept, 1, [](C c) { return c.planner.security == geometric::SecurityMode::swept ? 1.0F : 0.0F; }, 1},
        {Param::swept, 0, [](C c) { return c.planner.security == geometric::SecurityMode::time_aware ? 1.0F : 0.0F; },
         1},
        same(Param::weight_smoothness, 0.4F, [](C c) { return c.planner.weights.smoothness; }),
        same(Param::weight_time, 0.25F, [](C c) { return c.planner.weights.time; }),
        {Param::weight_time, 0.5F, [](C c) { return c.planner.weights.closeness; }, 0.2F},
        same(Param::weight_passing, 0.15F, [](C c) { return c.planner.weights.passing; }),
        {Param::weight_passing, 0.15F, [](C c) { return c.planner.weights.closeness; }, 0.35F},
        same(Param::weight_beyond, 0.05F, [](C c) { return c.planner.weights.beyond; }),
        {Param::weight_beyond, 0.05F, [](C c) { return c.planner.weights.closeness; }, 0.45F},
        same(Param::rotation_penalty, 2.8F, [](C c) { return c.planner.rotation_penalty; }),
        same(Param::flip_penalty, 0.45F, [](C c) { return c.planner.flip_penalty; }),
        same(Param::nearest, 3, [](C c) { return static_cast<float>(c.planner.moving_nearest); }),
        same(Param::max_cost, 0.55F, [](C c) { return c.planner.max_cost; }),
        same(Param::time_low, 1.5F, [](C c) { return c.planner.caps.time_low; }),
        same(Param::time_high, 9.5F, [](C c) { return c.planner.caps.time_high; }),
        {Param::sticks, 45.0F, [](C c) { return c.sticks; }, 0.45F},
        same(Param::patience, 12.5F, [](C c) { return c.supervisor.patience; }),
        {Param::sticks, 45, [](C c) { return c.sticks; }, 0.45F},
        same(Param::sigma_baro, 31.5F, [](C c) { return c.sigma_baro; }),
        same(Param::sigma_compared, 6.5F, [](C c) { return c.sigma_compared; }),
        same(Param::well_clear, 610, [](C c) { return c.rules.well_clear.radius; }),
        same(Param::well_clear_height, 77, [](C c) { return c.rules.well_clear.height; }),
    };
}

TEST(Parameters, SetEachTakesAllThatFitTogetherAndCountsTheRest)
{
    Parameters parameters;
    // A floor above the present ceiling fits only after the new ceiling, which comes later.
    EXPECT_EQ(parameters.set(Param::bounds, 3.0F), ParamStatus::ok);
    Values wanted = parameters.values();
    wanted[index_of(Param::floor)] = 200.0F;
    wanted[index_of(Param::ceiling)] = 300.0F;
    wanted[index_of(Param::track_age)] = 1e6F;
    wanted[index_of(Param::mode)] = 1.0F;
    EXPECT_EQ(parameters.set_each(wanted), 1U);
    wanted[index_of(Param::track_age)] = 3.0F;
    EXPECT_EQ(parameters.values(), wanted);
    // Whichever comes first of two that exclude one another.
    Parameters others;
    Values clash = others.values();
    clash[index_of(Param::time_low)] = 50.0F;
    EXPECT_EQ(others.set_each(clash), 1U);
    EXPECT_EQ(others.values(), Parameters().values());
    const std::uint32_t generation = others.generation();
    clash[index_of(Param::time_high)] = 100.0F;
    EXPECT_EQ(others.set_each(clash), 0U);
    EXPECT_EQ(others.values(), clash);
    EXPECT_EQ(others.generation(), generation + 1) << "together, as one change";
}

TEST(Parameters, EachReachesItsPlaceInTheConfiguration)
{
    std::set<Param> seen;
    for (const Route& route : routes()) {
        const std::string_view name = param_table()[index_of(route.param)].name;
        Parameters parameters;
        ASSERT_EQ(parameters.set(route.param, route.value), ParamStatus::ok) << name;
        EXPECT_NEAR(route.read(parameters.configuration()), route.expected, 1e-6F) << name;
        seen.insert(route.param);
    }
    EXPECT_EQ(seen.size(), kParamCount);
}

}  // namespace
}  // namespace jink::app
