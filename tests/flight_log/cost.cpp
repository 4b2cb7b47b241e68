// SPDX-License-Identifier: BSD-3-Clause
// Random flights without a log, with one, with a live page, or with both, whose queues nobody empties: what the log
// costs the control loop. cost_check.py counts the instructions below counted_step.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

#include "firmware/linux/flight_log/queue.hpp"
#include "firmware/linux/live_page/feed.hpp"
#include "firmware/linux/logging.hpp"
#include "tests/flight_log/recorded_flight.hpp"
#include "toolchain/sim/random_scenario.hpp"

namespace {

using namespace jink;

constexpr std::size_t kQueueBytes = 1U << 26U;

class LargeQueue final : public flightlog::Output {
public:
    bool add(std::span<const std::byte> messages, std::uint32_t count, flightlog::Records /*records*/) noexcept override
    {
        return queue_.add(messages, 0, count);
    }
    void lose() noexcept override {}
    [[nodiscard]] flightlog::LogCounts counts() const noexcept override
    {
        return {queue_.messages(), queue_.dropped(), 0, 0, queue_.peak()};
    }

private:
    flightlog::Queue queue_{kQueueBytes};
};

}  // namespace

int main(int argc, char** argv)
{
    const std::string mode = argc > 1 ? argv[1] : "";
    const int flights = argc > 2 ? std::atoi(argv[2]) : 3;
    const bool is_crowded = argc > 3 && std::string(argv[3]) == "crowded";  // many obstacles and tracks
    if ((mode != "none" && mode != "log" && mode != "page" && mode != "both") || flights < 1) {
        std::fprintf(stderr, "usage: flight_log_cost none|log|page|both [FLIGHTS [crowded]]\n");
        return 2;
    }
    LargeQueue queue;
    livepage::Feed feed(kQueueBytes);
    host::TwoOutputs both(queue, feed);
    test::FlightOptions options;
    options.without_log = mode == "none";
    options.without_records = mode == "page";
    options.output = mode == "page" ? static_cast<flightlog::Output*>(&feed) : mode == "both" ? &both : nullptr;
    options.output = options.output != nullptr ? options.output : &queue;
    std::uint64_t steps = 0;
    std::size_t obstacles = 0;
    options.beside = [&](std::uint64_t, TimePoint, const app::Coprocessor& coprocessor, flightlog::HalRecorder&) {
        obstacles = std::max(obstacles, coprocessor.obstacles().size());
    };
    for (int flight = 1; flight <= flights; ++flight) {
        const auto seed = static_cast<std::uint64_t>(flight);
        steps += test::fly_recorded(is_crowded ? sim::crowded_scenario(seed) : sim::random_scenario(seed), {}, options)
                     .steps;
    }
    const flightlog::LogCounts counts = options.output->counts();
    std::printf("%d flights, %llu steps, %u messages, %u dropped, %u bytes, at most %zu obstacles\n", flights,
                static_cast<unsigned long long>(steps), counts.messages, counts.dropped, counts.peak, obstacles);
    return counts.dropped == 0 && (counts.messages > 0) != options.without_log ? EXIT_SUCCESS : EXIT_FAILURE;
}
