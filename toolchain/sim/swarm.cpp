// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/swarm.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include "hal/memory/counting_watchdog.hpp"
#include "hal/memory/manual_clock.hpp"
#include "toolchain/sim/bench.hpp"
#include "toolchain/sim/cable.hpp"

namespace jink::sim {
namespace {

constexpr Micros kNotePeriod = kSecond / 10;
constexpr Micros kSettled = 2 * kSecond;
/// At the goal within this distance, en route beyond it [m].
constexpr double kAtGoal = 0.5;
/// Below this share of the cruise speed a vehicle counts as stopped.
constexpr double kStands = 0.1;

/// FNV-1a, 64 bits.
void mix(std::uint64_t& digest, double value)
{
    constexpr std::uint64_t kPrime = 1099511628211U;
    digest = (digest ^ std::bit_cast<std::uint64_t>(value)) * kPrime;
}

/// One vehicle's co-processor and its cable. Each co-processor has its own clock with its own start time.
struct Station {
    Station(const SwarmSetup& setup, std::uint64_t seed, std::size_t index, const app::Parameters& parameters)
        : start(static_cast<std::int64_t>(1'234'567'890 + 1'000'003 * index)), clock(start),
          cable(clock, seed, Timing{}), bench(cable.port(), watchdog, bench_setup(index, parameters, setup.board)),
          ticks(timing(setup, seed, index))
    {
    }
    static BenchSetup bench_setup(std::size_t index, const app::Parameters& parameters, const Board& board)
    {
        BenchSetup bench;
        bench.parameters = parameters;
        bench.board = board;
        bench.system = static_cast<std::uint8_t>(index + 1);
        return bench;
    }
    static Timing timing(const SwarmSetup& setup, std::uint64_t seed, std::size_t index)
    {
        constexpr std::uint64_t kTick = 20'000;
        Random random(seed * 15485863U + index + setup.vehicles);
        Timing timing;
        timing.first_tick = static_cast<Micros>(random.below(kTick));
        return timing;
    }
    void go_to(Micros flown) { clock.advance(start + flown - clock.now_us()); }
    /// Carries the plant's bytes and runs the co-processor's steps up to now.
    bool serve(Plant& plant)
    {
        const bool carried = cable.write(plant.collect());
        for (; ticks.next() <= plant.now(); ticks.begin()) {
            go_to(ticks.next());
            bench.step({clock.now_us()});
        }
        go_to(plant.now());
        return carried;
    }

    std::int64_t start;
    hal::ManualClock clock;
    hal::CountingWatchdog watchdog;
    Cable cable;
    Bench bench;
    Ticks ticks;
};

}  // namespace

Swarm::Swarm(const SwarmSetup& setup, std::uint64_t seed)
    : setup_(setup), radio_(setup.vehicles, setup.loss, to_micros(setup.delay), seed * 32452843U + 7U)
{
    if (setup.vehicles < 2 || setup.vehicles > kMaxTracks) {
        throw std::runtime_error("a swarm has 2 to " + std::to_string(kMaxTracks) + " vehicles");
    }
    Random random(seed * 49979687U + 11U);
    const auto steps = static_cast<std::uint64_t>(to_micros(1.0 / setup.rate) / kStep);
    scenarios_.reserve(setup.vehicles);
    for (unsigned i = 0; i < setup.vehicles; ++i) {
        scenarios_.push_back(swarm_scenario(setup, seed, i));
        plants_.push_back(std::make_unique<Plant>(scenarios_.back()));
        writers_.emplace_back(scenarios_.back().system);
        phases_.push_back(static_cast<Micros>(random.below(steps)) * kStep);
    }
    result_.seed = seed;
    result_.vehicles = setup.vehicles;
    result_.digest = 14695981039346656037U;
    touched_.resize(setup.vehicles * (setup.vehicles + setup.obstacles), false);
    arrived_.resize(setup.vehicles, -1);
    standing_since_.resize(setup.vehicles, -1);
    measure();
}

void Swarm::broadcast()
{
    const Micros period = to_micros(1.0 / setup_.rate) / kStep * kStep;
    for (std::size_t i = 0; i < size(); ++i) {
        FrameWriter& writer = writers_[i];
        if (now() % period == phases_[i]) {
            writer.write(plants_[i]->autopilot().global_position());
        }
        if (now() % kSecond == phases_[i]) {
            writer.write(plants_[i]->autopilot().heartbeat());
        }
        if (!writer.bytes().empty()) {
            radio_.send(i, writer.bytes(), now());
            writer.bytes().clear();
        }
    }
    for (std::size_t i = 0; i < size(); ++i) {
        plants_[i]->relay(radio_.take(i, now()));
    }
}

void Swarm::measure()
{
    const std::size_t others = size() + setup_.obstacles;
    const auto touch = [&](std::size_t i, std::size_t other) {
        result_.collisions += touched_[i * others + other] ? 0U : 1U;
        touched_[i * others + other] = true;
    };
    for (std::size_t i = 0; i < size(); ++i) {
        const World& world = plants_[i]->world();
        const Vec& place = world.own().position;
        for (std::size_t k = 0; k < i; ++k) {
            const Vec gap = plants_[k]->world().own().position - place;
            const double level = std::hypot(gap.x(), gap.y());
            result_.distance = std::min(result_.distance, gap.norm());
            result_.margin =
                std::min(result_.margin, std::max(level / setup_.level, std::abs(gap.z()) / setup_.vertical));
            if (gap.norm() < 2.0 * setup_.body) {
                touch(i, k);
            }
        }
        for (std::size_t k = 0; k < setup_.obstacles; ++k) {
            const double distance = (world.threat_position(k) - place).norm() - setup_.body;
            result_.obstacle = std::min(result_.obstacle, distance);
            if (distance < setup_.body) {
                touch(i, size() + k);
            }
        }
        const Autopilot& autopilot = plants_[i]->autopilot();
        const bool last = autopilot.mission().target() + 1 == scenarios_[i].mission.size();
        const bool there = last && (place - scenarios_[i].mission.back()).norm() <= kAtGoal;
        arrived_[i] = there && arrived_[i] < 0 ? now() : arrived_[i];
        const bool stands = arrived_[i] < 0 && world.own().velocity.norm() < kStands * setup_.cruise;
        standing_since_[i] = !stands ? -1 : standing_since_[i] < 0 ? now() : standing_since_[i];
        if (stands) {
            result_.stall = std::max(result_.stall, to_seconds(now() - standing_since_[i]));
        }
        if (now() % kNotePeriod == 0) {
            mix(result_.digest, place.x());
            mix(result_.digest, place.y());
            mix(result_.digest, place.z());
        }
    }
}

void Swarm::step()
{
    for (const auto& plant : plants_) {
        plant->step();
    }
    broadcast();
    measure();
}

bool Swarm::finished() const
{
    const Micros last = *std::max_element(arrived_.begin(), arrived_.end());
    const bool all = std::find(arrived_.begin(), arrived_.end(), -1) == arrived_.end();
    return now() >= to_micros(setup_.duration) || (all && now() - last >= kSettled);
}

void Swarm::note_fault(std::size_t vehicle, const std::string& what)
{
    result_.faults.push_back("vehicle " + std::to_string(vehicle + 1) + ": " + what);
}

SwarmResult Swarm::result() const
{
    SwarmResult result = result_;
    const auto fault = [&](std::size_t i, const char* what) {
        result.faults.push_back("vehicle " + std::to_string(i + 1) + ": " + what);
    };
    for (std::size_t i = 0; i < size(); ++i) {
        const Heard& heard = plants_[i]->autopilot().heard();
        result.arrived += arrived_[i] >= 0 ? 1U : 0U;
        result.takeovers += plants_[i]->autopilot().takeovers();
        result.jumps += heard.jumps;
        if (heard.heartbeats == 0) {
            fault(i, "the co-processor was never heard");
        }
        if (heard.bad_setpoints > 0) {
            fault(i, "set-points that an autopilot refuses");
        }
        if (heard.frames_refused > 0) {
            fault(i, "damaged frames");
        }
    }
    result.time = to_seconds(result.arrived == size() ? *std::max_element(arrived_.begin(), arrived_.end()) : now());
    return result;
}

void Swarm::write_tracks(const std::filesystem::path& file) const
{
    std::ofstream out(file);
    out << "time,vehicle,x,y,z,mode\n";
    for (std::size_t i = 0; i < size(); ++i) {
        const Record record = plants_[i]->record();
        constexpr std::size_t kEvery = 5;
        for (std::size_t k = 0; k < record.samples.size(); k += kEvery) {
            const Sample& s = record.samples[k];
            out << s.time << ',' << i + 1 << ',' << s.position.x() << ',' << s.position.y() << ',' << s.position.z()
                << ',' << to_string(s.mode) << '\n';
        }
    }
    out.close();
    if (!out) {
        throw std::runtime_error(file.string() + " cannot be written");
    }
}

SwarmResult fly_swarm(const SwarmSetup& setup, std::uint64_t seed, const std::filesystem::path& tracks)
{
    Swarm swarm(setup, seed);
    std::vector<std::unique_ptr<Station>> stations;
    std::vector<bool> overflowed(swarm.size(), false);
    for (std::size_t i = 0; i < swarm.size(); ++i) {
        const app::Parameters parameters = swarm_parameters(setup, static_cast<unsigned>(i));
        stations.push_back(std::make_unique<Station>(setup, seed, i, parameters));
    }
    std::array<std::byte, 4096> buffer{};
    while (!swarm.finished()) {
        for (std::size_t i = 0; i < swarm.size(); ++i) {
            swarm.plant(i).deliver({buffer.data(), stations[i]->cable.read(buffer)});
        }
        swarm.step();
        for (std::size_t i = 0; i < swarm.size(); ++i) {
            if (!stations[i]->serve(swarm.plant(i)) && !overflowed[i]) {
                overflowed[i] = true;
                swarm.note_fault(i, "the line could not carry the autopilot's telemetry");
            }
        }
    }
    const SwarmResult result = swarm.result();
    if (!tracks.empty() && !result.good()) {
        swarm.write_tracks(tracks / (std::to_string(seed) + ".csv"));
    }
    return result;
}

}  // namespace jink::sim
