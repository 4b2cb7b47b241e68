// SPDX-License-Identifier: BSD-3-Clause
// Random flights with a log whose queue is emptied and thrown away: what the log costs the control loop. Count the
// instructions below Coprocessor::step, and below FlightLog::end and the recorder (docs/guides/flight_log.md).
#include <cstdio>
#include <cstdlib>

#include "firmware/linux/flight_log/queue.hpp"
#include "tests/flight_log/recorded_flight.hpp"
#include "toolchain/sim/random_scenario.hpp"

namespace {

using namespace jink;

class DrainedQueue final : public flightlog::Output {
public:
    bool add(std::span<const std::byte> message) noexcept override
    {
        while (queue_.size() > (1U << 19U)) {
            static_cast<void>(queue_.take(piece_));
        }
        bytes_ += message.size();
        return queue_.add(message, 0);
    }
    void lose() noexcept override {}
    [[nodiscard]] flightlog::LogCounts counts() const noexcept override { return {queue_.messages(), 0, 0, 0, 0}; }
    [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }

private:
    flightlog::Queue queue_{1U << 20U};
    std::vector<std::byte> piece_ = std::vector<std::byte>(1U << 16U);
    std::uint64_t bytes_ = 0;
};

}  // namespace

int main(int argc, char** argv)
{
    const int flights = argc > 1 ? std::atoi(argv[1]) : 10;
    std::uint64_t steps = 0;
    DrainedQueue queue;
    for (int seed = 1; seed <= flights; ++seed) {
        test::FlightOptions options;
        options.output = &queue;
        steps += test::fly_recorded(sim::random_scenario(static_cast<std::uint64_t>(seed)), {}, options).steps;
    }
    std::printf("%d flights, %llu steps, %u messages, %llu bytes\n", flights, static_cast<unsigned long long>(steps),
                queue.counts().messages, static_cast<unsigned long long>(queue.bytes()));
    return EXIT_SUCCESS;
}
