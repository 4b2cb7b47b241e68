// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/base/static_vector.hpp"
#include "firmware/link/link.hpp"

namespace jink::c_interface {

/// A link that adds what the caller's own sensors see, and the parameters that the caller sets, to what it received.
/// Without reports it is the link itself.
class ReportingLink final : public link::Link {
public:
    /// @param link  outlives this
    explicit ReportingLink(link::Link& link) noexcept : link_(link) {}

    /// For the next step, which checks the stamps. False: as many as a step takes wait.
    [[nodiscard]] bool report(const link::TrackReport& report) noexcept { return tracks_.try_push_back(report); }
    [[nodiscard]] bool report(const link::RangeReading& report) noexcept { return readings_.try_push_back(report); }
    [[nodiscard]] bool set(const link::ParamRequest& request) noexcept { return params_.try_push_back(request); }
    /// Parameters that wait.
    [[nodiscard]] const StaticVector<link::ParamRequest, 16>& waiting() const noexcept { return params_; }
    [[nodiscard]] std::uint32_t reported() const noexcept { return reported_; }
    /// Reports stamped later than the step that they came to, or more than its inbox takes.
    [[nodiscard]] std::uint32_t refused() const noexcept { return refused_; }

    void receive(std::span<const std::byte> bytes, TimePoint now, link::Inbox& inbox) noexcept override;

    void service(TimePoint now) noexcept override { link_.service(now); }
    void ask_for_rates(bool on) noexcept override { link_.ask_for_rates(on); }
    void report_points_to(link::CloudSink& sink) noexcept override { link_.report_points_to(sink); }
    [[nodiscard]] std::span<const std::byte> pending() const noexcept override { return link_.pending(); }
    void consume(std::size_t n) noexcept override { link_.consume(n); }
    void discard_pending() noexcept override { link_.discard_pending(); }
    void drop_setpoint() noexcept override { link_.drop_setpoint(); }
    void drop_mode_request() noexcept override { link_.drop_mode_request(); }
    void send_heartbeat(link::SystemState state) noexcept override { link_.send_heartbeat(state); }
    void send_velocity(const Vec3& velocity, TimePoint now) noexcept override { link_.send_velocity(velocity, now); }
    void send_collision(const link::CollisionWarning& warning) noexcept override { link_.send_collision(warning); }
    void send_text(link::Severity severity, std::string_view text) noexcept override
    {
        link_.send_text(severity, text);
    }
    void send_param(const link::ParamName& name, float value, std::uint16_t index,
                    std::uint16_t count) noexcept override
    {
        link_.send_param(name, value, index, count);
    }
    void acknowledge(const link::CommandRequest& request, link::CommandResult result) noexcept override
    {
        link_.acknowledge(request, result);
    }
    void acknowledge(const link::ConstraintPart& part, link::ConstraintResult result) noexcept override
    {
        link_.acknowledge(part, result);
    }
    void send_version(const link::Version& version) noexcept override { link_.send_version(version); }
    [[nodiscard]] bool send_log(const link::LogPart& part) noexcept override { return link_.send_log(part); }
    void request_external_mode() noexcept override { link_.request_external_mode(); }
    void request_mode(std::uint32_t custom_mode) noexcept override { link_.request_mode(custom_mode); }
    void request_heartbeat() noexcept override { link_.request_heartbeat(); }
    void request_hold_mode() noexcept override { link_.request_hold_mode(); }
    [[nodiscard]] std::optional<link::GlobalPosition> origin() const noexcept override { return link_.origin(); }
    [[nodiscard]] std::optional<std::int32_t> undulation() const noexcept override { return link_.undulation(); }
    [[nodiscard]] std::size_t compose_last_words(std::span<std::byte> out, bool hold,
                                                 std::string_view text) noexcept override
    {
        return link_.compose_last_words(out, hold, text);
    }
    [[nodiscard]] world::TrackId own_track() const noexcept override { return link_.own_track(); }
    [[nodiscard]] const link::LinkDiagnostics& diagnostics() const noexcept override { return link_.diagnostics(); }

private:
    template <class Report, std::size_t N, std::size_t M>
    void deliver(StaticVector<Report, N>& reports, TimePoint now, StaticVector<Report, M>& into) noexcept;

    link::Link& link_;
    StaticVector<link::TrackReport, link::kMaxTrackReports> tracks_;
    StaticVector<link::RangeReading, 16> readings_;  ///< Inbox::readings
    StaticVector<link::ParamRequest, 16> params_;    ///< Inbox::params
    std::uint32_t reported_ = 0;
    std::uint32_t refused_ = 0;
};

}  // namespace jink::c_interface
