// SPDX-License-Identifier: BSD-3-Clause
// Frames of recorded streams cut, dropped and duplicated at random: 3 s later every belief is the undisturbed one
// again. JINK_CASES and JINK_SEED are taken.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <iostream>
#include <random>

#include "tests/replay/recording.hpp"

namespace jink::replay_test {
namespace {

/// Beliefs are right again this long after a disturbance has ended [s].
constexpr double kRecovery = 3.0;
/// From the start of a disturbance to the next [s]: recovery, the longest disturbance, one second of observation.
constexpr double kBetween = 5.0;
constexpr double kLongest = 0.5;
/// Frames are repeated as a block of at most this length [s]. Longer ones appear as a restarted boot clock
/// (ClockSync::kJump).
constexpr double kLongestRepeat = 0.15;
/// ArduPilot sends home every 5 s (as jink asks): one that was lost is missed for so long [s].
constexpr double kHomePeriod = 5.5;

enum class Kind { cut, drop, duplicate };

struct Disturbance {
    Kind kind = Kind::drop;
    double begin = 0.0;
    double end = 0.0;
};

std::uint64_t number(const char* name, std::uint64_t otherwise)
{
    const char* const text = std::getenv(name);
    return text != nullptr ? std::strtoull(text, nullptr, 10) : otherwise;
}

struct Piece {
    double time = 0.0;
    std::vector<std::byte> bytes;
};

/// The frames of a recording as the line would bring them with these disturbances.
std::vector<Piece> disturbed(const Recording& recording, const std::vector<Disturbance>& list, std::mt19937_64& random)
{
    std::vector<Piece> out;
    std::vector<Piece> again;
    std::size_t next = 0;
    for (const RawFrame& frame : recording.frames) {
        for (; next < list.size() && frame.time >= list[next].end; ++next) {
            for (Piece& piece : again) {
                piece.time = list[next].end;
                out.push_back(piece);
            }
            again.clear();
        }
        Piece piece{frame.time, frame.bytes};
        if (next < list.size() && frame.time >= list[next].begin) {
            switch (list[next].kind) {
            case Kind::drop: continue;
            case Kind::cut: {
                const std::size_t from = random() % piece.bytes.size();
                const std::size_t n = 1 + random() % (piece.bytes.size() - from);
                const auto at = piece.bytes.begin() + static_cast<std::ptrdiff_t>(from);
                piece.bytes.erase(at, at + static_cast<std::ptrdiff_t>(n));
                break;
            }
            case Kind::duplicate: again.push_back(piece); break;
            }
        }
        out.push_back(piece);
    }
    return out;
}

std::vector<sim::Belief> replayed(const Recording& recording, const std::vector<Piece>& pieces)
{
    std::vector<sim::WireRecord> records = recording.wire.records;
    std::erase_if(records, [](const sim::WireRecord& r) { return r.direction == sim::WireDirection::from_autopilot; });
    const std::int64_t start = sim::clock_start_of(records);
    const auto run = std::make_unique<sim::Replay>(app::Parameters(), start, sim::RecordedMission(records));
    std::vector<sim::Belief> beliefs;
    std::size_t next = 0;
    const sim::Micros end = sim::to_micros(recording.wire.records.back().time);
    for (sim::Micros now = 0; now <= end; now += sim::Replay::kStep) {
        for (; next < pieces.size() && sim::to_micros(pieces[next].time) <= now; ++next) {
            run->feed(sim::to_micros(pieces[next].time), pieces[next].bytes);
        }
        run->step(now);
        if (now > 0 && now % sim::kSecond == 0) {
            beliefs.push_back(run->belief());
        }
    }
    return beliefs;
}

bool near(const std::optional<sim::Vec>& a, const std::optional<sim::Vec>& b, double tolerance)
{
    return a.has_value() == b.has_value() && (!a || (*a - *b).norm() <= tolerance);
}

bool same_home(const std::optional<sim::Globe>& a, const std::optional<sim::Globe>& b)
{
    constexpr double kDegree = 3e-7;
    return a.has_value() == b.has_value() &&
           (!a || (std::abs(a->lat - b->lat) < kDegree && std::abs(a->lon - b->lon) < kDegree &&
                   std::abs(a->alt - b->alt) < 0.05));
}

/// Home now, or before a possibly lost message.
bool home_is_right(const sim::Belief& belief, const std::vector<sim::Belief>& undisturbed, std::size_t i)
{
    for (std::size_t k = i; undisturbed[i].time - undisturbed[k].time <= kHomePeriod; --k) {
        if (same_home(belief.home, undisturbed[k].home)) {
            return true;
        }
        if (k == 0) {
            return !belief.home;
        }
    }
    return false;
}

/// The fault; empty: none. Nominal paths are not compared: a recording does not repeat lost mission items.
std::string fault_of(const sim::Belief& belief, const std::vector<sim::Belief>& undisturbed, std::size_t i)
{
    const sim::Belief& right = undisturbed[i];
    constexpr double kSamePlace = 0.3;     // [m]
    constexpr double kSameVelocity = 0.3;  // [m/s]
    if (belief.stack != right.stack || belief.vehicle != right.vehicle) {
        return "stack or vehicle";
    }
    if (belief.mode != right.mode || belief.armed != right.armed) {
        return "mode " + belief.mode.value_or("none") + " for " + right.mode.value_or("none");
    }
    if (!near(belief.position, right.position, kSamePlace)) {
        return std::string("position ") + (belief.position ? "wrong" : "not known");
    }
    if (!near(belief.velocity, right.velocity, kSameVelocity)) {
        return "velocity";
    }
    if (!home_is_right(belief, undisturbed, i)) {
        return "home";
    }
    if (belief.tracks != right.tracks) {
        return "tracks " + std::to_string(belief.tracks) + " for " + std::to_string(right.tracks);
    }
    const bool external = belief.mode == "GUIDED" || belief.mode == "OFFBOARD";
    if ((belief.control == "ours" || belief.control == "returning") && !external) {
        return "control";
    }
    return "";
}

/// One pass over a recording with a disturbance every kBetween. @return how many
unsigned disturb(const Recording& recording, std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    std::vector<Disturbance> list;
    for (double t = 3.0 + uniform(random); t + kBetween < recording.wire.records.back().time; t += kBetween) {
        const double begin = t + uniform(random) * 0.5;
        const Kind kind = static_cast<Kind>(random() % 3);
        const double longest = kind == Kind::duplicate ? kLongestRepeat : kLongest;
        list.push_back({kind, begin, begin + uniform(random) * longest});
    }
    const std::vector<Piece> pieces = disturbed(recording, list, random);
    const std::vector<sim::Belief> beliefs = replayed(recording, pieces);
    const std::vector<sim::Belief>& undisturbed = beliefs_of(recording);
    for (std::size_t i = 0; i < beliefs.size() && i < undisturbed.size(); ++i) {
        const double t = beliefs[i].time;
        const Disturbance* before = nullptr;
        const Disturbance* after = nullptr;
        for (const Disturbance& d : list) {
            before = d.end <= t ? &d : before;
            after = after == nullptr && d.end > t ? &d : after;
        }
        const bool settled =
            (before == nullptr || t - before->end >= kRecovery) && (after == nullptr || after->begin > t);
        if (!settled) {
            continue;
        }
        const std::string fault = fault_of(beliefs[i], undisturbed, i);
        static const char* const kNames[] = {"cut", "drop", "duplicate"};
        EXPECT_EQ(fault, "") << recording.name << " at " << t << " s, after a "
                             << (before != nullptr ? kNames[static_cast<int>(before->kind)] : "start") << " of "
                             << (before != nullptr ? before->begin : 0.0) << " to "
                             << (before != nullptr ? before->end : 0.0) << " s, JINK_SEED=" << seed;
    }
    return static_cast<unsigned>(list.size());
}

TEST(RecordingsDisturbed, BeliefsAreRightAgainThreeSecondsAfterCutsDropsAndDuplicates)
{
    const std::uint64_t cases = number("JINK_CASES", 300);
    const std::uint64_t first = number("JINK_SEED", 1);
    std::uint64_t done = 0;
    for (std::uint64_t seed = first; done < cases; ++seed) {
        const std::string& name = recording_names()[seed % recording_names().size()];
        const Recording* const recording = find_recording(name);
        if (recording == nullptr) {
            GTEST_SKIP() << name << " is not part of this repository; say with JINK_RECORDINGS where it is";
        }
        done += disturb(*recording, seed);
    }
    std::cout << done << " disturbances, seeds from " << first << "\n";
}

}  // namespace
}  // namespace jink::replay_test
