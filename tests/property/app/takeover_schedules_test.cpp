// SPDX-License-Identifier: BSD-3-Clause
// Who is in control, over random schedules: an autopilot with its own rules, a line with delays and losses, a pilot,
// and a witness that knows only the line's traffic. JINK_CASES sets the number of schedules (100 000), JINK_SEED the
// first one's seed.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>

#include "tests/property/app/takeover_world.hpp"

namespace jink::app {
namespace {

using namespace test;

std::uint64_t asked_for(const char* name, std::uint64_t normal)
{
    const char* text = std::getenv(name);
    return text != nullptr ? std::strtoull(text, nullptr, 0) : normal;
}

World random_world(Random& random)
{
    World w;
    w.px4 = random.below(2) == 0;
    w.serves = random.below(4) != 0;
    w.refuses = random.below(6) == 0;
    constexpr std::array kPeriods{kSecond, kSecond, kSecond, kSecond / 2, kSecond / 5};
    w.period = w.px4 ? kSecond : kPeriods[random.below(kPeriods.size())];
    w.latency = 1 + static_cast<int>(random.below(3));
    w.jitter = random.below(3) == 0 ? 1 + static_cast<int>(random.below(15)) : 0;
    constexpr std::array kLosses{0.0F, 0.0F, 0.02F, 0.2F, 0.6F};
    w.loss = kLosses[random.below(kLosses.size())];
    w.proof = w.px4 && random.below(2) == 0 ? kSecond : 0;
    w.phase = static_cast<int>(random.below(kSecond));
    return w;
}

/// Coverage of the schedules: a law over schedules without events proves nothing.
struct Tally {
    long taken = 0, given_back = 0, overruled = 0, refused = 0, lost = 0, sticks = 0, unfollowed = 0, held = 0;
    long pilots = 0, overridden = 0, unknowable = 0;

    void add(const Takeover& t)
    {
        const TakeoverDiagnostics& d = t.diagnostics();
        taken += d.taken;
        given_back += d.given_back;
        overruled += d.overruled;
        refused += d.refused;
        lost += d.lost_by_fault;
        sticks += d.sticks;
        unfollowed += d.unfollowed;
        held += d.held;
    }
};

class Schedule {
public:
    explicit Schedule(std::uint64_t seed) : random_(seed), world_(random_world(random_)) {}

