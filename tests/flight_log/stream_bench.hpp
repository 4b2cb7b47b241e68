// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdlib>
#include <memory>
#include <vector>

#include "firmware/flight_log/log_stream.hpp"
#include "firmware/link/mavlink/endpoint.hpp"
#include "tests/unit/link/endpoint_tools.hpp"

namespace jink::test {

/// Everything that a log reads of a step, without a co-processor: the caller says what happened.
struct StreamBench {
    StreamBench()
    {
        const auto inbox = std::make_unique<link::Inbox>();
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

    /// A step later.
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
    /// Another plan: its number is the cost of its candidates. @param n  of them, kMaxCandidates at most
    void make_plan(std::size_t n)
    {
        ++plans;
        plan->candidates.clear();
        for (std::size_t i = 0; i < n; ++i) {
            geometric::Candidate candidate;
            candidate.total = static_cast<float>(plans);
            candidate.shape.offset = static_cast<float>(i);
            plan->candidates.unchecked_push_back(candidate);
        }
        plan->attempt = plans % 4;
    }
    [[nodiscard]] app::LoggedStep step() const
    {
        return {now,
                report,
                own,
                tracks,
                parameters,
                counts,
                supervisor_counts,
                {has_planner ? plan.get() : nullptr, plans},
                duration_us,
                is_line_free};
    }

    TimePoint now{1'000'000};
    link::mavlink::Endpoint endpoint;
    app::StepReport report;
    vehicle::VehicleState own;
    std::vector<world::Track> tracks;
    app::Parameters parameters;
    app::Diagnostics counts;
    avoid::Diagnostics supervisor_counts;
    std::unique_ptr<geometric::Result> plan = std::make_unique<geometric::Result>();
    std::uint32_t plans = 0;
    bool has_planner = true;
    std::uint32_t duration_us = 5'000;
    bool is_line_free = true;
};

}  // namespace jink::test
