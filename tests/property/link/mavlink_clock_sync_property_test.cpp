// SPDX-License-Identifier: BSD-3-Clause
// The clock map over lines and readers that stall at random, and restarts: against the clock that was simulated.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <optional>

#include "core/base/random.hpp"
#include "firmware/link/mavlink/clock_sync.hpp"

namespace jink::link::mavlink {
namespace {

constexpr std::int64_t kMilli = 1'000;
constexpr std::int64_t kSecond = 1'000'000;
constexpr std::uint64_t kRuns = 400;

/// An autopilot that sends 10 stamps a second and answers TIMESYNC, a line that keeps the order, and a reader that
/// takes the clock after it has read. All delays at random; stalls of 0.1 to 10 s of either direction or the reader.
class StallingLine {
public:
    explicit StallingLine(std::uint64_t seed) : random_(seed)
    {
        boot_ = -static_cast<std::int64_t>(random_.below(3'000'000'000));
        drift_ppm_ = static_cast<std::int64_t>(random_.below(201)) - 100;
    }

    [[nodiscard]] std::int64_t remote(std::int64_t t) const { return t - boot_ + (t - boot_) * drift_ppm_ / kSecond; }
    void restart(std::int64_t t) { boot_ = t; }
    void stall_at_random(std::int64_t t)
    {
        const std::int64_t until = t + 100 * kMilli + below(9'900 * kMilli);
        switch (random_.below(4)) {
        case 0: in_blocked_ = std::max(in_blocked_, until); break;
        case 1: out_blocked_ = std::max(out_blocked_, until); break;
        case 2: in_blocked_ = out_blocked_ = std::max({in_blocked_, out_blocked_, until}); break;
        default: reader_blocked_ = std::max(reader_blocked_, until); break;
        }
    }
    [[nodiscard]] bool is_quiet(std::int64_t t) const
    {
        return t > std::max({in_blocked_, out_blocked_, reader_blocked_}) + 2 * kSecond;
    }
    /// Time at which bytes sent at `t` are read; non-decreasing in `t`.
    [[nodiscard]] std::int64_t arrival(std::int64_t t)
    {
        last_in_ = std::max({last_in_, t + jitter(), in_blocked_, reader_blocked_});
        return last_in_;
    }
    [[nodiscard]] std::int64_t arrival_there(std::int64_t t)
    {
        last_out_ = std::max({last_out_, t + jitter(), out_blocked_});
        return last_out_;
    }
    [[nodiscard]] std::int64_t below(std::int64_t n)
    {
        return static_cast<std::int64_t>(random_.below(static_cast<std::uint64_t>(n)));
    }

private:
    [[nodiscard]] std::int64_t jitter() { return 500 + below(random_.below(20) == 0 ? 80 * kMilli : 10 * kMilli); }

    Random random_;
    std::int64_t boot_ = 0;
    std::int64_t drift_ppm_ = 0;
    std::int64_t in_blocked_ = 0, out_blocked_ = 0, reader_blocked_ = 0;
    std::int64_t last_in_ = 0, last_out_ = 0;
};

struct Outcome {
    int restarts_seen = 0;
    std::int64_t seen_at = 0;
    std::int64_t worst_error = 0;  ///< of the map in quiet stretches [us]
};

/// 90 s; with `restart_at` > 0 the autopilot restarts then, and is silent for `away`.
Outcome run(StallingLine& line, bool answers, bool stalls, std::int64_t restart_at, std::int64_t away)
{
    ClockSync clock;
    Outcome out;
    const auto note = [&](ClockEvent event, std::int64_t t) {
        if (event == ClockEvent::relocked_backward) {
            ++out.restarts_seen;
            out.seen_at = t;
        }
    };
    constexpr std::int64_t kStart = 1'000 * kSecond;
    bool restarted = false;
    for (std::int64_t t = kStart; t < kStart + 90 * kSecond; t += 100 * kMilli) {
        const std::int64_t since = t - kStart;
        if (restart_at > 0 && since >= restart_at && since < restart_at + away) {
            if (!restarted) {
                line.restart(t + away / 2);
                restarted = true;
            }
            continue;
        }
        if (stalls && line.below(100) == 0) {
            line.stall_at_random(t);
        }
        // Events in the order of arrival: the answer to an earlier request may come between, never a later stamp.
        const std::int64_t stamp = line.remote(t);
        const std::int64_t arrived = line.arrival(t);
        note(clock.one_way(clock.extend(static_cast<std::uint32_t>(stamp / 1000), arrived), arrived), arrived);
        if (answers && since % kSecond == 0) {
            const std::int64_t there = line.arrival_there(t);
            const std::int64_t back = line.arrival(std::max(there, t));
            note(clock.round_trip(t, line.remote(there), back), back);
        }
        if (line.is_quiet(t) && since > 5 * kSecond && (restart_at == 0 || since < restart_at)) {
            const std::optional<std::int64_t> mapped = clock.to_local(stamp);
            EXPECT_TRUE(mapped.has_value());
            out.worst_error = std::max(out.worst_error, std::abs(mapped.value_or(0) - t));
        }
    }
    return out;
}

TEST(MavlinkClockSyncLaws, AStallIsNeverARestart)
{
    constexpr std::uint64_t kSeed = 20261124;
    for (std::uint64_t i = 0; i < kRuns; ++i) {
        StallingLine line(kSeed + i);
        const Outcome out = run(line, i % 4 != 0, true, 0, 0);
        ASSERT_EQ(out.restarts_seen, 0) << "seed " << kSeed + i;
        // Half a round trip of 0.1 s, or the least one-way delay; slow round trips are replaced within 2 s of quiet.
        ASSERT_LT(out.worst_error, 100 * kMilli) << "seed " << kSeed + i;
    }
}

TEST(MavlinkClockSyncLaws, ARestartIsSeenOnceAndInTime)
{
    constexpr std::uint64_t kSeed = 7;
    for (std::uint64_t i = 0; i < kRuns; ++i) {
        StallingLine line(kSeed + i);
        const bool answers = i % 4 != 0;
        const std::int64_t at = (10 + line.below(40)) * kSecond;
        const std::int64_t away = kSecond + line.below(20 * kSecond) / (100 * kMilli) * (100 * kMilli);
        const Outcome out = run(line, answers, false, at, away);
        ASSERT_EQ(out.restarts_seen, 1) << "seed " << kSeed + i;
        ASSERT_LE(out.seen_at, 1'000 * kSecond + at + away + 4'500 * kMilli) << "seed " << kSeed + i;
    }
}

}  // namespace
}  // namespace jink::link::mavlink
