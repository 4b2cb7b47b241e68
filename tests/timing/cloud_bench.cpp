// SPDX-License-Identifier: BSD-3-Clause
// Point clouds of 10^5 points ten times a second: the decoder with its image alone, and the whole tick that reads them.
// One iteration is one step of 20 ms, in which 20 000 points come.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/base/random.hpp"
#include "firmware/app/cloud_input.hpp"
#include "firmware/link/cloud/frame.hpp"

namespace {

using namespace jink;
namespace cloud = link::cloud;

constexpr std::size_t kPoints = 100'000;
constexpr std::size_t kStepsPerScan = 5;

/// Serves the pending bytes, and drops them.
class BenchPort final : public hal::SerialPort {
public:
    std::size_t read(std::span<std::byte> into) noexcept override
    {
        const std::size_t n = std::min(into.size(), waiting.size());
        std::copy_n(waiting.begin(), n, into.begin());
        waiting = waiting.subspan(n);
        return n;
    }
    std::size_t write(std::span<const std::byte> from) noexcept override { return from.size(); }
    hal::PortHealth health() const noexcept override { return {}; }

    std::span<const std::byte> waiting;
};

/// Rays over all directions of a sensor with 45 degrees up and down, returns at 5 to 100 m.
std::vector<std::byte> scan_bytes(std::uint16_t number)
{
    Random random(number);
    cloud::Part part;
    part.scan = number;
    part.scan_points = kPoints;
    part.parts = static_cast<std::uint16_t>((kPoints + cloud::kMaxPoints - 1) / cloud::kMaxPoints);
    part.max_range = 20'000;
    part.stamp_ms = 100U * number;
    part.roll = 300;
    part.pitch = -200;
    std::vector<cloud::RawPoint> points(cloud::kMaxPoints);
    std::vector<std::byte> bytes;
    std::array<std::byte, cloud::kMaxFrame> frame{};
    std::size_t left = kPoints;
    for (std::uint16_t i = 0; i < part.parts; ++i) {
        const std::size_t n = std::min(left, cloud::kMaxPoints);
        left -= n;
        for (cloud::RawPoint& point : points) {
            point.azimuth = static_cast<std::int16_t>(random.uniform(-31416.0F, 31416.0F));
            point.elevation = static_cast<std::int16_t>(random.uniform(-7854.0F, 7854.0F));
            point.range = static_cast<std::uint16_t>(random.uniform(500.0F, 10'000.0F));
        }
        part.part = i;
        part.sequence = static_cast<std::uint16_t>(number * part.parts + i);
        const std::size_t size = cloud::write_frame(part, std::span(points).first(n), frame);
        bytes.insert(bytes.end(), frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(size));
    }
    return bytes;
}

void points_per_second(benchmark::State& state)
{
    constexpr std::uint16_t kScans = 50;  // repeated scans would be refused as duplicates
    std::vector<std::vector<std::byte>> scans;
    for (std::uint16_t i = 0; i < kScans; ++i) {
        scans.push_back(scan_bytes(i));
    }
    BenchPort port;
    auto input = std::make_unique<app::CloudInput>(&port);
    const auto table = std::make_unique<world::ObstacleTable>();
    input->give_to(*table);
    app::CloudView view;
    view.is_placed = true;
    view.half_extents = Vec3(2, 2, 1);
    TimePoint now{1'000'000};
    std::size_t step = 0;
    std::uint64_t points = 0;
    for (auto _ : state) {
        if (step == kStepsPerScan * kScans) {
            state.PauseTiming();
            points += input->receiver_diagnostics().points;
            input = std::make_unique<app::CloudInput>(&port);
            input->give_to(*table);
            step = 0;
            state.ResumeTiming();
        }
        const std::vector<std::byte>& scan = scans[step / kStepsPerScan];
        const std::size_t share = (scan.size() + kStepsPerScan - 1) / kStepsPerScan;
        const std::size_t at = step % kStepsPerScan * share;
        port.waiting = std::span(scan).subspan(at, std::min(share, scan.size() - at));
        now.us += 20'000;
        view.stamp = now;
        input->serve(now, view);
        ++step;
        benchmark::DoNotOptimize(table->obstacles().data());
    }
    points += input->receiver_diagnostics().points;
    state.counters["points_per_second"] = benchmark::Counter(static_cast<double>(points), benchmark::Counter::kIsRate);
    state.counters["obstacles"] = static_cast<double>(table->obstacles().size());
    state.counters["full_steps"] = static_cast<double>(input->full_steps());
}
BENCHMARK(points_per_second)->Name("cloud")->Unit(benchmark::kMicrosecond);

/// Cost of a line full of false starts, and of headers that claim the longest frame, in a step that reads its limit.
void worst_step(benchmark::State& state)
{
    cloud::Part part;
    part.scan_points = cloud::kMaxPoints;
    part.max_range = 1000;
    const std::vector<cloud::RawPoint> points(cloud::kMaxPoints);
    std::array<std::byte, cloud::kMaxFrame> frame{};
    static_cast<void>(cloud::write_frame(part, points, frame));
    std::vector<std::byte> bytes;
    while (bytes.size() < app::kMaxCloudBytesPerStep) {
        bytes.insert(bytes.end(), frame.begin(), frame.begin() + cloud::kHeaderSize);
    }
    BenchPort port;
    const auto input = std::make_unique<app::CloudInput>(&port);
    TimePoint now{1'000'000};
    for (auto _ : state) {
        port.waiting = bytes;
        now.us += 20'000;
        input->serve(now, {});
    }
    state.counters["full_steps"] = static_cast<double>(input->full_steps());
}
BENCHMARK(worst_step)->Name("cloud_of_headers")->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
