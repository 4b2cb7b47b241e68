// SPDX-License-Identifier: BSD-3-Clause
// What a board's log costs a step that logs as much as any, in instructions: counted below worst_step and below
// definitions_step (docs/guides/board_log.md).
#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include "firmware/flight_log/log_stream.hpp"
#include "firmware/link/mavlink/endpoint.hpp"
#include "tests/unit/link/endpoint_tools.hpp"

namespace {

using namespace jink;

/// Everything that a log reads of a step.
struct Bench {
    Bench()
    {
        inbox->clear();
        endpoint.receive(link::mavlink::test::frame_of(link::mavlink::test::heartbeat(), {7, 1, 0}), now, *inbox);
        for (std::uint32_t i = 0; i < kMaxTracks; ++i) {
            world::Track track;
            track.id = i + 1;
            track.position = Vec3(static_cast<float>(i), 20.0F, 30.0F);
            tracks.push_back(track);
        }
        report.own_source = app::OwnSource::autopilot;
        report.guidance.conflict.emplace();
        report.guidance.conflict->threat.kind = world::ThreatKind::track;
    }
    /// @param busy  a manoeuvre begins, control and guidance change, and a parameter
    void prepare(bool busy)
    {
        now.us += 20'000;
        report.guidance.new_manoeuvre = busy;
        if (busy) {
            const bool flying = report.control == app::Control::ours;
            report.control = flying ? app::Control::returning : app::Control::ours;
            report.guidance.state = flying ? avoid::State::rejoining : avoid::State::avoiding;
            report.guidance.conflict->threat.index = flying ? 3 : 4;
            if (parameters.set(app::Param::flip_penalty, flying ? 0.01F : 0.02F) != app::ParamStatus::ok) {
                std::abort();
            }
        }
        endpoint.consume(endpoint.pending().size());
    }
    [[nodiscard]] app::LoggedStep step() const
    {
        return {now, report, own, tracks, parameters, counts, supervisor_counts, true};
    }

    TimePoint now{1'000'000};
    std::unique_ptr<link::Inbox> inbox = std::make_unique<link::Inbox>();
    link::mavlink::Endpoint endpoint;
    app::StepReport report;
    vehicle::VehicleState own;
    std::vector<world::Track> tracks;
    app::Parameters parameters;
    app::Diagnostics counts;
    avoid::Diagnostics supervisor_counts;
};

using Acks = std::array<link::LogAck, 1>;

[[gnu::noinline]] void worst_step(flightlog::LogStream& log, Bench& bench)
{
    log.begin(bench.now, {});
    log.note_text(link::Severity::warning, "jink: conflict with a track, 5.0 m in 3.2 s here");
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
        bench->prepare(true);
        worst_step(log, *bench);
        for (int quiet = 0; quiet < 2 || log.ring().size() >= link::kMaxLogPart; ++quiet) {  // what waits goes out
            bench->prepare(false);
            log.begin(bench->now, {});
            log.end(bench->step(), bench->endpoint);
        }
    }
    std::printf("%d steps with definitions, %d worst steps, %u parts, %u dropped\n", definitions, kWorst,
                log.counts().parts - parts, log.ring().dropped());
    return log.ring().dropped() == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
