// SPDX-License-Identifier: BSD-3-Clause
// For any losses, duplicates and delays of the line: no request that PX4 answers with a text to the pilot, and no leg
// other than the flown leg.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include <gtest/gtest.h>

#include "firmware/link/mavlink/endpoint.hpp"
#include "tests/property/link/mission_servers.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;

constexpr double kTick = 0.02;
constexpr double kNever = 1e9;
/// MISSION_CURRENT comes every 0.5 s; until then the number is that of the mission before.
constexpr double kAnnouncing = 0.8;
constexpr double kRandomTime = 40.0;
constexpr double kQuietTime = 16.0;

std::uint64_t mission_seed()
{
    const char* const given = std::getenv("JINK_SEED");
    return given != nullptr ? std::strtoull(given, nullptr, 0) : 20261124;
}
int mission_cases(int usual)
{
    const char* const given = std::getenv("JINK_CASES");
    return given != nullptr ? std::max(1, std::atoi(given)) : usual;
}

struct Believed {
    bool known = false;
    ItemName item{};
};

template <class Server>
struct Talk {
    Talk(std::uint64_t seed, bool lossy, bool px4) : random(seed), is_px4(px4), server(down, random)
    {
        if (lossy) {
            up.loss = down.loss = random.uniform(0.0F, 0.25F);
            up.slowest = down.slowest = random.uniform(0.02F, 0.7F);
            down.doubles = random.uniform(0.0F, 0.2F);
        }
        server.replace(3 + random.below(12));
    }
    void beat()
    {
        if (now - beat_ >= 1.0) {
            beat_ = now;
            Heartbeat m;
            m.autopilot = is_px4 ? 12 : 3;
            m.type = 2;
            m.base_mode = 0x81;
            m.custom_mode = is_px4 ? (4U << 16U) | (4U << 24U) : 3;
            server.say(m, now);
        }
        if (now - placed_ >= 0.1) {
            placed_ = now;
            LocalPositionNed m;
            m.time_boot_ms = static_cast<std::uint32_t>(now * 1e3);
            m.x = -500.0F;
            m.z = -30.0F;
            server.say(m, now);
        }
    }
    /// One tick of both sides.
    void step()
    {
        now += kTick;
        beat();
        server.tick(now);
        while (const auto arrived = up.take(now)) {
            for (const Received& frame : parse(server_ears, arrived->bytes)) {
                server.hear(frame, arrived->sent, now);
            }
        }
        inbox.clear();
        const TimePoint time{static_cast<std::int64_t>(now * 1e6)};
        while (const auto arrived = down.take(now)) {
            note(arrived->bytes);
            endpoint.receive(arrived->bytes, time, inbox);
        }
        endpoint.service(time);
        for (const Received& frame : parse(our_ears, endpoint.pending())) {
            up.send(again(frame), now, random);
        }
        endpoint.consume(endpoint.pending().size());
        believe();
    }
    static Bytes again(const Received& frame)
    {
        RawFrame raw;
        raw.id = frame.message_id;
        raw.header = frame.header;
        raw.payload = Bytes(frame.payload.begin(), frame.payload.begin() + frame.length);
        raw.crc_extra = find_message(frame.message_id)->crc_extra;
        return raw.bytes();
    }
    /// The information on partner and mission that the endpoint could have received.
    void note(const Bytes& bytes)
    {
        for (const Received& frame : parse(note_ears, bytes)) {
            MissionCurrent current;
            MissionCount count;
            MissionItemInt item;
            MissionRequestInt request;
            if (decode(frame.frame(), current)) {
                announced.push_back({now, current.mission_id});
                announced_sequence = current.seq;
            } else if ((decode(frame.frame(), count) && count.target_system == kStation) ||
                       (decode(frame.frame(), item) && item.target_system == kStation) ||
                       (decode(frame.frame(), request) && request.target_system == kStation)) {
                station_seen = std::min(station_seen, now);
            }
        }
    }
    void believe()
    {
        if (inbox.leg_lost) {
            believed.known = false;
        }
        if (inbox.has_leg) {
            const int number = static_cast<int>(std::lround(inbox.leg.leg.end.y()));
            believed = {true, {number / 100, number % 100}};
        }
        truths.push_back({now, server.truth(is_px4 ? 0 : 1)});
        there_ += truths.back().second ? 1 : 0;
        known_ += truths.back().second && believed.known ? 1 : 0;
    }
    [[nodiscard]] double known_share() const { return static_cast<double>(known_) / std::max(1, there_); }
    /// Whether the belief was true at some time in the last `age` seconds.
    [[nodiscard]] bool was_true(double age) const
    {
        for (auto i = truths.rbegin(); i != truths.rend() && now - i->first <= age; ++i) {
            if (i->second == believed.item) {
                return true;
            }
        }
        return !believed.known;
    }
    /// Whether the belief is an item of a true mission, under the last announced number: if an announcement is lost,
    /// the previous one stays valid.
    [[nodiscard]] bool is_as_announced(int first_item) const
    {
        return server.goal_of(believed.item.first, announced_sequence, first_item) == believed.item;
    }
    [[nodiscard]] std::uint32_t announced_at(double when) const
    {
        std::uint32_t id = 0;
        for (const auto& [at, announced_id] : announced) {
            id = at <= when ? announced_id : id;
        }
        return id;
    }
    void calm()
    {
        up.loss = down.loss = down.doubles = 0.0F;
        up.slowest = down.slowest = 0.05F;
    }

