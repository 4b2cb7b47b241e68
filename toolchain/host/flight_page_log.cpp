// SPDX-License-Identifier: BSD-3-Clause
// The flight of a flight log of jinkd (docs/guides/flight_log.md), sampled at 10 Hz.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

#include "firmware/app/takeover.hpp"
#include "firmware/linux/flight_log/topics.hpp"
#include "firmware/linux/flight_log/ulog_reader.hpp"
#include "toolchain/host/flight_page.hpp"
#include "toolchain/host/flight_page_samples.hpp"
#include "toolchain/host/log_fields.hpp"
#include "toolchain/host/log_summary.hpp"
#include "toolchain/host/nominal_log.hpp"
#include "toolchain/host/shape_log.hpp"

namespace jink::host {
namespace {

using geometric::CandidateStatus;

constexpr double kPeriod = 0.1;           // of samples [s]
constexpr double kLongest = 24 * 3600.0;  // of a flight [s]

struct StepAt {
    double time = 0.0;
    std::array<double, 3> command{};
    bool in_control = false;
    double work = 0.0;
};

void push(Columns3& columns, const std::array<double, 3>& point)
{
    columns.x.push_back(point[0]);
    columns.y.push_back(point[1]);
    columns.z.push_back(point[2]);
}

std::array<double, 3> unknown() { return {kUnknown, kUnknown, kUnknown}; }

/// Reads one log and keeps what the page shows.
class LogFlight {
public:
    explicit LogFlight(const std::filesystem::path& file) : file_(file) { read(); }
    [[nodiscard]] PageFlight page();

private:
    void read();
    void note_data(const ulog::Format& format, std::span<const std::byte> content);
    void note_parameter(std::span<const std::byte> content);
    void note_step(const LogFields& step, double time);
    void note_decision(const LogFields& topic, double time);
    void note_candidate(const LogFields& topic, double time);
    PageDecision& decision(unsigned number, double time);
    void note_text(std::span<const std::byte> content);
    void sample(PageFlight& flight) const;
    void add_tracks(PageFlight& flight) const;
    void settle_fates();
    /// Seconds since the log's first step; nothing before it, and where time goes backwards.
    [[nodiscard]] std::optional<double> time_of(double microseconds);
    [[noreturn]] void refuse(const std::string& why) const { throw BadFlight(file_.string() + ": " + why); }

    /// Of a decision's own message.
    struct Made {
        std::array<double, 3> start{}, to{};  ///< of the curves of its candidates; not finite: unknown
        double candidates = kUnknown;         ///< of its plan; unknown: the log does not say
        double max_cost = 1.0;                ///< GEO_MAX_COST then
        bool has_chosen = false;              ///< one of them
    };

