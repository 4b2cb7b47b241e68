// SPDX-License-Identifier: BSD-3-Clause
// Home, for any order of the messages that define it: known and correct, or unknown.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "firmware/link/mavlink/endpoint.hpp"
#include "tests/numbers.hpp"
#include "tests/unit/link/mavlink_tools.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;

std::uint64_t home_seed()
{
    const char* const given = std::getenv("JINK_SEED");
    return given != nullptr ? std::strtoull(given, nullptr, 0) : 20261125;
}
int home_cases(int usual)
{
    const char* const given = std::getenv("JINK_CASES");
    return given != nullptr ? std::max(1, std::atoi(given)) : usual;
}

constexpr double kRadiusOfEarth = 6378137.0;
constexpr double kPerRadian = 1e7 * 180.0 / 3.14159265358979323846;

struct GlobePlace {
    double lat = 0.0, lon = 0.0;  ///< [rad]
    double alt = 0.0;             ///< [m]
};
struct LocalPlace {
    double east = 0.0, north = 0.0, up = 0.0;
};

/// By great circle and bearing, in double precision.
LocalPlace local_of(const GlobePlace& p, const GlobePlace& origin)
{
    const double dlon = p.lon - origin.lon;
    const double cosine =
        std::sin(origin.lat) * std::sin(p.lat) + std::cos(origin.lat) * std::cos(p.lat) * std::cos(dlon);
    const double x = std::cos(p.lat) * std::sin(dlon);
    const double y = std::cos(origin.lat) * std::sin(p.lat) - std::sin(origin.lat) * std::cos(p.lat) * std::cos(dlon);
    const double sine = std::hypot(x, y);
    const double scale = sine < 1e-12 ? 1.0 : std::atan2(sine, cosine) / sine;
    return {kRadiusOfEarth * scale * x, kRadiusOfEarth * scale * y, p.alt - origin.alt};
}

/// The inverse, by fixed-point steps.
GlobePlace place_of(const LocalPlace& local, const GlobePlace& origin)
{
    GlobePlace p = origin;
    for (int i = 0; i < 20; ++i) {
        const LocalPlace now = local_of(p, origin);
        p.lat += (local.north - now.north) / kRadiusOfEarth;
        p.lon += (local.east - now.east) / (kRadiusOfEarth * std::cos(p.lat));
    }
    p.alt = origin.alt + local.up;
    return p;
}

std::int32_t deg_e7(double radians) { return static_cast<std::int32_t>(std::llround(radians * kPerRadian)); }
std::int32_t millimetres(double metres) { return static_cast<std::int32_t>(std::llround(metres * 1e3)); }