    /// nullptr, or the broken rule and its time.
    [[nodiscard]] const char* run(int ticks, Tally& tally)
    {
        rest_ = random_.below(3) == 0 ? 25 : 120;
        for (tick_ = 0; tick_ < ticks; ++tick_) {
            machine_.hear(tick_);
            act_as_pilot(tally);
            machine_.step(tick_);
            if (const Overridden& o = machine_.overridden; o.known > 0) {
                ++tally.overridden;
                return "overrides a pilot whose mode was to be known";
            }
            const TakeoverInput input = receive();
            const TakeoverOutput out = takeover_.update(input, TimePoint{1'000'000 + tick_ * 20'000LL});
            witness_.sticks = witness_.sticks || (out.event == TakeoverEvent::sticks);
            if (const char* broken = witness_.check(out, takeover_, tick_, input.wants_control)) {
                return broken;
            }
            transmit(out);
            streamed_ = takeover_.streaming();
        }
        tally.add(takeover_);
        tally.unknowable += machine_.overridden.unknowable;
        return nullptr;
    }
    [[nodiscard]] int tick() const { return tick_; }

private:
    void act_as_pilot(Tally& tally)
    {
        if (random_.below(static_cast<std::uint64_t>(rest_) * 3U) != 0) {
            return;
        }
        constexpr std::array<std::uint32_t, 8> kChoices{kManual,   kManual,   kHold,     kMissionA,
                                                        kMissionA, kMissionB, kExternal, 0};
        const std::uint32_t choice = kChoices[random_.below(kChoices.size())];
        ++tally.pilots;
        if (choice == 0) {
            machine_.armed = !machine_.armed;
        } else {
            machine_.choose(choice, tick_);
        }
    }

    TakeoverInput receive()
    {
        if (random_.below(static_cast<std::uint64_t>(rest_)) == 0) {
            conflict_ = !conflict_;
        }
        fault_ =
            fault_ > 0
                ? fault_ - 1
                : (random_.below(600) == 0 ? static_cast<int>(1 + random_.below(random_.below(5) == 0 ? 600 : 60)) : 0);
        TakeoverInput input;
        input.wants_control = input.in_conflict = conflict_;
        input.may_act = fault_ == 0;
        input.urgent_hold = conflict_ && random_.below(3) == 0;
        input.stands_by = world_.phase % 4 != 0;
        input.sticks_moved = streamed_ && (sticks_ || random_.below(400) == 0);
        sticks_ = input.sticks_moved;
        input.unfollowed = random_.below(1500) == 0;
        Beat beat;
        beat_count_ = 0;
        while (machine_.beats.take(tick_, beat)) {
            witness_.hear(beat, tick_, takeover_.control());
            if (input.has_report && beat_count_ < earlier_.size()) {
                earlier_[beat_count_++] = report_;
            }
            input.has_report = true;
            report_.stack = world_.px4 ? link::AutopilotStack::px4 : link::AutopilotStack::ardupilot;
            report_.custom_mode = beat.number;
            report_.mode = meaning(beat.number);
            report_.armed = beat.armed;
        }
        input.report = report_;
        input.earlier = {earlier_.data(), beat_count_};
        bool accepted = false;
        while (machine_.answers.take(tick_, accepted)) {
            input.mode_accepted = input.mode_accepted || accepted;
            input.mode_denied = input.mode_denied || !accepted;
            witness_.accepted_at = accepted ? tick_ : kNever;  // an answer after it is the newer request's
        }
        return input;
    }

    void transmit(const TakeoverOutput& out)
    {
        Request request;
        request.action = out.action;
        request.number = out.action == TakeoverAction::request_external ? static_cast<std::uint32_t>(kExternal)
                         : out.action == TakeoverAction::request_hold   ? static_cast<std::uint32_t>(kHold)
                                                                        : takeover_.former_mode();
        request.poll = out.action == TakeoverAction::none;
        request.sent = tick_;
        if ((out.action != TakeoverAction::none || out.ask_heartbeat) && !machine_.lost()) {
            machine_.requests.send(request, machine_.later(tick_));
        }
        if (takeover_.streaming()) {
            machine_.hear_setpoint(tick_);
        }
    }

    Random random_;
    World world_;
    Machine machine_{world_, random_};
    Witness witness_{world_};
    Takeover takeover_;
    link::AutopilotReport report_;
    std::array<link::AutopilotReport, 16> earlier_;  ///< since the last tick
    std::size_t beat_count_ = 0;
    int rest_ = 100;  ///< mean time between changes of the conflict [ticks]
    int tick_ = 0;
    bool conflict_ = false;
    int fault_ = 0;
    bool streamed_ = false;
    bool sticks_ = false;
};

TEST(TakeoverSchedules, NoPilotIsOverriddenOnceKnown)
{
    const std::uint64_t cases = asked_for("JINK_CASES", 100'000);
    const std::uint64_t seed = asked_for("JINK_SEED", 20260724);
    Tally tally;
    std::uint64_t broken = 0;
    for (std::uint64_t i = 0; i < cases; ++i) {
        Schedule schedule(seed + i);
        const char* rule = schedule.run(300, tally);
        if (rule != nullptr && ++broken == 1) {
            ADD_FAILURE() << rule << " at tick " << schedule.tick() << "; JINK_CASES=1 JINK_SEED=" << seed + i;
        }
    }
    EXPECT_EQ(broken, 0U) << "of " << cases << " schedules";
    EXPECT_EQ(tally.overridden, 0);
    std::printf(
        "[ schedules] %llu: pilots overridden %ld, broken %llu; pilot acted %ld times, %ld times while a HEARTBEAT or "
        "request was on the line; taken %ld, given back %ld, overruled %ld, refused %ld, lost %ld, sticks %ld, "
        "unfollowed %ld, held %ld\n",
        static_cast<unsigned long long>(cases), tally.overridden, static_cast<unsigned long long>(broken), tally.pilots,
        tally.unknowable, tally.taken, tally.given_back, tally.overruled, tally.refused, tally.lost, tally.sticks,
        tally.unfollowed, tally.held);
    if (cases >= 1000) {
        EXPECT_GT(tally.taken, 0);
        EXPECT_GT(tally.given_back, 0);
        EXPECT_GT(tally.overruled, 0);
        EXPECT_GT(tally.refused, 0);
        EXPECT_GT(tally.lost, 0);
        EXPECT_GT(tally.sticks, 0);
        EXPECT_GT(tally.unfollowed, 0);
        EXPECT_GT(tally.held, 0);
    }
}

struct Times {
    int taken = kNever;  ///< ticks from the conflict until in control
    int back = kNever;   ///< ticks from its end until given back
};

/// A healthy line: a conflict begins at `begins` and lasts 5 s.
Times fly_once(const World& world, int begins, bool stands_by)
{
    Random random(1);
    Machine machine{world, random};
    Takeover takeover;
    link::AutopilotReport report;
    report.stack = world.px4 ? link::AutopilotStack::px4 : link::AutopilotStack::ardupilot;
    Times times;
    const int ends = begins + 5 * kSecond;
    for (int tick = 0; tick < ends + 5 * kSecond; ++tick) {
        machine.hear(tick);
        machine.step(tick);
        TakeoverInput input;
        Beat beat;
        while (machine.beats.take(tick, beat)) {
            input.has_report = true;
            report.custom_mode = beat.number;
            report.mode = meaning(beat.number);
            report.armed = true;
        }
        bool accepted = false;
        while (machine.answers.take(tick, accepted)) {
            input.mode_accepted = accepted;
            input.mode_denied = !accepted;
        }
        input.report = report;
        input.may_act = true;
        input.stands_by = stands_by;
        input.wants_control = input.in_conflict = tick >= begins && tick < ends;
        const TakeoverOutput out = takeover.update(input, TimePoint{1'000'000 + tick * 20'000LL});
        times.taken = out.event == TakeoverEvent::took_over ? tick - begins : times.taken;
        times.back = out.event == TakeoverEvent::gave_back ? tick - ends : times.back;
        if (takeover.streaming() || (takeover.proving() && tick % 10 == 0)) {
            machine.hear_setpoint(tick);
        }
        if (out.action != TakeoverAction::none || out.ask_heartbeat) {
            const std::uint32_t number = out.action == TakeoverAction::request_external
                                             ? static_cast<std::uint32_t>(kExternal)
                                             : takeover.former_mode();
            machine.requests.send({out.action, number, out.action == TakeoverAction::none}, machine.later(tick));
        }
    }
    return times;
}

/// How long it takes over all phases of the HEARTBEAT and latencies; ticks from the conflict on.
struct Spread {
    int latest = 0;
    int sum = 0;
    int flights = 0;
};

void fly_all(bool px4, bool serves, int proof, bool stands_by, Spread& spread)
{
    const auto seconds = [](int ticks) { return static_cast<float>(ticks) * kTickTime; };
    const float beat = serves || !px4 ? 0.0F : 1.0F;
    const float old_rule = px4 && proof > 0 && !stands_by ? (serves ? 1.3F : 2.3F) : 0.0F;
    const float limit = (serves ? 0.4F : 0.5F) + beat + old_rule;
    for (int latency = 1; latency <= 3; ++latency) {
        for (int phase = 0; phase < kSecond; ++phase) {
            World world;
            world.px4 = px4;
            world.serves = serves;
            world.proof = px4 ? proof : 0;
            world.latency = latency;
            world.phase = phase;
            SCOPED_TRACE(::testing::Message() << px4 << serves << proof << stands_by << ' ' << latency << ' ' << phase);
            const Times times = fly_once(world, 6 * kSecond, stands_by);
            ASSERT_GE(times.taken, 0);
            ASSERT_LE(seconds(times.taken), limit);
            ASSERT_GE(times.back, 0);
            ASSERT_LE(seconds(times.back), (serves ? 0.6F : 0.5F) + (serves ? 0.0F : 1.0F) + beat);
            spread.latest = std::max(spread.latest, times.taken);
            spread.sum += times.taken;
            ++spread.flights;
        }
    }
}

/// Every phase of the HEARTBEAT, latency and stack. A line that does not answer waits for kAnswer, and a PX4's 1 Hz for
/// the confirmation. Standing by, nothing is waited for but the line, twice.
TEST(TakeoverSchedules, ControlIsTakenAndGivenBackInTimeOnAHealthyLine)
{
    for (const bool px4 : {false, true}) {
        for (const bool serves : {true, false}) {
            for (const int proof : {0, kSecond}) {
                std::array<Spread, 2> spread;
                for (const bool stands_by : {false, true}) {
                    Spread& s = spread[stands_by ? 1 : 0];
                    fly_all(px4, serves, proof, stands_by, s);
                    std::printf(
                        "[ taken     ] %s, 1 Hz, %s, stream of %.0f s wanted, %s: after %.3f s on average, %.2f s "
                        "at most\n",
                        px4 ? "PX4" : "ArduPilot", serves ? "requests of HEARTBEATs served" : "not served",
                        static_cast<double>(proof) / kSecond, stands_by ? "standing by" : "not prepared",
                        static_cast<double>(s.sum) * 0.02 / s.flights, static_cast<double>(s.latest) * 0.02);
                }
                EXPECT_LE(spread[1].sum, spread[0].sum);
            }
        }
    }
}

}  // namespace
}  // namespace jink::app
