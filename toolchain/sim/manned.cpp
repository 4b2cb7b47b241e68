// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/manned.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "toolchain/sim/in_process.hpp"
#include "toolchain/sim/random_scenario.hpp"
#include "toolchain/sim/scenario_file.hpp"
#include "toolchain/sim/uniform.hpp"

namespace jink::sim {
namespace {

constexpr double kMeetAfter = 75.0;  ///< [s]
constexpr std::size_t kTrackSeconds = 120;
constexpr double kLowest = 40.0;    ///< of the vehicle above ground [m]
constexpr double kHighest = 250.0;  ///< of the vehicle above ground [m]
constexpr double kSensorRange = 2000.0;
constexpr double kJudgeStep = 0.1;  ///< [s]
constexpr Volume kLargest{1.5 * kWellClearVolume.radius, 1.5 * kWellClearVolume.height};

double size_of(const Volume& v) { return v.radius * v.radius * v.height; }

bool is_inside(const Volume& v, const Vec& gap)
{
    return gap.head<2>().norm() < v.radius && std::abs(gap.z()) < v.height;
}

/// Evenly in `outer`, but not in `inner`.
Vec draw_between(Random& random, const Volume& outer, const Volume& inner)
{
    for (;;) {
        const double angle = uniform(random, -std::numbers::pi, std::numbers::pi);
        const double level = outer.radius * std::sqrt(static_cast<double>(random.uniform()));
        const Vec gap(level * std::cos(angle), level * std::sin(angle), uniform(random, -outer.height, outer.height));
        if (!is_inside(inner, gap)) {
            return gap;
        }
    }
}

/// The aircraft at time 0 at the origin of the level plane, its velocities second by second.
Threat flown_track(const ModelTrack& track, double heading)
{
    Threat threat;
    threat.name = "aircraft";
    threat.radius = 5.0;
    threat.position = Vec(0.0, 0.0, track.height);
    double course = heading;
    for (std::size_t i = 0; i < track.states.size(); ++i) {
        const ModelState& state = track.states[i];
        const double level = std::sqrt(std::max(0.0, state.speed * state.speed - state.climb * state.climb));
        const Vec velocity(level * std::cos(course), level * std::sin(course), state.climb);
        if (i == 0) {
            threat.velocity = velocity;
        } else {
            threat.turns.push_back({static_cast<double>(i), velocity});
        }
        course -= state.turn_rate;
    }
    return threat;
}

Vec nominal_at(const Scenario& s, double t) { return s.start_position + s.start_velocity * t; }

/// When the sensor sees the aircraft first, the vehicle being on its leg.
double first_seen(const Scenario& s)
{
    double t = 0.0;
    while (t < s.duration && (s.threats[0].position_at(t) - nominal_at(s, t)).norm() > kSensorRange) {
        t += kJudgeStep;
    }
    return t;
}

/// What happens between a flight and the aircraft. `position(t)` until `end`.
template <class Position>
void note(const Scenario& s, double end, Position&& position, bool& near, bool& lost)
{
    for (double t = 0.0; t < end && !near; t += kJudgeStep) {
        const Vec gap = s.threats[0].position_at(t) - position(t);
        near = is_inside(kNearMidAirVolume, gap);
        lost = lost || is_inside(kWellClearVolume, gap);
    }
}

bool keeps_clear(const Scenario& s, double from, const Vec& command)
{
    Truth truth;
    truth.position = nominal_at(s, from);
    truth.velocity = s.start_velocity;
    for (double t = from; t < s.duration; t += kJudgeStep) {
        move(truth, command, s.vehicle, kJudgeStep);
        const Vec gap = s.threats[0].position_at(t + kJudgeStep) - truth.position;
        if (is_inside(kNearMidAirVolume, gap) || truth.position.z() < *s.floor) {
            return false;
        }
    }
    return true;
}

bool is_avoidable(const Scenario& s)
{
    constexpr int kCourses = 16;
    const double from = s.threats[0].appears_at + s.traffic.latency;
    const double up = s.vehicle.max_climb;
    const double down = s.vehicle.max_descent;
    for (const double climb : {0.0, up, -down}) {
        const double level = std::sqrt(std::max(0.0, s.vehicle.cruise * s.vehicle.cruise - climb * climb));
        for (int i = 0; i < kCourses; ++i) {
            const double course = 2.0 * std::numbers::pi * i / kCourses;
            if (keeps_clear(s, from, Vec(level * std::cos(course), level * std::sin(course), climb))) {
                return true;
            }
        }
    }
    return keeps_clear(s, from, Vec::Zero()) || keeps_clear(s, from, up * Vec::UnitZ()) ||
           keeps_clear(s, from, -down * Vec::UnitZ());
}

/// Weighted frequencies of two events.
struct WeightedSum {
    double with = 0.0;
    double without = 0.0;
    [[nodiscard]] double ratio() const { return without > 0.0 ? with / without : 0.0; }
};

template <class Event, class Base>
Ratio ratio_of(const std::vector<MannedResult>& results, Event&& event, Base&& base)
{
    constexpr std::size_t kSamples = 1000;
    const auto counted = [&](auto&& pick) {
        WeightedSum sum;
        for (std::size_t i = 0; i < results.size(); ++i) {
            const MannedResult& r = results[pick(i)];
            sum.with += event(r) ? r.weight : 0.0;
            sum.without += base(r) ? r.weight : 0.0;
        }
        return sum.ratio();
    };
    Ratio out;
    const auto events = static_cast<std::size_t>(std::count_if(results.begin(), results.end(), event));
    const auto bases = static_cast<std::size_t>(std::count_if(results.begin(), results.end(), base));
    const double plain = std::min(1.0, share_of(std::min(events, bases), bases).high);
    if (events == 0) {
        out.high = plain;
        return out;
    }
    out.value = counted([](std::size_t i) { return i; });
    std::array<std::vector<std::size_t>, kMannedStrata> strata;
    for (std::size_t i = 0; i < results.size(); ++i) {
        strata[results[i].seed % kMannedStrata].push_back(i);
    }
    Random random(4711);
    std::vector<double> ratios;
    for (std::size_t k = 0; k < kSamples; ++k) {
        ratios.push_back(counted([&](std::size_t i) {
            const std::vector<std::size_t>& stratum = strata[results[i].seed % kMannedStrata];
            return stratum[random.below(static_cast<std::uint32_t>(stratum.size()))];
        }));
    }
    std::sort(ratios.begin(), ratios.end());
    out.low = quantile(ratios, 0.025);
    // Samples of a few events, of little weight as it may be, say nothing of those that have not been met yet.
    constexpr std::size_t kFew = 10;
    out.high = events < kFew ? std::max(quantile(ratios, 0.975), plain) : quantile(ratios, 0.975);
    return out;
}

}  // namespace

std::string_view to_string(MannedSensor sensor) noexcept { return sensor == MannedSensor::adsb ? "adsb" : "range"; }

MannedEncounter manned_encounter(const EncounterModel& model, MannedSensor sensor, std::uint64_t seed)
{
    constexpr int kTries = 10'000;
    Random random(seed * 86028121U + 7U);
    const std::array<Volume, kMannedStrata + 1> volumes{Volume{}, kNearMidAirVolume, kWellClearVolume, kLargest};
    const std::size_t stratum = seed % kMannedStrata;
    const Volume& outer = volumes[stratum + 1];
    const Volume& inner = volumes[stratum];
    MannedEncounter out;
    Scenario& s = out.scenario;
    out.weight = static_cast<double>(kMannedStrata) * (size_of(outer) - size_of(inner)) / size_of(kLargest);
    const Vec gap = draw_between(random, outer, inner);  // from the aircraft to the vehicle
    Threat aircraft;
    Vec meeting = Vec::Zero();
    s.vehicle.cruise = uniform(random, 5.0, 15.0);
    s.start_velocity = Vec(s.vehicle.cruise, 0.0, 0.0);
    bool found = false;
    for (int i = 0; i < kTries && !found; ++i) {
        const ModelTrack track = model.sample(random, kTrackSeconds);
        aircraft = flown_track(track, uniform(random, -std::numbers::pi, std::numbers::pi));
        meeting = aircraft.position_at(kMeetAfter) + gap;
        const Vec start = meeting - kMeetAfter * s.start_velocity;
        found = meeting.z() >= kLowest && meeting.z() <= kHighest &&
                !is_inside(kWellClearVolume, aircraft.position_at(0.0) - start);
    }
    if (!found) {
        throw std::runtime_error("no track of this model is low enough and begins well clear");
    }
    s.name = "manned_" + std::to_string(seed);
    s.title = "a manned aircraft, seed " + std::to_string(seed);
    s.seed = seed;
    s.stack = random.below(2) == 0 ? Stack::ardupilot : Stack::px4;
    s.start_position = Vec(0.0, 0.0, meeting.z());
    s.duration = static_cast<double>(kTrackSeconds);
    s.mission = {s.start_position, s.start_position + 2.0 * s.duration * s.start_velocity};
    s.to_goal = true;
    s.floor = 1.0;
    const Vec shift = nominal_at(s, kMeetAfter) - meeting;
    aircraft.position += Vec(shift.x(), shift.y(), 0.0);
    s.threats.push_back(aircraft);
    s.traffic.latency = 0.3;
    s.traffic.jitter = 0.1;
    s.traffic.dropout = 0.05;
    s.traffic.rate = 1.0;
    s.traffic.quantised = sensor == MannedSensor::adsb;
    s.traffic.sigma_position = 3.0;
    s.traffic.sigma_velocity = 0.5;
    if (sensor == MannedSensor::range) {
        s.traffic.rate = 2.0;
        s.traffic.sigma_position = 10.0;
        s.traffic.sigma_velocity = 1.0;
        s.threats[0].appears_at = first_seen(s);
    }
    s.parameters["VEH_CRUISE"] = s.vehicle.cruise;
    s.parameters["JNK_WELL_CLEAR"] = 610.0;
    s.parameters["JNK_WELL_HEIGHT"] = 76.0;
    s.parameters["JNK_KEEP_IN"] = 50'000.0;
    s.parameters["TRK_SIGMA_P"] = s.traffic.sigma_position;
    s.parameters["TRK_SIGMA_V"] = s.traffic.sigma_velocity;
    s.parameters["TRK_AGE"] = 5.0;
    default_radii(s);
    return out;
}

MannedResult fly_manned(const EncounterModel& model, MannedSensor sensor, std::uint64_t seed,
                        const std::map<std::string, double>& parameters, const Board& board)
{
    MannedEncounter encounter = manned_encounter(model, sensor, seed);
    Scenario& s = encounter.scenario;
    s.board = board;
    for (const auto& [name, value] : parameters) {
        s.parameters[name] = value;
    }
    MannedResult r;
    r.seed = seed;
    r.weight = encounter.weight;
    note(
        s, s.duration, [&](double t) { return nominal_at(s, t); }, r.near_alone, r.lost_alone);
    r.unavoidable = r.near_alone && !is_avoidable(s);
    const Record record = fly_in_process(s);
    const std::vector<Sample>& samples = record.samples;
    std::size_t at = 0;
    note(
        s, record.duration,
        [&](double t) {
            while (at + 1 < samples.size() && samples[at].time < t) {
                ++at;
            }
            return samples[at].position;
        },
        r.near, r.lost);
    r.took_over = record.takeovers > 0;
    // The flight ends with the track, whoever is in control then: that is reported as a fault.
    r.broke_rule = record.faults.size() > (record.final_mode == Mode::external ? 1U : 0U);
    return r;
}

MannedSummary summary_of(const std::vector<MannedResult>& results)
{
    MannedSummary sum;
    sum.flown = results.size();
    for (const MannedResult& r : results) {
        sum.near_alone += r.near_alone ? 1U : 0U;
        sum.near += r.near ? 1U : 0U;
        sum.lost_alone += r.lost_alone ? 1U : 0U;
        sum.lost += r.lost ? 1U : 0U;
        sum.unavoidable_count += r.unavoidable ? 1U : 0U;
        sum.took_over += r.took_over ? 1U : 0U;
        sum.broken_rules += r.broke_rule ? 1U : 0U;
    }
    const auto near_alone = [](const MannedResult& r) { return r.near_alone; };
    sum.near_mid_air = ratio_of(
        results, [](const MannedResult& r) { return r.near; }, near_alone);
    sum.well_clear = ratio_of(
        results, [](const MannedResult& r) { return r.lost; }, [](const MannedResult& r) { return r.lost_alone; });
    sum.unavoidable = ratio_of(
        results, [](const MannedResult& r) { return r.unavoidable; }, near_alone);
    return sum;
}

}  // namespace jink::sim
