// SPDX-License-Identifier: BSD-3-Clause
// What a board's log costs a step that logs as much as any, in instructions: counted below worst_step, candidates_step
// and definitions_step (docs/guides/board_log.md).
#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "tests/flight_log/stream_bench.hpp"

namespace {

using namespace jink;
using Bench = test::StreamBench;

using Acks = std::array<link::LogAck, 1>;

[[gnu::noinline]] void worst_step(flightlog::LogStream& log, Bench& bench)
{
    log.begin(bench.now, {});
    log.note_text(link::Severity::warning, "jink: conflict with a track, 5.0 m in 3.2 s here");
    log.end(bench.step(), bench.endpoint);
}

/// The step after a decision, of whose candidates two go out.
[[gnu::noinline]] void candidates_step(flightlog::LogStream& log, Bench& bench)
{
    log.begin(bench.now, {});
    log.note_text(link::Severity::notice, "jink: conflict with a track, 5.0 m in 3.2 s here");
    log.end(bench.step(), bench.endpoint);
}

[[gnu::noinline]] void definitions_step(flightlog::LogStream& log, Bench& bench, const Acks& acks)
{
    log.begin(bench.now, acks);
    log.end(bench.step(), bench.endpoint);
}

}  // namespace

int main()
{
    const auto bench = std::make_unique<Bench>();
    bench->tracks.resize(32);                // as many as a board has
    flightlog::LogStream log(100 * 921600);  // a part in each step
    link::CommandRequest start;
    start.command = 2510;
    start.from_system = 255;
    log.begin(bench->now, {});
    if (log.take(start, bench->parameters) != link::CommandResult::accepted) {
        return EXIT_FAILURE;
    }
    int definitions = 0;
    for (std::uint16_t sequence = 0xFFFF; log.counts().parts < 20; ++sequence, ++definitions) {
        bench->prepare(false);
        definitions_step(log, *bench, {{{sequence, 255, 0}}});
    }
    for (std::uint16_t sequence = 19; log.ring().messages() == 0; ++sequence) {
        bench->prepare(false);
        const Acks acks{{{sequence, 255, 0}}};
        log.begin(bench->now, acks);
        log.end(bench->step(), bench->endpoint);
    }
    constexpr int kWorst = 200;
    const std::uint32_t parts = log.counts().parts;
    for (int i = 0; i < kWorst; ++i) {
        bench->make_plan(32);
        bench->prepare(true);
        worst_step(log, *bench);
        bench->prepare(false);
        candidates_step(log, *bench);
        for (int quiet = 0; quiet < 31 || log.ring().size() >= link::kMaxLogPart; ++quiet) {  // what waits goes out
            bench->prepare(false);
            log.begin(bench->now, {});
            log.end(bench->step(), bench->endpoint);
        }
    }
    const std::uint32_t lost = log.ring().dropped() + log.counts().candidates_left_out;
    std::printf("%d steps with definitions, %d worst steps and as many with candidates, %u parts, %u lost\n",
                definitions, kWorst, log.counts().parts - parts, lost);
    return lost == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