    Random random;
    bool is_px4;
    LossyLine up, down;
    Server server;
    Endpoint endpoint;
    Inbox inbox;
    Parser server_ears, our_ears, note_ears;
    double now = 100.0;
    double station_seen = kNever;  ///< when the endpoint first heard of the last transfer of the station
    Believed believed;
    std::uint16_t announced_sequence = 0;
    std::vector<std::pair<double, std::optional<ItemName>>> truths;
    std::vector<std::pair<double, std::uint32_t>> announced;

private:
    double beat_ = 0.0;
    double placed_ = 0.0;
    int there_ = 0;
    int known_ = 0;
};

std::string replay_with(std::uint64_t seed) { return "JINK_CASES=1 JINK_SEED=" + std::to_string(seed); }

/// @return share of the time in which the leg was known, of that in which there was one
double fly_px4(std::uint64_t seed, bool lossy)
{
    SCOPED_TRACE(replay_with(seed));
    const auto talk = std::make_unique<Talk<Px4Server>>(seed, lossy, true);
    Talk<Px4Server>& t = *talk;
    std::size_t beyond = 0;
    std::size_t mismatches = 0;
    double stations = -100.0;
    const double end = t.now + kRandomTime;
    while (t.now < end + kQuietTime) {
        const bool random = t.now < end;
        if (random && t.random.below(500) == 0) {
            t.server.replace(1 + t.random.below(14));
        } else if (random && t.random.below(150) == 0) {
            t.server.current = static_cast<std::uint16_t>(t.random.below(t.server.mission.size()));
        } else if (random && t.now < end - 10.0 && t.random.below(1000) == 0) {
            if (t.random.below(2) == 0) {
                t.server.station_reads(t.now);
            } else {
                t.server.station_writes(1 + t.random.below(14), t.now);
            }
            t.station_seen = kNever;
            stations = t.now;
        } else if (random && lossy && t.random.below(500) == 0) {
            t.up.free_at = t.down.free_at = t.now + t.random.uniform(0.0F, 3.0F);
        }
        if (!random) {
            t.calm();
        }
        t.step();
        EXPECT_EQ(t.server.texts.out_of_order, 0) << "Req. WP was unexpected";
        for (; beyond < t.server.texts.beyond_count.size(); ++beyond) {
            EXPECT_NE(t.announced_at(t.server.texts.beyond_count[beyond]), t.server.id()) << "it had been announced";
        }
        for (; mismatches < t.server.texts.not_partner.size(); ++mismatches) {
            EXPECT_LT(t.server.texts.not_partner[mismatches], t.station_seen + kTick)
                << "it was seen to talk to another";
            EXPECT_GT(stations, 0.0);
        }
        EXPECT_TRUE(t.was_true(lossy ? 1000.0 : 1.5))
            << "version " << t.believed.item.first << " item " << t.believed.item.second << " at " << t.now;
        if (::testing::Test::HasFailure()) {
            return 0.0;
        }
    }
    if (!lossy && stations < 0.0) {
        EXPECT_EQ(t.server.texts.timeout, 0) << "Operation timeout";
    }
    const auto truth = t.server.truth(0);
    EXPECT_EQ(t.believed.known, truth.has_value());
    EXPECT_TRUE(!truth || t.believed.item == *truth) << "right again once the line is";
    return t.known_share();
}

