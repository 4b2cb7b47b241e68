// SPDX-License-Identifier: BSD-3-Clause
// One whole tick, bytes in to bytes out: Coprocessor::step with 32 tracks, quiet and in conflict.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/base/random.hpp"
#include "firmware/app/coprocessor.hpp"
#include "firmware/link/mavlink/endpoint.hpp"

namespace {

using namespace jink;
using namespace jink::link::mavlink;

/// Serves prepared bytes and discards output.
class BenchPort final : public hal::SerialPort {
public:
    std::size_t read(std::span<std::byte> into) noexcept override
    {
        const std::size_t n = std::min(into.size(), waiting_.size());
        std::copy_n(waiting_.begin(), n, into.begin());
        waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(n));
        return n;
    }
    std::size_t write(std::span<const std::byte> from) noexcept override { return from.size(); }
    hal::PortHealth health() const noexcept override
    {
        hal::PortHealth health;
        health.state = hal::PortState::open;
        return health;
    }

    template <class M>
    void feed(const M& message)
    {
        std::array<std::byte, kMaxFrame> frame{};
        const std::size_t n = encode(message, {1, 1, sequence_++}, frame);
        waiting_.insert(waiting_.end(), frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(n));
    }

private:
    std::vector<std::byte> waiting_;
    std::uint8_t sequence_ = 0;
};

class NoWatchdog final : public hal::Watchdog {
public:
    void feed() noexcept override {}
};

/// An autopilot on a mission at 5 m/s, and traffic all around it.
class Bench {
public:
    /// `ahead` [m]: 0 for no conflict.
    explicit Bench(float ahead) : ahead_(ahead), coprocessor_(endpoint_, port_, watchdog_, app::Parameters{})
    {
        GpsGlobalOrigin origin;
        origin.latitude = 470000000;
        origin.longitude = 80000000;
        beat();
        port_.feed(origin);
        for (int i = 0; i < 100; ++i) {
            tick();
        }
    }

    app::StepReport tick()
    {
        now_.us += 20'000;
        ++ticks_;
        if (ticks_ % 50 == 0) {
            beat();
        }
        LocalPositionNed own;
        own.time_boot_ms = static_cast<std::uint32_t>(now_.us / 1000);
        own.z = -50.0F;
        own.vx = 5.0F;  // northwards
        port_.feed(own);
        if (ticks_ % 10 == 0) {
            for (std::uint32_t id = 1; id <= kMaxTracks; ++id) {
                port_.feed(traffic(id));
            }
        }
        return coprocessor_.step(now_);
    }

    const app::Coprocessor& coprocessor() const { return coprocessor_; }

private:
    void beat()
    {
        Heartbeat m;
        m.type = 2;
        m.autopilot = 3;
        m.base_mode = 129;
        m.custom_mode = 5;  // LOITER: the co-processor plans and advises in every tick, without taking over
        port_.feed(m);
    }

    AdsbVehicle traffic(std::uint32_t id) const
    {
        // In conflict: all of them come head-on through a gate 30 m wide. Quiet: flying off on a ring of 120 m.
        Random random(id);
        const float angle = random.uniform(0.0F, 2.0F * kPi);
        const bool conflicting = ahead_ > 0.0F;
        const Vec3 where = conflicting
                               ? Vec3(random.uniform(-15.0F, 15.0F), ahead_, 50.0F + random.uniform(-8.0F, 8.0F))
                               : Vec3(120.0F * std::cos(angle), 120.0F * std::sin(angle), 50.0F);
        const GlobalPosition global = to_global(where, {470000000, 80000000, 0}).value();
        AdsbVehicle m;
        m.ICAO_address = id;
        // Never the same place twice running: an aircraft that says it moves and does not is a repetition.
        m.lat = global.lat + static_cast<std::int32_t>(ticks_ / 10 % 2);
        m.lon = global.lon;
        m.altitude = global.alt;
        m.flags = 1 | 2 | 4 | 8 | 128;
        m.hor_velocity = 300;
        m.heading =
            conflicting ? 18000 : static_cast<std::uint16_t>(std::fmod(450.0F - angle * 180.0F / kPi, 360.0F) * 100.0F);
        return m;
    }

    float ahead_;
    TimePoint now_{1'000'000};
    int ticks_ = 0;
    BenchPort port_;
    NoWatchdog watchdog_;
    Endpoint endpoint_;
    app::Coprocessor coprocessor_;
};

void step(benchmark::State& state, float ahead)
{
    const auto bench = std::make_unique<Bench>(ahead);
    std::size_t tracks = 0;
    std::size_t fallbacks = 0;
    for (auto _ : state) {
        const app::StepReport report = bench->tick();
        tracks = report.tracks;
        fallbacks += report.guidance.wants_control && report.guidance.plan_status != world::PlanStatus::found ? 1U : 0U;
        benchmark::DoNotOptimize(report.guidance.velocity.x());
    }
    state.counters["tracks"] = static_cast<double>(tracks);
    state.counters["fallbacks_per_step"] = static_cast<double>(fallbacks) / static_cast<double>(state.iterations());
    state.counters["plans_per_step"] = static_cast<double>(bench->coprocessor().supervisor_diagnostics().plans) /
                                       static_cast<double>(bench->coprocessor().diagnostics().steps);
    state.counters["most_work"] = bench->coprocessor().supervisor_diagnostics().most_work;
}

BENCHMARK_CAPTURE(step, quiet, 0.0F)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(step, planning_every_tick, 35.0F)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(step, plan_and_fallback_every_tick, 14.0F)->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
