// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/encounter_summary.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <functional>
#include <string_view>
#include <tuple>

#include "toolchain/sim/report.hpp"
#include "toolchain/sim/statistics.hpp"

namespace jink::sim {
namespace {

using Results = std::vector<EncounterResult>;
using Test = std::function<bool(const EncounterResult&)>;
using Value = std::function<double(const EncounterResult&)>;

constexpr std::size_t kWorst = 10;
constexpr unsigned kMaxIntruders = 8;

void line(std::string& text, std::string_view whole) { text.append(whole).append("\n"); }

template <class First, class... Values>
void line(std::string& text, const char* format, First first, Values... values)
{
    std::array<char, 400> buffer{};
    const int n = std::snprintf(buffer.data(), buffer.size(), format, first, values...);
    text.append(buffer.data(), std::min(static_cast<std::size_t>(n), buffer.size() - 1)).append("\n");
}

std::size_t count_if(const Results& results, const Test& test)
{
    return static_cast<std::size_t>(std::count_if(results.begin(), results.end(), test));
}

/// Sum over the results, in their order.
double sum_of(const Results& results, const Value& value)
{
    double sum = 0.0;
    for (const EncounterResult& r : results) {
        sum += value(r);
    }
    return sum;
}

bool broke_promise(const EncounterResult& r) { return r.outcome == Outcome::breach || r.outcome == Outcome::collision; }

void put_share(std::string& text, const char* what, std::size_t count, std::size_t all)
{
    const Share share = share_of(count, all);
    line(text, "  %-58s %8zu of %8zu  %9.4f %%  [%.4f, %.4f]", what, count, all, 100.0 * share.value, 100.0 * share.low,
         100.0 * share.high);
}

void put_outcomes(std::string& text, EncounterKind kind, const Results& results)
{
    line(text, "Outcomes: count, share, 95 % interval (Wilson; rule of three at none and at all)");
    for (const Outcome outcome :
         {Outcome::clear, Outcome::avoided, Outcome::braked, Outcome::breach, Outcome::collision, Outcome::failed}) {
        put_share(text, std::string(to_string(outcome)).c_str(),
                  count_if(results, [&](const EncounterResult& r) { return r.outcome == outcome; }), results.size());
    }
    for (const Stack stack : {Stack::ardupilot, Stack::px4}) {
        const auto flew = [stack](const EncounterResult& r) { return r.stack == stack; };
        put_share(text, ("... avoided with " + std::string(to_string(stack))).c_str(),
                  count_if(results, [&](const EncounterResult& r) { return flew(r) && r.outcome == Outcome::avoided; }),
                  count_if(results, flew));
    }
    if (flies_to_goal(kind)) {
        const auto missed = [](const EncounterResult& r) { return r.goal_at < 0.0; };
        put_share(text, "goal not reached", count_if(results, missed), results.size());
        put_share(
            text, "... at the end of a flight that braked",
            count_if(results, [&](const EncounterResult& r) { return missed(r) && r.outcome == Outcome::braked; }),
            results.size());
    }
}

static_assert(kReaction == 0.05, "as the texts below have it");

void put_promises(std::string& text, const Results& results)
{
    const std::size_t all = results.size();
    line(text, "\nThe promise, and what the judge says of it");
    put_share(text, "broken (breach or collision)", count_if(results, broke_promise), all);
    put_share(text, "... avoidable", count_avoidable(results), all);
    put_share(text, "... collisions that were avoidable",
              count_if(results,
                       [](const EncounterResult& r) { return r.failed_avoidable && r.outcome == Outcome::collision; }),
              all);
    put_share(text, "... avoidable also 0.05 s later",
              count_if(results, [](const EncounterResult& r) { return r.failed_avoidable && r.late_keep > 0; }), all);
    // Compared with the default Scenario::promise, which all encounters use.
    put_share(text, "... avoidable, and broken without the sensors' noise too",
              count_if(results,
                       [](const EncounterResult& r) { return r.failed_avoidable && r.noiseless < Scenario{}.promise; }),
              all);
    put_share(text, "... detected too late",
              count_if(results, [](const EncounterResult& r) { return r.reported_too_late; }), all);
    put_share(text, "... detected in time, but none of the judge's ways kept it",
              count_if(results,
                       [](const EncounterResult& r) {
                           return broke_promise(r) && !r.failed_avoidable && !r.reported_too_late;
                       }),
              all);
    const std::size_t conflicts = count_if(results, [](const EncounterResult& r) { return r.conflict; });
    put_share(text, "mission in conflict, once somebody had been told", conflicts, all);
    put_share(text, "... avoidable at that instant",
              count_if(results, [](const EncounterResult& r) { return r.conflict && r.avoidable; }), conflicts);
    put_share(text, "without a co-processor the promise would be broken",
              count_if(results, [](const EncounterResult& r) { return r.alone < 0.7; }), all);
}

void put_quantiles(std::string& text, const Results& results, const char* what, const Value& value)
{
    std::vector<double> sorted;
    for (const EncounterResult& r : results) {
        sorted.push_back(value(r));
    }
    std::sort(sorted.begin(), sorted.end());
    std::string row;
    std::array<char, 32> cell{};
    std::snprintf(cell.data(), cell.size(), "  %-28s", what);
    row.append(cell.data());
    for (const double share : {0.0, 0.001, 0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99, 1.0}) {
        std::snprintf(cell.data(), cell.size(), " %9.2f", quantile(sorted, share));
        row.append(cell.data());
    }
    std::snprintf(cell.data(), cell.size(), " %9.2f", sum_of(results, value) / static_cast<double>(results.size()));
    text.append(row).append(cell.data()).append("\n");
}

void put_measures(std::string& text, const Results& results)
{
    line(text, "\n  %-28s %9s %9s %9s %9s %9s %9s %9s %9s %9s %9s %9s", "Quantiles", "least", "0.1 %", "1 %", "5 %",
         "25 %", "50 %", "75 %", "95 %", "99 %", "most", "mean");
    put_quantiles(text, results, "separation [m]", [](const EncounterResult& r) { return r.separation; });
    put_quantiles(text, results, "deviation, most [m]", [](const EncounterResult& r) { return r.deviation_most; });
    put_quantiles(text, results, "deviation, rms [m]", [](const EncounterResult& r) { return r.deviation_rms; });
    put_quantiles(text, results, "detour [m]", [](const EncounterResult& r) { return r.detour; });
    put_quantiles(text, results, "acceleration^2 [m2/s3]", [](const EncounterResult& r) { return r.acceleration; });
    put_quantiles(text, results, "jerk^2 [m2/s5]", [](const EncounterResult& r) { return r.jerk; });
    put_quantiles(text, results, "under control [s]", [](const EncounterResult& r) { return r.away; });
    put_quantiles(text, results, "duration [s]", [](const EncounterResult& r) { return r.duration; });
    Results answered;
    std::copy_if(results.begin(), results.end(), std::back_inserter(answered),
                 [](const EncounterResult& r) { return r.to_answer.first > 0; });
    if (!answered.empty()) {
        put_quantiles(text, answered, "first answer [steps]",
                      [](const EncounterResult& r) { return r.to_answer.first; });
        put_quantiles(text, answered, "slowest answer [steps]",
                      [](const EncounterResult& r) { return r.to_answer.slowest; });
        put_quantiles(text, answered, "with failed plans [steps]",
                      [](const EncounterResult& r) { return r.to_answer.from_first_plan; });
    }
}

void put_side_counts(std::string& text, const Results& results, const char* which, SideCounts EncounterResult::*counts)
{
    SideCounts sum;
    for (const EncounterResult& r : results) {
        const SideCounts& one = r.*counts;
        sum.conflicts += one.conflicts;
        sum.same_picture += one.same_picture;
        sum.changed_picture += one.changed_picture;
        sum.broken += one.broken;
        sum.most_same = std::max(sum.most_same, one.most_same);
    }
    line(text, "  %s: stretches of control %u, changes with a changed picture %u, with the same picture %u", which,
         sum.conflicts, sum.changed_picture, sum.same_picture);
    put_share(text, "... stretches with two or more of the same picture", sum.broken, sum.conflicts);
    line(text, "  ... most of the same picture in one stretch: %u", sum.most_same);
}

void put_sides(std::string& text, const Results& results)
{
    line(text, "\nChanges of side (side_log.hpp)");
    put_side_counts(text, results, "chosen, the promise", &EncounterResult::chosen_sides);
    put_side_counts(text, results, "flown, with steep ways back to the leg", &EncounterResult::sides);
    put_share(text, "flights longer than 40 s",
              count_if(results, [](const EncounterResult& r) { return r.duration > 40.0; }), results.size());
    put_share(text, "flights that took control more than once",
              count_if(results, [](const EncounterResult& r) { return r.takeovers > 1; }), results.size());
}

void put_intruders(std::string& text, const char* what, const Results& results)
{
    line(text, "\n%9s %8s %7s %9s %7s %10s %9s %9s %10s %10s %10s %10s %10s", what, "flights", "braked", "breaches",
         "hits", "avoidable", "too late", "failed", "least [m]", "5 % [m]", "50 % [m]", "same pict.", "changed p.");
    for (unsigned intruders = 1; intruders <= kMaxIntruders; ++intruders) {
        Results some;
        std::vector<double> separations;
        for (const EncounterResult& r : results) {
            if (r.intruders == intruders) {
                some.push_back(r);
                separations.push_back(r.separation);
            }
        }
        if (some.empty()) {
            continue;
        }
        std::sort(separations.begin(), separations.end());
        const auto with = [&](Outcome outcome) {
            return count_if(some, [&](const EncounterResult& r) { return r.outcome == outcome; });
        };
        line(text, "%9u %8zu %7zu %9zu %7zu %10zu %9zu %9zu %10.2f %10.2f %10.2f %10.0f %10.0f", intruders, some.size(),
             with(Outcome::braked), with(Outcome::breach), with(Outcome::collision), count_avoidable(some),
             count_if(some, [](const EncounterResult& r) { return r.reported_too_late; }), with(Outcome::failed),
             separations.front(), quantile(separations, 0.05), quantile(separations, 0.5),
             sum_of(some, [](const EncounterResult& r) { return r.sides.same_picture; }),
             sum_of(some, [](const EncounterResult& r) { return r.sides.changed_picture; }));
    }
}

const char* verdict_of(const EncounterResult& r)
{
    if (!broke_promise(r)) {
        return r.outcome == Outcome::failed ? "a rule broken" : "promise kept";
    }
    return r.failed_avoidable ? "avoidable" : r.reported_too_late ? "detected too late" : "no way out was found";
}

void put_list(std::string& text, const char* title, const Results& results)
{
    line(text, std::string("\n") + title);
    line(text, "  %20s %9s %-10s %10s %8s %8s %6s %6s %6s %6s %6s %5s  %s", "seed", "intruders", "outcome",
         "separation", "at [s]", "told [s]", "keep", "later", "quiet", "same", "chang.", "ctrl", "judge");
    for (const EncounterResult& r : results) {
        line(text, "  %20llu %9u %-10s %10.3f %8.2f %8.2f %6u %6u %6.2f %6u %6u %5u  %s",
             static_cast<unsigned long long>(r.seed), r.intruders, std::string(to_string(r.outcome)).c_str(),
             r.separation, r.at, r.reported, r.last_keep, r.late_keep, r.noiseless, r.sides.same_picture,
             r.sides.changed_picture, r.takeovers, verdict_of(r));
    }
}

}  // namespace

Results worst_of(Results results)
{
    const auto rank = [](const EncounterResult& r) {
        const int kind = r.failed_avoidable ? 0 : r.outcome == Outcome::failed ? 1 : 2;
        return std::tuple(kind, r.separation, r.seed);
    };
    std::sort(results.begin(), results.end(),
              [&](const EncounterResult& a, const EncounterResult& b) { return rank(a) < rank(b); });
    results.resize(std::min(results.size(), kWorst));
    return results;
}

std::string summary_text(const FolderSetup& setup, const Results& results)
{
    std::string text;
    const Board& board = setup.variant.board;
    const std::string clock = board.clock == 0 ? "" : ", work of a step for " + std::to_string(board.clock) + " MHz";
    const std::string vehicle = setup.variant.as_recorded ? ", vehicles as recorded" : "";
    const std::string on = vehicle + clock + (board.reduced_sets ? ", reduced reach sets" : "");
    const std::string kind =
        setup.variant.kind == EncounterKind::open ? "" : std::string(to_string(setup.variant.kind)) + " ";
    line(text, "%zu %sencounters, seeds %s, planner %s%s%s\n", results.size(), kind.c_str(), setup.seeds_text.c_str(),
         std::string(to_string(setup.variant.planner)).c_str(), parameters_text(setup.variant).c_str(), on.c_str());
    if (results.empty()) {
        return text;
    }
    put_outcomes(text, setup.variant.kind, results);
    put_promises(text, results);
    put_sides(text, results);
    put_measures(text, results);
    put_intruders(text, setup.variant.kind == EncounterKind::built_up ? "Boxes" : "Intruders", results);
    Results bad;
    std::copy_if(results.begin(), results.end(), std::back_inserter(bad),
                 [](const EncounterResult& r) { return broke_promise(r) || r.outcome == Outcome::failed; });
    put_list(text,
             "Promises and rules broken. keep: of 721 ways of the judge, from the first sighting or conflict on; "
             "later: 0.05 s after that; quiet: least separation of avoidable ones without the sensors' noise",
             bad);
    put_list(text, "The ten worst (worst/*.yaml)", worst_of(results));
    return text;
}

}  // namespace jink::sim
