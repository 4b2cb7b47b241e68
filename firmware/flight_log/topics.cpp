// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/flight_log/topics.hpp"

#include <limits>

namespace jink::flightlog {
namespace {

constexpr std::array kAppCounters = std::to_array<Counter<app::Diagnostics>>({
    {"steps", &app::Diagnostics::steps},
    {"deadlines_missed", &app::Diagnostics::deadlines_missed},
    {"setpoints", &app::Diagnostics::setpoints},
    {"setpoints_withheld", &app::Diagnostics::setpoints_withheld},
    {"own_states", &app::Diagnostics::own_states},
    {"own_state_refused", &app::Diagnostics::own_state_refused},
    {"estimator_resets", &app::Diagnostics::estimator_resets},
    {"autopilot_reboots", &app::Diagnostics::autopilot_reboots},
    {"params_set", &app::Diagnostics::params_set},
    {"params_refused", &app::Diagnostics::params_refused},
    {"params_unknown", &app::Diagnostics::params_unknown},
    {"commands", &app::Diagnostics::commands},
    {"commands_refused", &app::Diagnostics::commands_refused},
    {"scans", &app::Diagnostics::scans},
    {"readings", &app::Diagnostics::readings},
    {"readings_refused", &app::Diagnostics::readings_refused},
    {"tracks_in", &app::Diagnostics::tracks_in},
    {"own_heard", &app::Diagnostics::own_heard},
    {"legs_dropped", &app::Diagnostics::legs_dropped},
    {"faults", &app::Diagnostics::faults},
    {"bus_states", &app::Diagnostics::bus_states},
    {"bus_states_beside", &app::Diagnostics::bus_states_beside},
    {"bus_states_refused", &app::Diagnostics::bus_states_refused},
    {"bus_reports_dropped", &app::Diagnostics::bus_reports_dropped},
    {"places_disagree", &app::Diagnostics::places_disagree},
    {"frame_changes", &app::Diagnostics::frame_changes},
    {"origin_changes", &app::Diagnostics::origin_changes},
    {"tracks_not_moved", &app::Diagnostics::tracks_not_moved},
    {"near_reported", &app::Diagnostics::near_reported},
    {"tables_checked", &app::Diagnostics::tables_checked},
    {"map_coarse", &app::Diagnostics::map_coarse},
});
static_assert(sizeof(app::Diagnostics) == kAppCounters.size() * sizeof(std::uint32_t), "a counter is missing");

constexpr std::array kAvoidCounters = std::to_array<Counter<avoid::Diagnostics>>({
    {"updates", &avoid::Diagnostics::updates},
    {"conflicts", &avoid::Diagnostics::conflicts},
    {"plans", &avoid::Diagnostics::plans},
    {"plans_found", &avoid::Diagnostics::plans_found},
    {"found_by_next", &avoid::Diagnostics::found_by_next},
    {"answers_rejected", &avoid::Diagnostics::answers_rejected},
    {"manoeuvres", &avoid::Diagnostics::manoeuvres},
    {"replans", &avoid::Diagnostics::replans},
    {"flips", &avoid::Diagnostics::flips},
    {"brakes", &avoid::Diagnostics::brakes},
    {"escapes", &avoid::Diagnostics::escapes},
    {"held_back", &avoid::Diagnostics::held_back},
    {"gave_way", &avoid::Diagnostics::gave_way},
    {"holds", &avoid::Diagnostics::holds},
    {"rejoined", &avoid::Diagnostics::rejoined},
    {"on_other", &avoid::Diagnostics::on_other},
    {"kept_control", &avoid::Diagnostics::kept_control},
    {"for_stop", &avoid::Diagnostics::for_stop},
    {"blocked", &avoid::Diagnostics::blocked},
    {"control_lost", &avoid::Diagnostics::control_lost},
    {"budget_spent", &avoid::Diagnostics::budget_spent},
    {"most_work", &avoid::Diagnostics::most_work},
});
static_assert(sizeof(avoid::Diagnostics) == kAvoidCounters.size() * sizeof(std::uint32_t), "a counter is missing");

}  // namespace

std::span<const Counter<app::Diagnostics>> app_counters() noexcept { return kAppCounters; }
std::span<const Counter<avoid::Diagnostics>> avoid_counters() noexcept { return kAvoidCounters; }

StepTopic step_topic(const app::StepReport& r, TimePoint now) noexcept
{
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    const avoid::Guidance& g = r.guidance;
    StepTopic t;
    t.timestamp = static_cast<std::uint64_t>(now.us);
    t.bytes_in = r.bytes_in;
    t.bytes_out = r.bytes_out;
    t.work = r.work;
    t.transitions = g.transitions;
    t.conflict_id = r.conflict_track;
    t.velocity = xyz_of(g.velocity);
    t.margin = g.margin;
    t.cost = g.cost;
    t.conflict_time = g.conflict ? g.conflict->time_to_loss : kNone;
    t.conflict_closest_time = g.conflict ? g.conflict->time_to_closest : kNone;
    t.conflict_margin = g.conflict ? g.conflict->margin : kNone;
    t.conflict_miss = g.conflict ? g.conflict->miss_distance : kNone;
    t.faults = r.faults;
    t.tracks = r.tracks;
    t.uncertain_heights = r.uncertain_heights;
    t.obstacles = r.obstacles;
    t.map_pieces = r.map_pieces;
    t.areas = r.cylinders;
    t.conflict_index = g.conflict ? g.conflict->threat.index : std::uint16_t{0};
    t.state = static_cast<std::uint8_t>(r.state);
    t.control = static_cast<std::uint8_t>(r.control);
    t.own_source = static_cast<std::uint8_t>(r.own_source);
    t.guidance = static_cast<std::uint8_t>(g.state);
    t.kind = static_cast<std::uint8_t>(g.kind);
    t.plan_status = static_cast<std::uint8_t>(g.plan_status);
    t.by = g.by;
    t.answers = g.answers;
    t.alert = static_cast<std::uint8_t>(g.alert);
    t.conflict_kind = g.conflict ? static_cast<std::uint8_t>(g.conflict->threat.kind) : std::uint8_t{0};
    t.deadline_missed = r.deadline_missed;
    t.setpoint_sent = r.setpoint_sent;
    t.wants_control = g.wants_control;
    t.new_manoeuvre = g.new_manoeuvre;
    t.on_other = g.on_other;
    t.other_conflict = g.other_conflict;
    t.blocked = g.blocked;
    return t;
}

DecisionTopic decision_topic(const app::StepReport& report, const Vec3& own, const geometric::Result* plan,
                             TimePoint now, std::uint32_t number) noexcept
{
    using geometric::CandidateStatus;
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    DecisionTopic t;
    t.timestamp = static_cast<std::uint64_t>(now.us);
    t.decision = number;
    t.start = xyz_of(own);
    t.own_at_closest = t.threat_at_closest = {kNone, kNone, kNone};
    t.radius_at_closest = kNone;
    if (const auto& conflict = report.guidance.conflict) {
        t.own_at_closest = xyz_of(conflict->own_at_closest);
        t.threat_at_closest = xyz_of(conflict->threat_at_closest);
        t.radius_at_closest = conflict->radius_at_closest;
    }
    if (plan != nullptr) {
        t.candidates = static_cast<std::uint16_t>(plan->candidates.size());
        if (plan->chosen < plan->candidates.size() &&
            plan->candidates[plan->chosen].status == CandidateStatus::chosen) {
            t.chosen = static_cast<std::uint16_t>(plan->chosen);
        }
    }
    return t;
}

CandidateTopic candidate_topic(const geometric::Result& plan, std::size_t index, TimePoint now,
                               std::uint32_t decision) noexcept
{
    const geometric::Candidate& c = plan.candidates[index];
    CandidateTopic t;
    t.timestamp = static_cast<std::uint64_t>(now.us);
    t.decision = decision;
    t.index = static_cast<std::uint16_t>(index);
    t.attempt = static_cast<std::uint8_t>(plan.attempt);
    t.plane = c.shape.plane;
    t.offset = c.shape.offset;
    t.share = c.shape.share;
    t.until = c.shape.until;
    t.duration = c.duration;
    t.cost = c.total;
    t.flip_penalty = c.flip_penalty;
    t.time = c.terms.time;
    t.smoothness = c.terms.smoothness;
    t.closeness = c.terms.closeness;
    t.hit_index = c.hit.index;
    t.family = static_cast<std::uint8_t>(c.shape.family);
    t.status = static_cast<std::uint8_t>(c.status);
    t.hit_kind = static_cast<std::uint8_t>(c.hit.kind);
    return t;
}

}  // namespace jink::flightlog