class TellingVehicle {
public:
    TellingVehicle(std::uint64_t seed, bool px4) : random_(seed), px4_(px4)
    {
        origin_ = {random_.uniform(-1.0F, 1.0F), random_.uniform(-3.0F, 3.0F), random_.uniform(-50.0F, 3000.0F)};
        has_origin_message_ = random_.below(4) != 0;
        has_global_ = !has_origin_message_ || random_.below(2) != 0;
        move_home();
    }
    void move_home()
    {
        home_ = place_of(
            {random_.uniform(-1500.0F, 1500.0F), random_.uniform(-1500.0F, 1500.0F), random_.uniform(-100.0F, 100.0F)},
            origin_);
    }
    void move_origin()
    {
        origin_ = place_of(
            {random_.uniform(-800.0F, 800.0F), random_.uniform(-800.0F, 800.0F), random_.uniform(-60.0F, 60.0F)},
            origin_);
    }
    /// Every message once, in any order.
    void say_all()
    {
        std::vector<std::function<void()>> all{[&] { beat(); }, [&] { tell_home(); }, [&] { tell_local(); }};
        if (has_origin_message_) {
            all.emplace_back([&] { tell_origin(); });
        }
        if (has_global_) {
            all.emplace_back([&] { tell_local(), tell_global(); });
            all.emplace_back([&] { tell_global(); });
        }
        for (std::size_t i = all.size(); i > 1; --i) {
            std::swap(all[i - 1], all[random_.below(i)]);
        }
        for (const auto& say : all) {
            say();
            now_us_ += static_cast<std::int64_t>(random_.uniform(1e3F, 4e5F));
        }
    }
    void expect_right(const char* when) const
    {
        ASSERT_TRUE(known_) << when;
        expect_home(when);
    }
    void expect_right_if_known(const char* when) const
    {
        if (known_) {
            expect_home(when);
        }
    }

private:
    void expect_home(const char* when) const
    {
        const LocalPlace truth = local_of(home_, origin_);
        // kMapError, the wire's degE7 and millimetres, and float at 2 km; an own position pair twice.
        constexpr double kTolerance = 0.12;
        EXPECT_NEAR(believed_.x(), truth.east, kTolerance) << when;
        EXPECT_NEAR(believed_.y(), truth.north, kTolerance) << when;
        EXPECT_NEAR(believed_.z(), truth.up, kTolerance) << when;
    }
    template <Message M>
    void say(const M& message)
    {
        inbox_->clear();
        endpoint_->receive(frame_of(message, {1, 1, sequence_++}), {now_us_}, *inbox_);
        if (inbox_->has_home) {
            known_ = true;
            believed_ = inbox_->home;
        }
    }
    void beat()
    {
        Heartbeat m;
        m.autopilot = px4_ ? 12 : 3;
        m.type = 2;
        say(m);
    }
    void tell_origin()
    {
        GpsGlobalOrigin m;
        m.latitude = deg_e7(origin_.lat);
        m.longitude = deg_e7(origin_.lon);
        m.altitude = millimetres(origin_.alt);
        say(m);
    }
    void tell_home()
    {
        HomePosition m;
        m.latitude = deg_e7(home_.lat);
        m.longitude = deg_e7(home_.lon);
        m.altitude = millimetres(home_.alt);
        if (px4_) {  // ArduPilot: zeros
            const LocalPlace local = local_of(home_, origin_);
            m.x = random_.below(3) == 0 ? kNan : static_cast<float>(local.north);
            m.y = static_cast<float>(local.east);
            m.z = static_cast<float>(-local.up);
        }
        say(m);
    }
    [[nodiscard]] std::uint32_t boot_ms() const { return static_cast<std::uint32_t>(now_us_ / 1000); }
    /// The vehicle flies a straight line.
    [[nodiscard]] LocalPlace own() const
    {
        const double t = static_cast<double>(boot_ms()) * 1e-3 - 100.0;
        return {10.0 + 12.0 * t, -20.0 - 5.0 * t, 30.0 + 1.0 * t};
    }
    void tell_local()
    {
        LocalPositionNed m;
        m.time_boot_ms = boot_ms();
        m.x = static_cast<float>(own().north);
        m.y = static_cast<float>(own().east);
        m.z = static_cast<float>(-own().up);
        m.vx = -5.0F;
        m.vy = 12.0F;
        m.vz = -1.0F;
        say(m);
        now_us_ += 1000 * static_cast<std::int64_t>(random_.below(250));
    }
    void tell_global()
    {
        const GlobePlace p = place_of(own(), origin_);
        GlobalPositionInt m;
        m.time_boot_ms = boot_ms();
        m.lat = deg_e7(p.lat);
        m.lon = deg_e7(p.lon);
        m.alt = millimetres(p.alt);
        say(m);
    }

    Random random_;
    bool px4_;
    GlobePlace origin_, home_;
    bool has_origin_message_ = true;
    bool has_global_ = true;
    bool known_ = false;
    Vec3 believed_ = Vec3::Zero();
    std::int64_t now_us_ = 100'000'000;
    std::uint8_t sequence_ = 0;
    std::unique_ptr<Endpoint> endpoint_ = std::make_unique<Endpoint>();
    std::unique_ptr<Inbox> inbox_ = std::make_unique<Inbox>();
};

TEST(MavlinkHomeProperty, IsRightWhateverTheOrderOfTheMessages)
{
    for (int i = 0; i < home_cases(400) && !::testing::Test::HasFailure(); ++i) {
        const std::uint64_t seed = home_seed() + static_cast<std::uint64_t>(i);
        SCOPED_TRACE("JINK_CASES=1 JINK_SEED=" + std::to_string(seed));
        TellingVehicle v(seed, seed % 2 == 0);
        v.say_all();
        v.expect_right_if_known("in the first round the HEARTBEAT may be last");
        for (int round = 0; round < 6; ++round) {
            v.say_all();
        }
        ASSERT_NO_FATAL_FAILURE(v.expect_right("at the start"));
        v.move_home();
        v.say_all();
        ASSERT_NO_FATAL_FAILURE(v.expect_right("home has moved, or the vehicle was armed elsewhere"));
        v.move_origin();
        for (int round = 0; round < 6; ++round) {
            v.say_all();
        }
        ASSERT_NO_FATAL_FAILURE(v.expect_right("the origin has moved"));
    }
}

}  // namespace
}  // namespace jink::link::mavlink
