// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/status.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>

#include "firmware/linux/flight_log/topics.hpp"

namespace jink::host {
namespace {

const char* name_of(hal::PortState state)
{
    switch (state) {
    case hal::PortState::closed: return "closed";
    case hal::PortState::open: return "open";
    case hal::PortState::lost: return "lost";
    }
    return "?";
}

const char* name_of(hal::CanState state)
{
    switch (state) {
    case hal::CanState::closed: return "closed";
    case hal::CanState::active: return "active";
    case hal::CanState::error_passive: return "passive";
    case hal::CanState::bus_off: return "off";
    case hal::CanState::down: return "down";
    }
    return "?";
}

std::uint32_t refused_by(const link::dronecan::ReceiverDiagnostics& d)
{
    return d.standard_id + d.remote + d.bad_length + d.bad_id + d.anonymous_refused + d.missed_start + d.wrong_toggle +
           d.wrong_transfer + d.short_frame + d.too_long + d.bad_crc + d.timed_out + d.interrupted;
}

void write_bus(std::FILE* f, const app::CanBus& bus)
{
    const hal::CanHealth h = bus.health();
    const app::CanBusDiagnostics& b = bus.diagnostics();
    const link::LinkDiagnostics& l = bus.endpoint().diagnostics();
    const link::dronecan::Node& node = bus.endpoint().node();
    const link::dronecan::NodeDiagnostics& n = node.diagnostics();
    const link::dronecan::TunnelDiagnostics& t = bus.tunnel().diagnostics();
    const auto u = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
    std::fprintf(f, "  \"can\": {\"state\": \"%s\", \"node\": %u, \"tunnel_peer\": %u,\n", name_of(h.state), node.id(),
                 bus.tunnel().peer());
    std::fprintf(f,
                 "    \"frames_in\": %llu, \"frames_out\": %llu, \"frames_refused\": %llu, \"overruns\": %llu, "
                 "\"bus_errors\": %llu,\n    \"bus_offs\": %llu, \"restarts\": %llu, \"downs\": %llu, \"ups\": %llu,\n",
                 u(h.frames_in), u(h.frames_out), u(h.frames_refused), u(h.overruns), u(h.bus_errors), u(h.bus_offs),
                 u(h.restarts), u(h.downs), u(h.ups));
    std::fprintf(f,
                 "    \"transfers_in\": %u, \"transfer_errors\": %u, \"transfers_out\": %u, \"transfers_dropped\": %u, "
                 "\"answers\": %u, \"id_conflicts\": %u,\n",
                 node.receiver_diagnostics().transfers, refused_by(node.receiver_diagnostics()),
                 node.outgoing().diagnostics().transfers, node.outgoing().diagnostics().transfers_dropped, n.answers,
                 n.id_conflicts);
    std::fprintf(f,
                 "    \"not_finite\": %u, \"out_of_range\": %u, \"no_origin\": %u, \"stale_stamps\": %u, "
                 "\"inbox_full\": %u, \"sensors_evicted\": %u,\n",
                 l.not_finite, l.out_of_range, l.no_origin, l.stale_stamp, l.inbox_full, l.sensors_evicted);
    std::fprintf(
        f, "    \"full_steps\": %u, \"frames_late\": %u, \"stalls\": %u, \"losses\": %u, \"near_not_sent\": %u,\n",
        b.full_steps, b.frames_late, b.stalls, b.losses, b.near_not_sent);
    std::fprintf(f, "    \"tunnel_in\": %u, \"tunnel_out\": %u, \"tunnel_overwritten\": %u, \"tunnel_dropped\": %u},\n",
                 t.transfers_in, t.transfers_out, t.bytes_overwritten, b.tunnel_dropped);
}

/// What MAVLink's link and its port refused, dropped and lost.
void write_link(std::FILE* f, const link::mavlink::Endpoint& endpoint, const hal::PortHealth& port)
{
    const link::LinkDiagnostics& l = endpoint.diagnostics();
    const link::mavlink::ParserDiagnostics& p = endpoint.parser_diagnostics();
    const auto u = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
    std::fprintf(f,
                 "  \"mavlink\": {\"not_finite\": %u, \"out_of_range\": %u, \"no_origin\": %u, \"inbox_full\": %u, "
                 "\"frames_ignored\": %u, \"own_heard\": %u, \"systems_evicted\": %u, "
                 "\"sensors_evicted\": %u,\n",
                 l.not_finite, l.out_of_range, l.no_origin, l.inbox_full, l.frames_ignored, l.own_heard,
                 l.systems_evicted, l.sensors_evicted);
    std::fprintf(f,
                 "    \"outbox_full\": %u, \"setpoints_dropped\": %u, \"requests_dropped\": %u, "
                 "\"heartbeats_dropped\": %u, \"bytes_discarded\": %u, \"rate_requests\": %u, "
                 "\"rates_refused\": %u,\n",
                 l.outbox_full, l.setpoints_dropped, l.requests_dropped, l.heartbeats_dropped, l.bytes_discarded,
                 l.rate_requests, l.rates_refused);
    std::fprintf(f,
                 "    \"noise_bytes\": %u, \"incompatible_flags\": %u, \"unknown_message\": %u, \"too_short\": %u, "
                 "\"too_long\": %u, \"bad_checksum\": %u, \"cut\": %u,\n    \"lost\": %u, \"repeated\": %u, "
                 "\"untracked_senders\": %u,\n",
                 p.noise_bytes, p.incompatible_flags, p.unknown_message, p.too_short, p.too_long, p.bad_checksum, p.cut,
                 p.lost, p.repeated, p.untracked_senders);
    std::fprintf(f,
                 "    \"bytes_in\": %llu, \"bytes_out\": %llu, \"bytes_refused\": %llu, \"line_errors\": %llu, "
                 "\"overruns\": %llu, \"read_errors\": %llu, \"write_errors\": %llu, \"open_failures\": %llu},\n",
                 u(port.bytes_in), u(port.bytes_out), u(port.bytes_refused), u(port.line_errors), u(port.overruns),
                 u(port.read_errors), u(port.write_errors), u(port.open_failures));
}

void write_image(std::FILE* f, const char* name, const app::CloudDiagnostics& d)
{
    const auto u = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
    std::fprintf(f,
                 "    \"%s\": {\"scans\": %u, \"unplaced\": %u, \"hits\": %llu, \"nothing\": %llu, \"invalid\": %llu, "
                 "\"lost\": %llu,\n      \"body\": %llu, \"below_floor\": %llu, \"beyond\": %llu, "
                 "\"kept\": %llu, \"obstacles\": %u, \"left_out\": %u, \"coarse\": %u, \"remembered\": %u}",
                 name, d.scans, d.scans_unplaced, u(d.hits), u(d.nothing), u(d.invalid), u(d.lost), u(d.body),
                 u(d.below_floor), u(d.beyond), u(d.kept), d.obstacles, d.left_out, d.coarse, d.remembered);
}

void write_clouds(std::FILE* f, const app::CloudInput& clouds)
{
    const link::cloud::ReceiverDiagnostics& d = clouds.receiver_diagnostics();
    const auto u = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
    std::fprintf(f, "  \"clouds\": {\n");
    if (clouds.has_port()) {
        std::fprintf(f,
                     "    \"bytes\": %llu, \"noise_bytes\": %llu, \"full_steps\": %u, \"frames\": %u, "
                     "\"frames_missed\": %u, \"reordered\": %u, \"restarts\": %u,\n",
                     u(clouds.bytes_in()), u(d.noise_bytes), clouds.full_steps(), d.frames, d.frames_missed,
                     d.reordered, d.restarts);
        std::fprintf(f,
                     "    \"scans\": %u, \"scans_complete\": %u, \"scans_missed\": %u, \"points\": %llu, "
                     "\"points_lost\": %llu, \"clock_relocks\": %u,\n",
                     d.scans, d.scans_complete, d.scans_missed, u(d.points), u(d.points_lost), d.clock_relocks);
        std::fprintf(f,
                     "    \"unknown_version\": %u, \"bad_header\": %u, \"bad_checksum\": %u, \"cut\": %u, "
                     "\"out_of_range\": %u, \"inconsistent\": %u, \"duplicated\": %u, \"late\": %u, \"stale\": "
                     "%u,\n",
                     d.unknown_version, d.bad_header, d.bad_checksum, d.cut, d.out_of_range, d.inconsistent,
                     d.duplicated, d.late, d.stale);
        write_image(f, "port", clouds.port_diagnostics());
        std::fprintf(f, ",\n");
    }
    write_image(f, "link", clouds.link_diagnostics());
    std::fprintf(f, "},\n");
}

std::string status_line(const app::StepReport& report, const Watched& watched, std::int64_t longest_us)
{
    std::array<char, Background::kLineBytes> text{};
    std::size_t size = 0;
    const auto add = [&](const char* format, auto... values) {
        const int n = std::snprintf(text.data() + size, text.size() - size, format, values...);
        size = std::min(size + static_cast<std::size_t>(std::max(n, 0)), text.size() - 1);
    };
    const avoid::Guidance& g = report.guidance;
    add("%-9s port %-6s control %-10s %-9s tracks %2u obstacles %2u ", flightlog::name_of(report.state).data(),
        name_of(watched.port.health().state), flightlog::name_of(report.control).data(),
        flightlog::name_of(g.state).data(), report.tracks, report.obstacles);
    if (report.uncertain_heights > 0) {
        add("heights uncertain %2u ", report.uncertain_heights);
    }
    if (report.cylinders > 0) {
        add("areas %2u ", report.cylinders);
    }
    if (g.conflict) {
        add("conflict in %.1f s ", static_cast<double>(g.conflict->time_to_loss));
    }
    if (report.faults != 0) {
        add("faults 0x%x ", report.faults);
    }
    if (watched.bus != nullptr) {
        const hal::CanHealth h = watched.bus->health();
        add("can %s node %u frames %llu/%llu ", name_of(h.state), watched.bus->endpoint().node().id(),
            static_cast<unsigned long long>(h.frames_in), static_cast<unsigned long long>(h.frames_out));
    }
    if (watched.log != nullptr) {
        const flightlog::LogCounts log = watched.log->counts();
        add("log files %u dropped %u failures %u ", log.files, log.dropped, log.write_failures);
    }
    const link::LinkDiagnostics& l = watched.endpoint.diagnostics();
    add("frames %u/%u refused %u step max %lld us", l.frames_in, l.frames_out, l.frames_refused,
        static_cast<long long>(longest_us));
    return {text.data(), size};
}

}  // namespace

std::optional<std::string> StatusLog::note(const app::StepReport& report, const Watched& watched, std::int64_t now_us,
                                           std::int64_t took_us)
{
    const app::Coprocessor& coprocessor = watched.coprocessor;
    ++steps_;
    total_us_ += took_us;
    longest_us_ = std::max(longest_us_, took_us);
    const auto bin =
        std::min<std::size_t>(kBins - 1, static_cast<std::size_t>(std::max<std::int64_t>(0, took_us) / kBinWidth));
    ++bins_[bin];
    const std::uint32_t plans = coprocessor.supervisor_diagnostics().plans;
    if (plans != last_plans_) {
        last_plans_ = plans;
        ++plan_bins_[bin];
        ++plan_steps_;
        total_plan_us_ += took_us;
        longest_plan_us_ = std::max(longest_plan_us_, took_us);
    }
    if (period_us_ <= 0 || now_us - last_line_us_ < period_us_) {
        return std::nullopt;
    }
    last_line_us_ = now_us;
    return status_line(report, watched, longest_us_);
}

bool StatusLog::write_summary(const std::string& path, const Watched& watched, const BackgroundCounts& counts) const
{
    const app::Coprocessor& coprocessor = watched.coprocessor;
    const hal::PortHealth port = watched.port.health();
    // Composed in memory first: writing to the file may block or fail.
    char* text = nullptr;
    std::size_t size = 0;
    std::FILE* f = ::open_memstream(&text, &size);
    if (f == nullptr) {
        return false;
    }
    const app::Diagnostics& d = coprocessor.diagnostics();
    const avoid::Diagnostics& s = coprocessor.supervisor_diagnostics();
    const app::TakeoverDiagnostics& t = coprocessor.takeover_diagnostics();
    const world::TrackDiagnostics& k = coprocessor.track_diagnostics();
    const link::LinkDiagnostics& l = watched.endpoint.diagnostics();
    const auto mean = [](std::int64_t sum, std::uint64_t n) {
        return n > 0 ? static_cast<double>(sum) / static_cast<double>(n) : 0.0;
    };
    std::fprintf(f, "{\n  \"steps\": %llu, \"step_mean_us\": %.1f, \"step_max_us\": %lld,\n",
                 static_cast<unsigned long long>(steps_), mean(total_us_, steps_), static_cast<long long>(longest_us_));
    std::fprintf(f, "  \"plan_steps\": %llu, \"plan_step_mean_us\": %.1f, \"plan_step_max_us\": %lld,\n",
                 static_cast<unsigned long long>(plan_steps_), mean(total_plan_us_, plan_steps_),
                 static_cast<long long>(longest_plan_us_));
    std::fprintf(f, "  \"plan_step_bins_us\": {");
    bool first = true;
    for (std::size_t i = 0; i < kBins; ++i) {
        if (plan_bins_[i] != 0) {
            std::fprintf(f, "%s\"%lld\": %u", first ? "" : ", ",
                         static_cast<long long>(static_cast<std::int64_t>(i) * kBinWidth), plan_bins_[i]);
            first = false;
        }
    }
    std::fprintf(
        f,
        "},\n  \"conflicts\": %u, \"plans\": %u, \"plans_found\": %u, \"answers_rejected\": %u, \"manoeuvres\": %u,\n",
        s.conflicts, s.plans, s.plans_found, s.answers_rejected, s.manoeuvres);
    std::fprintf(f,
                 "  \"replans\": %u, \"flips\": %u, \"brakes\": %u, \"escapes\": %u, \"holds\": %u, \"rejoined\": %u, "
                 "\"held_back\": %u, \"gave_way\": %u, \"budget_spent\": %u,\n",
                 s.replans, s.flips, s.brakes, s.escapes, s.holds, s.rejoined, s.held_back, s.gave_way, s.budget_spent);
    std::fprintf(f, "  \"deadlines_missed\": %u, \"setpoints\": %u, \"setpoints_withheld\": %u, \"faults\": %u,\n",
                 d.deadlines_missed, d.setpoints, d.setpoints_withheld, d.faults);
    std::fprintf(f,
                 "  \"mode_requests\": %u, \"taken\": %u, \"given_back\": %u, \"refused\": %u, \"overruled\": %u, "
                 "\"lost_by_fault\": %u,\n",
                 t.requests, t.taken, t.given_back, t.refused, t.overruled, t.lost_by_fault);
    std::fprintf(f,
                 "  \"autopilot_reboots\": %u, \"estimator_resets\": %u, \"params_set\": %u, \"params_refused\": %u,\n",
                 d.autopilot_reboots, d.estimator_resets, d.params_set, d.params_refused);
    std::fprintf(f,
                 "  \"tracks_created\": %u, \"tracks_refused\": %u, \"tracks_expired\": %u, \"tracks_dropped\": %u,\n",
                 k.created, k.not_finite + k.out_of_range + k.stale + k.future, k.expired, k.full + k.replaced);
    std::fprintf(
        f, "  \"tracks_doubled\": %u, \"track_floods\": %u, \"pressure_heights\": %u, \"heights_compared\": %u,\n",
        k.doubled, k.floods, l.pressure_heights, l.heights_compared);
    std::fprintf(f,
                 "  \"frames_in\": %u, \"frames_out\": %u, \"frames_refused\": %u, \"stale_stamps\": %u, "
                 "\"clock_relocks\": %u,\n",
                 l.frames_in, l.frames_out, l.frames_refused, l.stale_stamp, l.clock_relocks);
    std::fprintf(
        f,
        "  \"bus_states\": %u, \"bus_states_beside\": %u, \"bus_reports_dropped\": %u, \"places_disagree\": %u, "
        "\"near_reported\": %u, \"tables_checked\": %u,\n",
        d.bus_states, d.bus_states_beside, d.bus_reports_dropped, d.places_disagree, d.near_reported, d.tables_checked);
    write_link(f, watched.endpoint, port);
    const app::ConstraintDiagnostics& a = coprocessor.constraint_diagnostics();
    std::fprintf(f, "  \"areas_reported\": %u, \"areas_refused\": %u, \"areas_merged\": %u, \"areas_grown\": %u,\n",
                 a.reported, a.refused, a.merged, a.grown);
    const app::ConstraintUploadDiagnostics& u = coprocessor.constraint_upload_diagnostics();
    std::fprintf(f, "  \"area_sets\": %u, \"area_sets_abandoned\": %u, \"area_parts_refused\": %u,\n", u.sets,
                 u.abandoned, u.refused);
    const world::MapSelection& map = coprocessor.known_map().selection();
    std::fprintf(f, "  \"map_pieces\": %u, \"map_boxes\": %u, \"map_coarse\": %u,\n", map.pieces, map.boxes,
                 d.map_coarse);
    if (watched.bus != nullptr) {
        write_bus(f, *watched.bus);
    }
    write_clouds(f, watched.clouds);
    const link::mavlink::ParserDiagnostics& p = watched.endpoint.parser_diagnostics();
    std::fprintf(f,
                 "  \"unsigned_refused\": %u, \"unsigned_taken\": %u, \"signed_unchecked\": %u, "
                 "\"wrong_signatures\": %u, \"stale_signatures\": %u, \"signature_streams_full\": %u,\n",
                 p.unsigned_refused, p.unsigned_taken, p.signed_unchecked, p.wrong_signature, p.stale_signature,
                 p.signature_streams);
    std::fprintf(f,
                 "  \"keys_set\": %u, \"keys_refused\": %u, \"signing_stored\": %u, \"signing_store_failures\": %u,\n",
                 l.keys_set, l.keys_refused, counts.signing_stores, counts.signing_store_failures);
    std::fprintf(f,
                 "  \"lines_dropped\": %u, \"airspace_reloads\": %u, \"airspace_reload_failures\": %u, "
                 "\"params_stored\": %u, \"params_store_failures\": %u,\n",
                 counts.dropped, counts.reloads, counts.reload_failures, counts.stores, counts.store_failures);
    const flightlog::LogCounts log = watched.log != nullptr ? watched.log->counts() : flightlog::LogCounts{};
    std::fprintf(f,
                 "  \"log_messages\": %u, \"log_messages_dropped\": %u, \"log_write_failures\": %u, "
                 "\"log_files\": %u, \"log_queue_peak\": %u,\n",
                 log.messages, log.dropped, log.write_failures, log.files, log.peak);
    std::fprintf(f, "  \"port_disconnects\": %llu, \"port_reconnects\": %llu\n}\n",
                 static_cast<unsigned long long>(port.disconnects), static_cast<unsigned long long>(port.reconnects));
    const bool written = std::fclose(f) == 0 && write_file(path, {text, size});
    std::free(text);
    return written;
}

}  // namespace jink::host