double fly_ardupilot(std::uint64_t seed, bool lossy)
{
    SCOPED_TRACE(replay_with(seed));
    const auto talk = std::make_unique<Talk<ArduPilotServer>>(seed, lossy, false);
    Talk<ArduPilotServer>& t = *talk;
    const double end = t.now + kRandomTime;
    std::size_t uploads = 0;
    double replaced = 0.0;
    while (t.now < end + kQuietTime) {
        const bool random = t.now < end;
        const bool receiving = t.now < t.server.receiving_until;
        if (uploads > 0 && !receiving) {
            t.server.replace(uploads);
            replaced = t.now;
            t.server.current = static_cast<std::uint16_t>(t.random.below(uploads));
            uploads = 0;
        } else if (random && uploads == 0 && t.random.below(400) == 0) {
            const bool same_length = t.random.below(4) != 0;
            uploads = same_length ? t.server.mission.size() : 2 + t.random.below(14);
            t.server.receiving_until = t.now + t.random.uniform(0.0F, 2.0F);
        } else if (random && t.random.below(150) == 0) {
            t.server.current = static_cast<std::uint16_t>(t.random.below(t.server.mission.size()));
        } else if (random && lossy && t.random.below(500) == 0) {
            t.up.free_at = t.down.free_at = t.now + t.random.uniform(0.0F, 3.0F);
        }
        if (!random) {
            t.calm();
        }
        t.step();
        EXPECT_TRUE(t.was_true(lossy ? 1000.0 : 6.0) ||
                    ((lossy || t.now - replaced < kAnnouncing) && t.is_as_announced(1)))
            << "version " << t.believed.item.first << " item " << t.believed.item.second << " at " << t.now;
        if (::testing::Test::HasFailure()) {
            return 0.0;
        }
    }
    const auto truth = t.server.truth(1);
    EXPECT_EQ(t.believed.known, truth.has_value());
    EXPECT_TRUE(!truth || t.believed.item == *truth) << "right again once the line is";
    return t.known_share();
}

/// Flies each seed on a good line and on a bad one.
template <class Fly>
void fly_all(Fly fly)
{
    const int n = mission_cases(16);
    double known = 0.0;
    for (int i = 0; i < n && !::testing::Test::HasFailure(); ++i) {
        known += fly(mission_seed() + static_cast<std::uint64_t>(i), false);
        static_cast<void>(fly(mission_seed() + static_cast<std::uint64_t>(i), true));
    }
    if (n >= 8) {
        EXPECT_GT(known / n, 0.5) << "not known is right too often";
    }
}

TEST(MavlinkMissionProperty, Px4NeverSaysThatARequestWasUnexpectedAndTheLegIsTheOneFlown) { fly_all(fly_px4); }
TEST(MavlinkMissionProperty, ArduPilotsLegIsTheOneFlownThoughItAnnouncesNoId) { fly_all(fly_ardupilot); }

}  // namespace
}  // namespace jink::link::mavlink
