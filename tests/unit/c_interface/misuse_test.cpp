// SPDX-License-Identifier: BSD-3-Clause
// jink.h used wrongly: every result by its cause.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <string_view>
#include <vector>

#include "tests/unit/c_interface/handles.hpp"

namespace {

using namespace jink_c_test;

jink_result create_with(const jink_options& options)
{
    jink_coprocessor* handle = nullptr;
    const jink_result result = jink_create(JINK_ABI, &options, &handle);
    EXPECT_EQ(handle != nullptr, result == JINK_OK);
    jink_destroy(handle);
    return result;
}

TEST(CInterfaceOptions, EachOptionOutOfRangeIsRefused)
{
    const auto refused = [](auto change) {
        auto options = sized<jink_options>();
        change(options);
        return create_with(options);
    };
    EXPECT_EQ(refused([](jink_options&) {}), JINK_OK);
    EXPECT_EQ(refused([](jink_options& o) { o.size = 0; }), JINK_ERROR_SIZE);
    EXPECT_EQ(refused([](jink_options& o) { o.size += 1; }), JINK_ERROR_SIZE);
    EXPECT_EQ(refused([](jink_options& o) { o.clock_mhz = 124; }), JINK_ERROR_OPTION);
    EXPECT_EQ(refused([](jink_options& o) { o.clock_mhz = 4001; }), JINK_ERROR_OPTION);
    EXPECT_EQ(refused([](jink_options& o) { o.clock_mhz = 216; }), JINK_OK);
    EXPECT_EQ(refused([](jink_options& o) { o.node_id = 128; }), JINK_ERROR_OPTION);
    EXPECT_EQ(refused([](jink_options& o) { o.has_can = 2; }), JINK_ERROR_OPTION);
    EXPECT_EQ(refused([](jink_options& o) { o.has_cloud = 2; }), JINK_ERROR_OPTION);
    EXPECT_EQ(refused([](jink_options& o) { o.mavlink_over_can = 1; }), JINK_ERROR_OPTION);
    EXPECT_EQ(refused([](jink_options& o) { o.mavlink_over_can = o.has_can = 1; }), JINK_OK);
    EXPECT_EQ(refused([](jink_options& o) { o.reserved[2] = 1; }), JINK_ERROR_OPTION);
}

TEST(CInterfaceOptions, NullAndAnotherAbiAreRefusedAndWriteNothing)
{
    const auto options = sized<jink_options>();
    auto* const untouched = reinterpret_cast<jink_coprocessor*>(std::uintptr_t{8});
    jink_coprocessor* handle = untouched;
    EXPECT_EQ(jink_create(JINK_ABI, nullptr, &handle), JINK_ERROR_NULL);
    EXPECT_EQ(jink_create(JINK_ABI, &options, nullptr), JINK_ERROR_NULL);
    EXPECT_EQ(jink_create(JINK_ABI + 1, &options, &handle), JINK_ERROR_VERSION);
    EXPECT_EQ(handle, untouched);
}

TEST(CInterfaceHandle, ADestroyedOrMadeUpHandleIsRefused)
{
    jink_coprocessor* const gone = create().release();
    const Handle other = create();
    jink_destroy(gone);
    jink_destroy(gone);
    jink_destroy(nullptr);
    const int nothing = 0;
    auto* const made_up = reinterpret_cast<jink_coprocessor*>(const_cast<int*>(&nothing));
    jink_destroy(made_up);
    auto status = sized<jink_status>();
    EXPECT_EQ(jink_step(gone, 1), JINK_ERROR_HANDLE);
    EXPECT_EQ(jink_get_status(gone, &status), JINK_ERROR_HANDLE);
    EXPECT_EQ(jink_step(made_up, 1), JINK_ERROR_HANDLE);
    EXPECT_EQ(jink_step(nullptr, 1), JINK_ERROR_NULL);
    EXPECT_EQ(jink_step(other.get(), 1), JINK_OK);
}

TEST(CInterfaceHandle, ADestroyedHandleStaysRefusedWhileOthersComeAndGo)
{
    std::vector<jink_coprocessor*> gone;
    for (int i = 0; i < 300; ++i) {
        Handle handle = create();
        for (jink_coprocessor* const old : gone) {
            ASSERT_EQ(jink_step(old, 1), JINK_ERROR_HANDLE) << "after " << i << " others";
            jink_destroy(old);
        }
        ASSERT_EQ(jink_step(handle.get(), 1), JINK_OK) << "a destroyed handle has destroyed another";
        gone.push_back(handle.get());
    }
}

TEST(CInterfaceHandle, NoMoreThanTheStatedNumberOfHandles)
{
    std::vector<Handle> handles;
    const auto options = sized<jink_options>();
    jink_coprocessor* handle = nullptr;
    while (jink_create(JINK_ABI, &options, &handle) == JINK_OK) {
        handles.emplace_back(handle);
        ASSERT_LE(handles.size(), std::size_t{JINK_MAX_HANDLES});
    }
    EXPECT_EQ(handles.size(), std::size_t{JINK_MAX_HANDLES});
    EXPECT_EQ(create_with(options), JINK_ERROR_TOO_MANY);
    handles.pop_back();
    EXPECT_EQ(create_with(options), JINK_OK);
}

TEST(CInterfaceTime, TimeThatDoesNotGoOnIsRefused)
{
    const Handle handle = create();
    EXPECT_EQ(jink_step(handle.get(), -1), JINK_ERROR_TIME);
    EXPECT_EQ(jink_step(handle.get(), JINK_LATEST_TIME + 1), JINK_ERROR_TIME);
    EXPECT_EQ(jink_step(handle.get(), 0), JINK_OK);
    EXPECT_EQ(jink_step(handle.get(), 0), JINK_ERROR_TIME);
    EXPECT_EQ(jink_step(handle.get(), 20'000), JINK_OK);
    EXPECT_EQ(jink_step(handle.get(), 19'999), JINK_ERROR_TIME);
    EXPECT_EQ(jink_shut_down(handle.get(), 19'999), JINK_ERROR_TIME);
    EXPECT_EQ(jink_shut_down(handle.get(), 40'000), JINK_OK);
    EXPECT_EQ(jink_step(handle.get(), 60'000), JINK_ERROR_ENDED);
    EXPECT_EQ(jink_shut_down(handle.get(), 60'000), JINK_ERROR_ENDED);
    std::array<std::uint8_t, 4096> out{};
    std::size_t taken = 0;
    EXPECT_EQ(jink_take(handle.get(), out.data(), out.size(), &taken), JINK_OK);
    EXPECT_GT(taken, 0U) << "last words";
}

TEST(CInterfacePorts, FullLinesTakeNoMoreAndShortBuffersLoseNothing)
{
    const Handle handle = create();
    std::vector<std::uint8_t> bytes(8192, 0x55);
    std::size_t taken = 99;
    EXPECT_EQ(jink_feed(handle.get(), JINK_PORT_AUTOPILOT, bytes.data(), bytes.size() + 1, nullptr), JINK_ERROR_FULL);
    EXPECT_EQ(jink_feed(handle.get(), JINK_PORT_AUTOPILOT, bytes.data(), 8000, &taken), JINK_OK);
    EXPECT_EQ(taken, 8000U);
    EXPECT_EQ(jink_feed(handle.get(), JINK_PORT_AUTOPILOT, bytes.data(), 400, &taken), JINK_OK);
    EXPECT_EQ(taken, 192U);
    EXPECT_EQ(jink_feed(handle.get(), JINK_PORT_AUTOPILOT, bytes.data(), 1, nullptr), JINK_ERROR_FULL);
    EXPECT_EQ(jink_feed(handle.get(), JINK_PORT_AUTOPILOT, nullptr, 0, nullptr), JINK_OK);
    EXPECT_EQ(jink_feed(handle.get(), JINK_PORT_AUTOPILOT, nullptr, 1, nullptr), JINK_ERROR_NULL);
    EXPECT_EQ(jink_feed(handle.get(), JINK_PORT_CLOUD, bytes.data(), 1, nullptr), JINK_ERROR_PORT);
    EXPECT_EQ(jink_feed(handle.get(), 2, bytes.data(), 1, nullptr), JINK_ERROR_PORT);
    EXPECT_EQ(jink_step(handle.get(), 1'000'000), JINK_OK);
    auto status = sized<jink_status>();
    EXPECT_EQ(jink_get_status(handle.get(), &status), JINK_OK);
    EXPECT_EQ(status.bytes_in, 4096U);
    ASSERT_GT(status.bytes_out, 1U);
    // Byte by byte, what one large buffer would have got.
    std::uint8_t byte = 0;
    std::uint32_t out = 0;
    for (taken = 1; taken == 1; out += static_cast<std::uint32_t>(taken)) {
        EXPECT_EQ(jink_take(handle.get(), &byte, 1, &taken), JINK_OK);
    }
    EXPECT_EQ(out, status.bytes_out);
    EXPECT_EQ(jink_take(handle.get(), nullptr, 0, &taken), JINK_OK);
    EXPECT_EQ(jink_take(handle.get(), nullptr, 1, &taken), JINK_ERROR_NULL);
    EXPECT_EQ(jink_take(handle.get(), &byte, 1, nullptr), JINK_ERROR_NULL);
}

TEST(CInterfacePorts, ALineThatIsNotOpenIsAFaultAndTakesNothing)
{
    const Handle handle = create();
    auto status = sized<jink_status>();
    const std::uint8_t byte = 0;
    std::size_t taken = 9;
    EXPECT_EQ(jink_set_open(handle.get(), JINK_PORT_CLOUD, 0), JINK_ERROR_PORT);
    EXPECT_EQ(jink_set_open(handle.get(), JINK_PORT_AUTOPILOT, 0), JINK_OK);
    EXPECT_EQ(jink_feed(handle.get(), JINK_PORT_AUTOPILOT, &byte, 1, &taken), JINK_OK);
    EXPECT_EQ(taken, 0U);
    EXPECT_EQ(jink_step(handle.get(), 1), JINK_OK);
    EXPECT_EQ(jink_get_status(handle.get(), &status), JINK_OK);
    EXPECT_NE(status.faults & JINK_FAULT_PORT_LOST, 0U);
    EXPECT_EQ(jink_set_open(handle.get(), JINK_PORT_AUTOPILOT, 1), JINK_OK);
    EXPECT_EQ(jink_step(handle.get(), 20'001), JINK_OK);
    EXPECT_EQ(jink_get_status(handle.get(), &status), JINK_OK);
    EXPECT_EQ(status.faults & JINK_FAULT_PORT_LOST, 0U);
}

TEST(CInterfacePorts, CanFramesAreCheckedAndNeedABus)
{
    const Handle without = create();
    auto frame = sized<jink_can_frame>();
    std::int32_t has_frame = 0;
    EXPECT_EQ(jink_feed_can(without.get(), &frame), JINK_ERROR_PORT);
    EXPECT_EQ(jink_take_can(without.get(), &frame, &has_frame), JINK_ERROR_PORT);
    EXPECT_EQ(jink_set_can_state(without.get(), JINK_CAN_ACTIVE), JINK_ERROR_PORT);
    auto options = sized<jink_options>();
    options.has_can = options.mavlink_over_can = 1;
    options.node_id = 42;
    const Handle handle = create(options);
    EXPECT_EQ(jink_feed_can(handle.get(), &frame), JINK_OK);
    frame.length = 9;
    EXPECT_EQ(jink_feed_can(handle.get(), &frame), JINK_ERROR_VALUE);
    frame.length = 8;
    frame.id = 0x800;
    EXPECT_EQ(jink_feed_can(handle.get(), &frame), JINK_ERROR_VALUE);
    frame.extended = 1;
    for (int i = 1; i < 512; ++i) {
        ASSERT_EQ(jink_feed_can(handle.get(), &frame), JINK_OK);
    }
    EXPECT_EQ(jink_feed_can(handle.get(), &frame), JINK_ERROR_FULL);
    EXPECT_EQ(jink_feed(handle.get(), JINK_PORT_AUTOPILOT, frame.data, 1, nullptr), JINK_ERROR_PORT);
    EXPECT_EQ(jink_set_can_state(handle.get(), 4), JINK_ERROR_VALUE);
    EXPECT_EQ(jink_set_can_state(handle.get(), JINK_CAN_BUS_OFF), JINK_OK);
    EXPECT_EQ(jink_step(handle.get(), 1), JINK_OK);
    auto status = sized<jink_status>();
    EXPECT_EQ(jink_get_status(handle.get(), &status), JINK_OK);
    EXPECT_NE(status.faults & JINK_FAULT_BUS_LOST, 0U);
    EXPECT_EQ(jink_set_can_state(handle.get(), JINK_CAN_ACTIVE), JINK_OK);
    int sent = 0;
    for (std::int64_t now = 20'001; now < 3'000'000; now += 20'000) {
        EXPECT_EQ(jink_step(handle.get(), now), JINK_OK);
        for (has_frame = 1; has_frame != 0; sent += has_frame) {
            EXPECT_EQ(jink_take_can(handle.get(), &frame, &has_frame), JINK_OK);
        }
    }
    EXPECT_GT(sent, 2) << "NodeStatus";
    frame.size = 1;
    EXPECT_EQ(jink_take_can(handle.get(), &frame, &has_frame), JINK_ERROR_SIZE);
}

TEST(CInterfaceParameters, EachCauseOfARefusalAndAllOrNone)
{
    const Handle handle = create();
    float value = 0.0F;
    EXPECT_EQ(jink_set_parameter(handle.get(), "JNK_NOTHING", 1.0F), JINK_ERROR_NAME);
    EXPECT_EQ(jink_get_parameter(handle.get(), "", &value), JINK_ERROR_NAME);
    EXPECT_EQ(jink_set_parameter(handle.get(), "VEH_CRUISE", kNan), JINK_ERROR_VALUE);
    EXPECT_EQ(jink_set_parameter(handle.get(), "VEH_CRUISE", 1e6F), JINK_ERROR_VALUE);
    EXPECT_EQ(jink_set_parameter(handle.get(), "JNK_MODE", 0.5F), JINK_ERROR_VALUE);
    EXPECT_EQ(jink_set_parameter(handle.get(), nullptr, 1.0F), JINK_ERROR_NULL);
    const std::array<const char*, 2> names{"JNK_MODE", "VEH_MASS"};
    const std::array<const char*, 2> with_null{"JNK_MODE", nullptr};
    const std::array<float, 2> values{1.0F, kNan};
    EXPECT_EQ(jink_set_parameters(handle.get(), names.data(), values.data(), 2), JINK_ERROR_VALUE);
    EXPECT_EQ(jink_set_parameters(handle.get(), with_null.data(), values.data(), 2), JINK_ERROR_NULL);
    EXPECT_EQ(jink_get_parameter(handle.get(), "JNK_MODE", &value), JINK_OK);
    EXPECT_EQ(value, 2.0F) << "nothing of a refused set";
    // A floor above the ceiling: each in range.
    const std::array<const char*, 2> bounds{"JNK_CEILING", "JNK_FLOOR"};
    const std::array<float, 2> crossed{10.0F, 20.0F};
    const std::array<float, 2> moved{300.0F, 200.0F};
    EXPECT_EQ(jink_set_parameter(handle.get(), "JNK_BOUNDS", 3.0F), JINK_OK);
    EXPECT_EQ(jink_set_parameters(handle.get(), bounds.data(), crossed.data(), 2), JINK_ERROR_INCONSISTENT);
    EXPECT_EQ(jink_set_parameters(handle.get(), bounds.data(), moved.data(), 2), JINK_OK);
    auto info = sized<jink_parameter>();
    EXPECT_EQ(jink_get_parameter_info(jink_parameter_count(), &info), JINK_ERROR_INDEX);
    info.size = 3;
    EXPECT_EQ(jink_get_parameter_info(0, &info), JINK_ERROR_SIZE);
}

TEST(CInterfaceParameters, EveryParameterIsListedAndTakesItsLimitsInFlight)
{
    const Handle handle = create();
    EXPECT_EQ(jink_step(handle.get(), 1), JINK_OK);
    std::int64_t now = 1;
    for (std::uint32_t i = 0; i < jink_parameter_count(); ++i) {
        auto info = sized<jink_parameter>();
        ASSERT_EQ(jink_get_parameter_info(i, &info), JINK_OK);
        float value = kNan;
        ASSERT_EQ(jink_get_parameter(handle.get(), info.name, &value), JINK_OK);
        EXPECT_EQ(value, info.initial) << info.name;
        EXPECT_EQ(std::string_view(info.name).size(), std::strlen(info.name));
        EXPECT_GT(std::strlen(info.text), 5U) << info.name;
        EXPECT_EQ(jink_set_parameter(handle.get(), info.name, std::nextafter(info.high, kInfinity)), JINK_ERROR_VALUE)
            << info.name;
        ASSERT_EQ(jink_set_parameter(handle.get(), info.name, info.initial), JINK_OK) << info.name;
        ASSERT_EQ(jink_step(handle.get(), now += 20'000), JINK_OK);
    }
    auto counters = sized<jink_counters>();
    EXPECT_EQ(jink_get_counters(handle.get(), &counters), JINK_OK);
    EXPECT_EQ(counters.parameters_set, jink_parameter_count()) << "each came into force in its step";
    for (int i = 0; i < 16; ++i) {
        EXPECT_EQ(jink_set_parameter(handle.get(), "JNK_MODE", 1.0F), JINK_OK);
    }
    EXPECT_EQ(jink_set_parameter(handle.get(), "JNK_MODE", 0.0F), JINK_ERROR_FULL);
    EXPECT_EQ(jink_step(handle.get(), now + 20'000), JINK_OK);
    float mode = 0.0F;
    EXPECT_EQ(jink_get_parameter(handle.get(), "JNK_MODE", &mode), JINK_OK);
    EXPECT_EQ(mode, 1.0F);
}

TEST(CInterfaceReports, NumbersThatAreNotFiniteOrOutOfRangeAreRefused)
{
    const Handle handle = create();
    const auto track = [&](auto change) {
        jink_track_report report = good_track();
        change(report);
        return jink_report_track(handle.get(), &report);
    };
    EXPECT_EQ(track([](auto&) {}), JINK_OK);
    EXPECT_EQ(track([](auto& r) { r.size = 4; }), JINK_ERROR_SIZE);
    EXPECT_EQ(track([](auto& r) { r.id = 0; }), JINK_ERROR_VALUE);
    EXPECT_EQ(track([](auto& r) { r.source = 4; }), JINK_ERROR_VALUE);
    EXPECT_EQ(track([](auto& r) { r.position[2] = kNan; }), JINK_ERROR_VALUE);
    EXPECT_EQ(track([](auto& r) { r.has_velocity = 1, r.velocity[0] = kInfinity; }), JINK_ERROR_VALUE);
    EXPECT_EQ(track([](auto& r) { r.has_velocity = 1, r.velocity[0] = 401.0F; }), JINK_ERROR_VALUE);
    EXPECT_EQ(track([](auto& r) { r.velocity[0] = kNan; }), JINK_OK) << "not read";
    EXPECT_EQ(track([](auto& r) { r.radius = -1.0F; }), JINK_ERROR_VALUE);
    EXPECT_EQ(track([](auto& r) { r.sigma_position = kNan; }), JINK_ERROR_VALUE);
    EXPECT_EQ(track([](auto& r) { r.stamp_us = -1; }), JINK_ERROR_VALUE);
    const auto range = [&](auto change) {
        jink_range_report report = good_range();
        change(report);
        return jink_report_range(handle.get(), &report);
    };
    EXPECT_EQ(range([](auto&) {}), JINK_OK);
    EXPECT_EQ(range([](auto& r) { r.size = 4; }), JINK_ERROR_SIZE);
    EXPECT_EQ(range([](auto& r) { r.direction[0] = 0.0F; }), JINK_ERROR_VALUE);
    EXPECT_EQ(range([](auto& r) { r.direction[1] = kNan; }), JINK_ERROR_VALUE);
    EXPECT_EQ(range([](auto& r) { r.sensor = 256; }), JINK_ERROR_VALUE);
    EXPECT_EQ(range([](auto& r) { r.range = kInfinity; }), JINK_ERROR_VALUE);
    EXPECT_EQ(range([](auto& r) { r.half_angle = 1.6F; }), JINK_ERROR_VALUE);
    const auto area = [&](auto change, std::int64_t now = 5) {
        std::array<jink_closed_area, 2> areas{good_area(), good_area()};
        change(areas[1]);
        return jink_set_closed_areas(handle.get(), now, areas.data(), areas.size());
    };
    EXPECT_EQ(area([](auto&) {}), JINK_OK);
    EXPECT_EQ(area([](auto& a) { a.size = 4; }), JINK_ERROR_SIZE);
    EXPECT_EQ(area([](auto& a) { a.radius = 0.0F; }), JINK_ERROR_VALUE);
    EXPECT_EQ(area([](auto& a) { a.top = -1.0F; }), JINK_ERROR_VALUE);
    EXPECT_EQ(area([](auto& a) { a.centre[1] = kNan; }), JINK_ERROR_VALUE);
    EXPECT_EQ(area([](auto& a) { a.stamp_us = 6; }), JINK_ERROR_VALUE);
    EXPECT_EQ(area([](auto& a) { a.has_place = 1, a.lat = 900000001; }), JINK_ERROR_VALUE);
    EXPECT_EQ(area([](auto&) {}, -1), JINK_ERROR_TIME);
    EXPECT_EQ(jink_set_closed_areas(handle.get(), 5, nullptr, 1), JINK_ERROR_NULL);
    EXPECT_EQ(jink_set_closed_areas(handle.get(), 5, nullptr, 0), JINK_OK);
}

TEST(CInterfaceReports, OneOfTheFutureIsRefusedInItsStepAndTheQueueEnds)
{
    const Handle handle = create();
    jink_track_report report = good_track();
    report.stamp_us = 1'000'001;
    EXPECT_EQ(jink_report_track(handle.get(), &report), JINK_OK);
    EXPECT_EQ(jink_step(handle.get(), 1'000'000), JINK_OK);
    EXPECT_EQ(jink_report_track(handle.get(), &report), JINK_OK);
    EXPECT_EQ(jink_step(handle.get(), 1'020'000), JINK_OK);
    auto counters = sized<jink_counters>();
    EXPECT_EQ(jink_get_counters(handle.get(), &counters), JINK_OK);
    EXPECT_EQ(counters.caller_reports_refused, 1U);
    EXPECT_EQ(counters.caller_reports, 1U);
    auto track = sized<jink_track>();
    EXPECT_EQ(jink_get_track(handle.get(), 0, &track), JINK_ERROR_INDEX) << "the vehicle's own place is not known";
    int taken = 0;
    while (jink_report_track(handle.get(), &report) == JINK_OK) {
        ASSERT_LT(++taken, 1000);
    }
    EXPECT_EQ(taken, 96);
    const jink_range_report range = good_range();
    for (taken = 0; jink_report_range(handle.get(), &range) == JINK_OK; ++taken) {
        ASSERT_LT(taken, 1000);
    }
    EXPECT_EQ(taken, 16);
}

}  // namespace
