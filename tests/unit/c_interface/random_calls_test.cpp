// SPDX-License-Identifier: BSD-3-Clause
// jink.h called at random, in random order.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "tests/unit/c_interface/handles.hpp"

namespace {

using namespace jink_c_test;

/// Calls with arguments that are good, wrong or absurd, on handles that exist, are gone or never were.
class RandomCaller {
public:
    explicit RandomCaller(unsigned seed) : random_(seed) {}

    /// @return whether the call was accepted
    bool call()
    {
        switch (below(19)) {
        case 0: return create();
        case 1: return below(8) == 0 && destroy();
        case 2: return feed();
        case 3: return take();
        case 4: return note(jink_set_open(handle(), port(), int_of(2)));
        case 5: return feed_can();
        case 6: return take_can();
        case 7: return note(jink_set_can_state(handle(), int_of(5)));
        case 8: return below(12) == 0 && note(jink_shut_down(handle(), time()));
        case 9: return get<jink_status>([&](auto* s) { return jink_get_status(handle(), s); });
        case 10: return get<jink_counters>([&](auto* c) { return jink_get_counters(handle(), c); });
        case 11: return get<jink_track>([&](auto* t) { return jink_get_track(handle(), below(4), t); });
        case 12: return get<jink_parameter>([&](auto* p) { return jink_get_parameter_info(below(70), p); });
        case 13: return parameter();
        case 14: return track();
        case 15: return range();
        case 16: return areas();
        default: return note(jink_step(handle(), time()));
        }
    }
    void finish()
    {
        for (jink_coprocessor*& h : handles_) {
            jink_destroy(h);
            h = nullptr;
        }
    }
    [[nodiscard]] const std::array<long, 16>& results() const { return results_; }
    [[nodiscard]] unsigned refused_text() const { return unknown_; }

private:
    unsigned below(std::size_t n) { return static_cast<unsigned>(random_() % n); }
    bool seldom() { return below(12) == 0; }
    std::int32_t int_of(unsigned n) { return seldom() ? -5 : static_cast<std::int32_t>(below(n)); }
    std::int32_t port() { return seldom() ? int_of(100) : static_cast<std::int32_t>(below(2)); }
    jink_coprocessor* handle() { return seldom() ? nullptr : handles_[below(handles_.size())]; }
    float number()
    {
        constexpr std::array kNumbers{kNan, kInfinity, -kInfinity, 0.0F, -1.0F, 3e38F, 1e-40F, 1e6F};
        return seldom() ? kNumbers[below(kNumbers.size())] : static_cast<float>(below(2000)) * 0.1F - 60.0F;
    }
    std::int64_t time()
    {
        constexpr std::array<std::int64_t, 4> kTimes{0, -1, std::numeric_limits<std::int64_t>::max(),
                                                     std::numeric_limits<std::int64_t>::min()};
        now_ += static_cast<std::int64_t>(below(30'000));
        return seldom() ? kTimes[below(kTimes.size())] : now_;
    }
    bool note(jink_result result)
    {
        if (result < 0 || result >= static_cast<jink_result>(results_.size())) {
            ++unknown_;
            return false;
        }
        ++results_[static_cast<std::size_t>(result)];
        return result == JINK_OK;
    }
    template <class Sized>
    std::uint32_t size_of()
    {
        return seldom() ? below(300) : static_cast<std::uint32_t>(sizeof(Sized));
    }
    /// An output structure, with a byte behind it that stays.
    template <class Sized, class Get>
    bool get(Get call)
    {
        struct {
            Sized value;
            std::uint64_t behind;
        } out{};
        out.behind = 0x0123456789ABCDEF;
        out.value.size = size_of<Sized>();
        const bool accepted = note(call(seldom() ? nullptr : &out.value));
        EXPECT_EQ(out.behind, 0x0123456789ABCDEFU);
        return accepted;
    }
    bool create()
    {
        jink_options options{};
        options.size = size_of<jink_options>();
        options.clock_mhz = below(3) == 0 ? 100 + below(500) : 0;
        options.has_can = static_cast<std::uint8_t>(below(2));
        options.has_cloud = static_cast<std::uint8_t>(below(2));
        options.mavlink_over_can = static_cast<std::uint8_t>(seldom() ? 1 : 0);
        options.node_id = static_cast<std::uint8_t>(below(140));
        jink_coprocessor*& place = handles_[below(handles_.size())];
        jink_destroy(place);  // others go on with the old pointer, which is no handle any more
        return note(jink_create(seldom() ? below(9) : JINK_ABI, seldom() ? nullptr : &options, &place));
    }
    bool destroy()
    {
        jink_destroy(handle());
        return true;
    }
    bool feed()
    {
        std::array<std::uint8_t, 600> bytes{};
        std::ranges::generate(bytes, [&] { return static_cast<std::uint8_t>(random_()); });
        bytes[0] = 0xFD;
        std::size_t taken = 0;
        return note(jink_feed(handle(), port(), seldom() ? nullptr : bytes.data(), below(bytes.size() + 1),
                              below(2) == 0 ? nullptr : &taken));
    }
    bool take()
    {
        std::array<std::uint8_t, 300> into{};
        std::size_t taken = 0;
        const std::size_t capacity = below(into.size() + 1);
        const bool accepted =
            note(jink_take(handle(), seldom() ? nullptr : into.data(), capacity, seldom() ? nullptr : &taken));
        EXPECT_LE(taken, capacity);
        return accepted;
    }
    bool feed_can()
    {
        jink_can_frame frame{};
        frame.size = size_of<jink_can_frame>();
        frame.id = static_cast<std::uint32_t>(random_());
        frame.extended = static_cast<std::uint8_t>(below(seldom() ? 256 : 2));
        frame.id &= frame.extended != 0 ? 0x1FFFFFFFU : 0x7FFU;
        frame.length = static_cast<std::uint8_t>(below(10));
        std::ranges::generate(frame.data, [&] { return static_cast<std::uint8_t>(random_()); });
        return note(jink_feed_can(handle(), &frame));
    }
    bool take_can()
    {
        std::int32_t has_frame = 0;
        return get<jink_can_frame>([&](auto* f) { return jink_take_can(handle(), f, &has_frame); });
    }
    bool parameter()
    {
        auto info = sized<jink_parameter>();
        EXPECT_EQ(jink_get_parameter_info(below(jink_parameter_count()), &info), JINK_OK);
        const float span = info.high - info.low;
        const float value = seldom() ? number() : info.low + span * static_cast<float>(below(1000)) * 1e-3F;
        const float whole = info.is_integer != 0 ? std::floor(value) : value;
        float out = 0.0F;
        const bool set = note(jink_set_parameter(handle(), seldom() ? "NONE" : info.name, whole));
        return note(jink_get_parameter(handle(), info.name, seldom() ? nullptr : &out)) && set;
    }
    void fill(float (&v)[3])
    {
        std::ranges::generate(v, [&] { return number(); });
    }
    bool track()
    {
        jink_track_report report = good_track();
        report.size = size_of<jink_track_report>();
        report.id = below(70);
        report.source = int_of(4);
        report.stamp_us = time();
        fill(report.position);
        fill(report.velocity);
        report.has_velocity = below(2);
        report.radius = std::abs(number());
        return note(jink_report_track(handle(), &report));
    }
    bool range()
    {
        jink_range_report report = good_range();
        report.size = size_of<jink_range_report>();
        report.stamp_us = time();
        fill(report.direction);
        report.range = number();
        report.half_angle = std::abs(number()) * 0.01F;
        report.sensor = below(seldom() ? 1000 : 4);
        return note(jink_report_range(handle(), &report));
    }
    bool areas()
    {
        std::vector<jink_closed_area> areas(below(seldom() ? 70 : 6), good_area());
        for (jink_closed_area& area : areas) {
            area.centre[0] = number();
            area.centre[1] = number();
            area.radius = 1.0F + static_cast<float>(below(100));
            area.has_place = below(2);
            area.lat = static_cast<std::int32_t>(random_() % 900000000U);
            area.ends_us = below(2) == 0 ? 0 : time();
        }
        return note(jink_set_closed_areas(handle(), time(), seldom() ? nullptr : areas.data(), areas.size()));
    }

    std::mt19937 random_;
    std::array<jink_coprocessor*, 5> handles_{};
    std::int64_t now_ = 1'000'000;
    std::array<long, 16> results_{};
    unsigned unknown_ = 0;
};

TEST(CInterfaceLaw, TenThousandRandomCallsGiveAResultEachAndTheNextHandleIsAsNew)
{
    std::array<long, 16> results{};
    for (unsigned seed = 1; seed <= 4; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        RandomCaller caller(seed);
        long accepted = 0;
        for (int i = 0; i < 2500; ++i) {
            accepted += caller.call() ? 1 : 0;
        }
        EXPECT_GT(accepted, 300);
        EXPECT_EQ(caller.refused_text(), 0U);
        caller.finish();
        std::ranges::transform(results, caller.results(), results.begin(), std::plus<>{});
    }
    for (jink_result r = 0; r < 16; ++r) {
        const bool rare = r == JINK_ERROR_MEMORY || r == JINK_ERROR_TOO_MANY || r == JINK_ERROR_INCONSISTENT;
        EXPECT_TRUE(rare || results[static_cast<std::size_t>(r)] > 0) << jink_error_text(r) << " never happened";
        EXPECT_STRNE(jink_error_text(r), jink_error_text(99)) << r;
    }
    const Handle handle = create();
    EXPECT_EQ(jink_step(handle.get(), 1), JINK_OK);
    auto status = sized<jink_status>();
    EXPECT_EQ(jink_get_status(handle.get(), &status), JINK_OK);
    EXPECT_EQ(status.tracks, 0U);
    EXPECT_EQ(status.faults & ~std::uint32_t{JINK_FAULT_NO_AUTOPILOT | JINK_FAULT_OWN_STATE_MISSING}, 0U);
}

}  // namespace
