// SPDX-License-Identifier: BSD-3-Clause
// Reports of traffic in Coprocessor::step: how report and parameters become a track.
#include <gtest/gtest.h>

#include "tests/unit/app/step_bench.hpp"

namespace jink::app::test {
namespace {

using Source = world::TrackSource;

/// The only track, after one step with this report.
world::Track track_of(StepBench& b, const link::TrackReport& report)
{
    b.hear_autopilot();
    b.hear_own();
    b.wire.tracks.push_back(report);
    b.step();
    const auto tracks = b.coprocessor.tracks(b.now);
    EXPECT_EQ(tracks.size(), 1U);
    return tracks.empty() ? world::Track{} : tracks[0];
}

TEST(StepTraffic, IsOlderByTheLatencyAndFlownOnToNow)
{
    StepBench b({{Param::track_latency, 0.4F}});
    link::TrackReport r = b.track_report(7, Vec3(100.0F, 0.0F, 50.0F));
    r.velocity = Vec3(10.0F, 0.0F, -2.0F);
    r.stamp = r.stamp - 0.1F;
    const world::Track t = track_of(b, r);
    EXPECT_EQ(t.id, 7U);
    EXPECT_NEAR(b.now - t.stamp, 0.5F, 1e-5F);
    EXPECT_NEAR(t.position.x(), 105.0F, 1e-3F);
    EXPECT_NEAR(t.position.z(), 49.0F, 1e-3F);
    EXPECT_EQ(t.velocity, Vec3(10.0F, 0.0F, -2.0F));
}

TEST(StepTraffic, TakesWhatItSaysAndTheParametersForTheRest)
{
    const std::initializer_list<std::pair<Param, float>> values{
        {Param::track_radius, 2.5F},  {Param::point_radius, 4.5F},       {Param::track_sigma_p, 0.7F},
        {Param::track_sigma_v, 0.9F}, {Param::track_acceleration, 1.5F},
    };
    {
        StepBench b(values);
        const world::Track t = track_of(b, b.track_report(1, Vec3(100.0F, 0.0F, 50.0F)));
        EXPECT_EQ(t.radius, 2.5F);
        EXPECT_NEAR(t.sigma_position, 0.7F, 1e-4F);
        EXPECT_NEAR(t.sigma_velocity, 0.9F, 1e-3F);
        EXPECT_EQ(t.max_acceleration, 1.5F);
    }
    {
        StepBench b(values);
        link::TrackReport r = b.track_report(1, Vec3(100.0F, 0.0F, 50.0F));
        r.radius = 6.0F;
        r.sigma_position = 3.0F;
        r.sigma_velocity = 2.0F;
        const world::Track t = track_of(b, r);
        EXPECT_EQ(t.radius, 6.0F);
        EXPECT_NEAR(t.sigma_position, 3.0F, 1e-4F);
        EXPECT_NEAR(t.sigma_velocity, 2.0F, 1e-3F);
    }
    {
        StepBench b(values);
        link::TrackReport r = b.track_report(1, Vec3(100.0F, 0.0F, 50.0F));
        r.has_velocity = false;
        EXPECT_NEAR(track_of(b, r).sigma_velocity, world::TrackTableSettings{}.first_sigma_velocity, 1e-3F)
            << "not said is not zero";
    }
}

TEST(StepTraffic, ThatStandsHasASizeOfItsOwnAndNoMotion)
{
    const std::initializer_list<std::pair<Param, float>> values{
        {Param::track_radius, 2.5F}, {Param::point_radius, 4.5F}, {Param::track_acceleration, 1.5F}};
    for (const float radius : {0.0F, 3.0F}) {
        StepBench b(values);
        link::TrackReport r = b.track_report(1, Vec3(100.0F, 0.0F, 50.0F));
        r.velocity = Vec3(30.0F, 0.0F, 0.0F);  // the reported value is ignored
        r.sigma_velocity = 5.0F;
        r.has_velocity = false;
        r.at_rest = true;
        r.radius = radius;
        const world::Track t = track_of(b, r);
        EXPECT_EQ(t.radius, radius > 0.0F ? radius : 4.5F);
        EXPECT_EQ(t.velocity, Vec3::Zero());
        EXPECT_NEAR(t.sigma_velocity, 0.02F, 1e-4F);
        EXPECT_EQ(t.max_acceleration, 0.0F);
        EXPECT_EQ(t.position.x(), 100.0F);
    }
}

TEST(StepTraffic, SharesTheReactionAsTheParameterSays)
{
    const auto shares = [](int coop, Source source, bool unmanned = false, bool at_rest = false,
                           bool helpless = false) {
        StepBench b({{Param::coop, static_cast<float>(coop)}});
        link::TrackReport r = b.track_report(1, Vec3(100.0F, 0.0F, 50.0F));
        r.source = source;
        r.unmanned = unmanned;
        r.at_rest = at_rest;
        r.helpless = helpless;
        const world::Track t = track_of(b, r);
        EXPECT_EQ(t.source, source);
        return t.cooperative;
    };
    for (int coop = 0; coop < 16; ++coop) {
        SCOPED_TRACE(coop);
        EXPECT_EQ(shares(coop, Source::datalink), (coop & 1) != 0);
        EXPECT_EQ(shares(coop, Source::utm), (coop & 2) != 0);
        EXPECT_EQ(shares(coop, Source::adsb, true), (coop & 12) != 0);
        EXPECT_EQ(shares(coop, Source::adsb, false), (coop & 8) != 0);
        EXPECT_FALSE(shares(coop, Source::own_sensor, true));
    }
    for (const Source source : {Source::datalink, Source::utm, Source::adsb}) {
        EXPECT_FALSE(shares(15, source, true, true, false)) << "what stands gives way to nobody";
        EXPECT_FALSE(shares(15, source, true, false, true)) << "nor who says that he will not";
    }
}

TEST(StepTraffic, AnUncertainHeightIsAsUncertainAsItsSource)
{
    const std::initializer_list<std::pair<Param, float>> values{
        {Param::k_sigma, 2.0F}, {Param::sigma_baro, 20.0F}, {Param::sigma_compared, 4.0F}};
    const auto half_height = [&](link::HeightSource source, float spread) {
        StepBench b(values);
        link::TrackReport r = b.track_report(1, Vec3(100.0F, 0.0F, 50.0F));
        r.height = source;
        r.height_spread = spread;
        const float found = track_of(b, r).half_height;
        EXPECT_EQ(b.last.uncertain_heights, found > 0.0F ? 1U : 0U);
        return found;
    };
    EXPECT_EQ(half_height(link::HeightSource::geometric, 3.0F), 3.0F) << "no barometer";
    EXPECT_EQ(half_height(link::HeightSource::geometric, 0.0F), 0.0F);
    EXPECT_EQ(half_height(link::HeightSource::pressure, 3.0F), 40.0F);
    EXPECT_EQ(half_height(link::HeightSource::compared, 3.0F), 11.0F);
}

/// The bus does not know the undulation, the link does. Reports of the link already contain both heights.
TEST(StepTraffic, OfTheBusHoldsBothReadingsOfAGeometricHeight)
{
    using link::HeightSource;
    const auto track = [](HeightSource source, std::optional<std::int32_t> undulation, bool of_bus) {
        StepBench b({{Param::sigma_baro, 20.0F}, {Param::k_sigma, 2.0F}}, StepBench::Bus::there);
        b.wire.where = link::GlobalPosition{473977420, 85455940, 488000};
        b.fly(2);
        b.wire.above_ellipsoid = undulation;
        link::TrackReport r = b.track_report(1, Vec3(100.0F, 0.0F, 50.0F));
        r.height = source;
        (of_bus ? b.bus.tracks : b.wire.tracks).push_back(r);
        b.hear_own();
        b.step();
        const auto tracks = b.coprocessor.tracks(b.now);
        EXPECT_EQ(tracks.size(), 1U);
        return tracks.empty() ? world::Track{} : tracks[0];
    };
    for (const std::int32_t undulation : {48'000, -35'000}) {
        const world::Track t = track(HeightSource::geometric, undulation, true);
        EXPECT_NEAR(t.half_height, undulation > 0 ? 24.0F : 17.5F, 1e-3F);
        EXPECT_NEAR(t.position.z(), undulation > 0 ? 26.0F : 67.5F, 1e-3F);
    }
    for (const world::Track& t :
         {track(HeightSource::geometric, std::nullopt, true), track(HeightSource::geometric, 48'000, false)}) {
        EXPECT_EQ(t.half_height, 0.0F);
        EXPECT_NEAR(t.position.z(), 50.0F, 1e-3F);
    }
    const world::Track t = track(HeightSource::pressure, 48'000, true);
    EXPECT_EQ(t.half_height, 40.0F);
    EXPECT_NEAR(t.position.z(), 50.0F, 1e-3F);
}

TEST(StepTraffic, OwnTransponderIsNoTraffic)
{
    const auto tracks = [](float own, std::uint32_t id, Source source) {
        StepBench b({{Param::own_address, own}});
        b.hear_track(id, Vec3(100.0F, 0.0F, 50.0F)).source = source;
        b.fly(1);
        EXPECT_EQ(b.counted().own_heard + b.counted().tracks_in, 1U);
        EXPECT_EQ(b.counted().tracks_in, b.last.tracks);
        return b.last.tracks;
    };
    EXPECT_EQ(tracks(4711.0F, 4711, Source::adsb), 0U);
    EXPECT_EQ(tracks(4711.0F, 4712, Source::adsb), 1U);
    EXPECT_EQ(tracks(4711.0F, 4711, Source::datalink), 1U) << "an id of another scheme";
    EXPECT_EQ(tracks(0.0F, 0, Source::adsb), 1U) << "0: the own address is not known";
    StepBench b({{Param::own_address, 4711.0F}});
    b.hear_track(4711, Vec3(100.0F, 0.0F, 50.0F));
    b.hear_track(5, Vec3(120.0F, 0.0F, 50.0F));
    b.fly(1);
    EXPECT_EQ(b.last.tracks, 1U) << "what comes behind it counts";
}

TEST(StepTraffic, IsForgottenWhenNotHeardForLonger)
{
    StepBench b({{Param::track_latency, 0.0F}, {Param::track_age, 1.0F}});
    b.hear_track(1, Vec3(100.0F, 0.0F, 50.0F));
    b.fly(1);
    b.fly(50);
    EXPECT_EQ(b.last.tracks, 1U);
    b.fly(1);
    EXPECT_EQ(b.last.tracks, 0U);
}

}  // namespace
}  // namespace jink::app::test