    std::filesystem::path file_;
    PageFlight flight_;
    double max_cost_ = 1.0;
    double start_ = kUnknown;
    double last_ = 0.0;
    std::vector<OwnAt> own_;
    std::vector<StepAt> steps_;
    std::map<std::pair<unsigned, unsigned>, std::vector<Sighting>> tracks_;  // by id and instance
    std::map<unsigned, std::size_t> decision_of_;                    // number in the log: index in flight_.decisions
    std::map<unsigned, Made> made_;                                  // by the number too; those whose message is there
    std::vector<std::pair<float, NominalLog>> nominal_{{8.0F, {}}};  // one for each value of JNK_LOOKAHEAD
    ShapeLog shapes_;
    unsigned control_ = 0xFFFF;
};

std::optional<double> LogFlight::time_of(double microseconds)
{
    const double time = (microseconds - start_) * 1e-6;
    if (!(time >= last_)) {
        return std::nullopt;
    }
    if (time > kLongest) {
        refuse("lasts longer than 24 h at one step: its times are damaged");
    }
    last_ = time;
    return time;
}

void LogFlight::note_step(const LogFields& step, double time)
{
    const unsigned control = step.code("control");
    StepAt at;
    at.time = time;
    at.in_control = control == static_cast<unsigned>(app::Control::ours) ||
                    control == static_cast<unsigned>(app::Control::returning);
    at.command = step.code("wants_control") != 0 ? step.vector("velocity") : unknown();
    at.work = step.number("work");
    steps_.push_back(at);
    shapes_.note_step(time, step.code("obstacles") > 0 || step.code("areas") > 0);
    if (control != control_) {
        control_ = control;
        flight_.phases.push_back(
            {time, std::string(flightlog::name_of(static_cast<app::Control>(control))), at.in_control});
    }
}

PageDecision& LogFlight::decision(unsigned number, double time)
{
    const auto [entry, is_new] = decision_of_.try_emplace(number, flight_.decisions.size());
    if (is_new) {
        flight_.decisions.emplace_back();
        flight_.decisions.back().time = time;
    }
    return flight_.decisions[entry->second];
}

void LogFlight::note_decision(const LogFields& topic, double time)
{
    const unsigned number = topic.code("decision");
    static_cast<void>(decision(number, time));
    made_[number] = {topic.vector("start"), topic.vector("own_at_closest"), topic.number("candidates"), max_cost_,
                     topic.number("chosen") < flightlog::DecisionTopic::kNoneChosen};
}

void LogFlight::note_candidate(const LogFields& topic, double time)
{
    const unsigned number = topic.code("decision");
    PageDecision& of = decision(number, time);
    const auto made = made_.find(number);
    if (made == made_.end()) {  // the log lost its message: neither its curve nor how many there are is known
        return;
    }
    PageCandidate& candidate = of.candidates.emplace_back();
    const bool has_cost = topic.number("time") > 0.0;
    candidate.cost = has_cost ? topic.number("cost") : kUnknown;
    candidate.fate = flightlog::fate_of(static_cast<CandidateStatus>(topic.code("status")));  // settle_fates
    const unsigned family = topic.code("family");
    if (family < geometric::kFamilies.size()) {
        geometric::CandidateShape shape;
        shape.family = static_cast<geometric::Family>(family);
        shape.plane = static_cast<float>(topic.number("plane"));
        shape.offset = static_cast<float>(topic.number("offset"));
        candidate.points = flightlog::candidate_curve(shape, made->second.start, made->second.to);
    }
}

/// What the whole set of a decision's candidates says, or the decision in place of those that the log lost. A log of
/// before says neither how many there are nor which one was chosen: it has all of them.
void LogFlight::settle_fates()
{
    for (const auto& [number, made] : made_) {
        PageDecision& decision = flight_.decisions[decision_of_.at(number)];
        decision.known = std::fmax(made.candidates, static_cast<double>(decision.candidates.size()));
        const bool found =
            made.has_chosen || std::any_of(decision.candidates.begin(), decision.candidates.end(),
                                           [](const PageCandidate& c) { return c.fate == Fate::chosen; });
        for (PageCandidate& c : decision.candidates) {
            if (c.fate == Fate::budget_spent) {
                c.fate = fate_of_unchecked(std::isfinite(c.cost), found, c.cost > made.max_cost);
            }
        }
    }
}

void LogFlight::note_text(std::span<const std::byte> content)
{
    const auto time = time_of(static_cast<double>(ulog::read_number<std::uint64_t>(content.subspan(1))));
    if (!time) {
        return;
    }
    const std::string text = log_text(ulog::text_of(content.subspan(9)));
    const bool is_own = text.starts_with("state ") || text.starts_with("control ") || text.starts_with("guidance ");
    flight_.events.push_back({*time, is_own ? "state" : "text", text});
}

void LogFlight::note_data(const ulog::Format& format, std::span<const std::byte> content)
{
    const auto stamp = static_cast<double>(ulog::read_number<std::uint64_t>(content));
    if (!(start_ <= stamp) && !(format.name == "jink_step" && steps_.empty())) {
        return;
    }
    start_ = steps_.empty() && format.name == "jink_step" ? stamp : start_;
    const auto time = time_of(stamp);
    if (!time) {
        return;
    }
    const LogFields fields(format, content);
    if (format.name == "jink_step") {
        note_step(fields, *time);
    } else if (format.name == "jink_own") {
        own_.push_back({*time, fields.vector("position"), fields.vector("velocity")});
    } else if (format.name == "jink_track") {
        tracks_[{fields.code("id"), fields.code("instance")}].push_back(
            {*time, fields.vector("position"), fields.vector("velocity"), fields.number("radius"),
             fields.number("half_height")});
    } else if (format.name == "jink_decision") {
        note_decision(fields, *time);
    } else if (format.name == "jink_candidate") {
        note_candidate(fields, *time);
    } else if (format.name == "jink_nominal") {
        nominal_.back().second.note(fields, *time);
    } else if (format.name == "jink_obstacle") {
        shapes_.note_obstacle(fields, *time);
    } else if (format.name == "jink_area") {
        shapes_.note_area(fields, *time);
    }
}

/// Of the definitions, or a change in the flight: what the log has from here on was decided by it.
void LogFlight::note_parameter(std::span<const std::byte> content)
{
    const auto keyed = ulog::parse_keyed(content, ulog::Type::parameter);
    const double value = keyed ? static_cast<double>(keyed->number().value_or(NAN)) : kUnknown;
    if (!std::isfinite(value)) {
        return;
    }
    if (keyed->name == "JNK_HALF_XY" && steps_.empty()) {
        flight_.safety_distance = value;
    } else if (keyed->name == "GEO_MAX_COST") {
        max_cost_ = value;
    } else if (keyed->name == "JNK_LOOKAHEAD") {
        nominal_.emplace_back(static_cast<float>(value), NominalLog());
    }
}

/// The common samples: what was known last, carried forward with its velocity.
void LogFlight::sample(PageFlight& flight) const
{
    const auto samples = static_cast<std::size_t>(std::floor(steps_.back().time / kPeriod + 1e-6)) + 1;
    std::size_t step = 0;
    for (std::size_t i = 0; i < samples; ++i) {
        const double time = kPeriod * static_cast<double>(i);
        flight.t.push_back(time);
        const OwnAt* const own = latest(own_, time, kTrackLife);
        push(flight.own, own != nullptr ? carried(*own, time) : unknown());
        push(flight.velocity, own != nullptr ? own->velocity : unknown());
        double work = kUnknown;
        for (; step < steps_.size() && steps_[step].time <= time + 1e-9; ++step) {
            work = std::max(steps_[step].work, std::isnan(work) ? 0.0 : work);
        }
        flight.work.push_back(work);
        const StepAt* const last = latest(steps_, time + 1e-9, kTrackLife);
        push(flight.command, last != nullptr ? last->command : unknown());
    }
    flight.separation.assign(samples, kUnknown);
}

void LogFlight::add_tracks(PageFlight& flight) const
{
    for (const auto& [key, sightings] : tracks_) {
        PageThreat threat;
        threat.name = track_name(key.first, key.second);
        threat.radius = std::max(0.0, sightings.front().radius);
        threat.half_height = std::max(0.0, sightings.front().half_height);
        threat.moves = true;
        threat.first = static_cast<std::size_t>(std::ceil(sightings.front().time / kPeriod - 1e-6));
        flight.events.push_back({sightings.front().time, "threat", threat.name + " is known"});
        for (std::size_t i = threat.first; i < flight.t.size() && flight.t[i] <= sightings.back().time + kTrackLife;
             ++i) {
            const Sighting* const seen = latest(sightings, flight.t[i] + 1e-9, kTrackLife);
            const std::array<double, 3> at = seen != nullptr ? carried(*seen, flight.t[i]) : unknown();
            push(threat.position, at);
            if (seen == nullptr) {
                continue;
            }
            const double distance = distance_to_surface({flight.own.x[i], flight.own.y[i], flight.own.z[i]}, at, *seen);
            if (distance < flight.separation[i] || (std::isnan(flight.separation[i]) && !std::isnan(distance))) {
                flight.separation[i] = distance;
            }
            if (distance < flight.least || (std::isnan(flight.least) && !std::isnan(distance))) {
                flight.least = distance;
                flight.least_time = flight.t[i];
                flight.least_threat = threat.name;
            }
        }
        flight.threats.push_back(std::move(threat));
    }
}

void LogFlight::read()
{
    std::ifstream in(file_, std::ios::binary);
    if (!in || !std::filesystem::is_regular_file(file_)) {
        refuse("cannot be read");
    }
    ulog::Reader log(in);
    while (const auto message = log.next()) {
        const std::span<const std::byte> content = message->content;
        if (message->type == ulog::Type::data) {
            note_data(*log.topic(ulog::read_number<std::uint16_t>(content)), content.subspan(2));
        } else if (message->type == ulog::Type::parameter) {
            note_parameter(content);
        } else if (message->type == ulog::Type::text && !steps_.empty()) {
            note_text(content);
        }
    }
    if (log.end() == ulog::End::not_ulog || log.end() == ulog::End::refused) {
        refuse(std::string(ulog::to_string(log.end())));
    }
    if (log.end() != ulog::End::complete) {
        flight_.complaints.push_back("the log is " + std::string(ulog::to_string(log.end())) + " at byte " +
                                     std::to_string(log.offset()) + "; shown until there");
    }
    if (steps_.empty()) {
        refuse("no step of jinkd (topic jink_step) before byte " + std::to_string(log.offset()));
    }
    flight_.origin = "flight log, " + log_text(log.info("sys_name")) + " " + log_text(log.info("ver_sw"));
}

PageFlight LogFlight::page()
{
    flight_.name = file_.stem().string();
    flight_.title = flight_.name;
    flight_.safety_text = "half extent of the safety box, JNK_HALF_XY";
    settle_fates();
    sample(flight_);
    add_tracks(flight_);
    flight_.shapes = shapes_.shapes();
    const auto own_at = [&](double time) {
        const OwnAt* const own = latest(own_, time, kTrackLife);
        const std::array<double, 3> at = own != nullptr ? carried(*own, time) : unknown();
        return Vec3(static_cast<float>(at[0]), static_cast<float>(at[1]), static_cast<float>(at[2]));
    };
    for (const auto& [lookahead, log] : nominal_) {
        std::vector<PageNominal> curves = log.curves(own_at, lookahead);
        std::move(curves.begin(), curves.end(), std::back_inserter(flight_.nominal));
    }
    if (flight_.least == flight_.least) {
        flight_.events.push_back({flight_.least_time, "closest", "closest to " + flight_.least_threat});
    }
    for (PageDecision& decision : flight_.decisions) {
        for (const PageEvent& event : flight_.events) {
            if (event.time == decision.time && event.text.starts_with("guidance ")) {
                decision.text = event.text;
            }
        }
    }
    std::stable_sort(flight_.events.begin(), flight_.events.end(),
                     [](const PageEvent& a, const PageEvent& b) { return a.time < b.time; });
    return std::move(flight_);
}

}  // namespace

PageSource read_flight_log(const std::filesystem::path& file)
{
    PageSource source{file.string(), {}};
    source.flights.push_back(LogFlight(file).page());
    return source;
}

}  // namespace jink::host
