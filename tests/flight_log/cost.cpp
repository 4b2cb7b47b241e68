// SPDX-License-Identifier: BSD-3-Clause
// Random flights with a log whose queue nobody empties: what the log costs the control loop. Count the instructions
// below Coprocessor::step, and below FlightLog::end and the recorder (docs/guides/flight_log.md).
#include <cstdio>
#include <cstdlib>

#include "firmware/linux/flight_log/queue.hpp"
#include "tests/flight_log/recorded_flight.hpp"
#include "toolchain/sim/random_scenario.hpp"

namespace {

using namespace jink;

class LargeQueue final : public flightlog::Output {
public:
    bool add(std::span<const std::byte> messages, std::uint32_t count) noexcept override
    {
        return queue_.add(messages, 0, count);
    }
    void lose() noexcept override {}
    [[nodiscard]] flightlog::LogCounts counts() const noexcept override
    {
        return {queue_.messages(), queue_.dropped(), 0, 0, queue_.peak()};
    }

private:
    flightlog::Queue queue_{1U << 26U};
};

}  // namespace

int main(int argc, char** argv)
{
    const int flights = argc > 1 ? std::atoi(argv[1]) : 10;
    std::uint64_t steps = 0;
    LargeQueue queue;
    for (int seed = 1; seed <= flights; ++seed) {
        test::FlightOptions options;
        options.output = &queue;
        steps += test::fly_recorded(sim::random_scenario(static_cast<std::uint64_t>(seed)), {}, options).steps;
    }
    const flightlog::LogCounts counts = queue.counts();
    std::printf("%d flights, %llu steps, %u messages, %u dropped, %u bytes\n", flights,
                static_cast<unsigned long long>(steps), counts.messages, counts.dropped, counts.peak);
    return counts.dropped == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
