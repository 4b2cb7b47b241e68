// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/host/tune_study.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "toolchain/sim/encounter_campaign.hpp"
#include "toolchain/sim/statistics.hpp"

namespace jink::host {
namespace {

/// Weights within this difference are equal.
constexpr float kSame = 1e-4F;

bool same(const cost::Weights& a, const cost::Weights& b)
{
    return std::abs(a.smoothness - b.smoothness) < kSame && std::abs(a.time - b.time) < kSame;
}

template <class Value>
double mean_of(const std::vector<sim::EncounterResult>& results, Value&& value)
{
    double sum = 0.0;
    for (const sim::EncounterResult& r : results) {
        sum += value(r);
    }
    return sum / static_cast<double>(results.size());
}

template <class Test>
std::size_t count(const std::vector<sim::EncounterResult>& results, Test&& test)
{
    return static_cast<std::size_t>(std::count_if(results.begin(), results.end(), test));
}

std::string folder_name(const cost::Weights& weights)
{
    char name[64];
    std::snprintf(name, sizeof name, "s%03.0f_t%03.0f_c%03.0f", 1000.0 * static_cast<double>(weights.smoothness),
                  1000.0 * static_cast<double>(weights.time), 1000.0 * static_cast<double>(weights.closeness));
    return name;
}

}  // namespace

Outcomes outcomes_of(const std::vector<sim::EncounterResult>& results)
{
    using sim::EncounterResult;
    using sim::Outcome;
    Outcomes o;
    o.flights = results.size();
    o.broken = count(results, [](const EncounterResult& r) {
        return r.outcome == Outcome::breach || r.outcome == Outcome::collision;
    });
    o.avoidable = sim::count_avoidable(results);
    o.braked = count(results, [](const EncounterResult& r) { return r.outcome == Outcome::braked; });
    o.failed = count(results, [](const EncounterResult& r) { return r.outcome == Outcome::failed; });
    std::vector<double> separations;
    for (const EncounterResult& r : results) {
        separations.push_back(r.separation);
    }
    std::sort(separations.begin(), separations.end());
    o.separation = sim::quantile(separations, 0.05);
    o.deviation = mean_of(results, [](const EncounterResult& r) { return r.deviation_rms; });
    o.acceleration = mean_of(results, [](const EncounterResult& r) { return r.acceleration; });
    o.jerk = mean_of(results, [](const EncounterResult& r) { return r.jerk; });
    return o;
}

std::vector<Tried> combinations(double step)
{
    std::vector<Tried> all;
    for (std::size_t i = 0; i < cost::kTriedWeights.size(); ++i) {
        all.push_back({cost::kTriedWeights[i], static_cast<int>(i) + 1, {}, false});
    }
    const int steps = static_cast<int>(std::lround(1.0 / step));
    for (int s = 0; s < steps; ++s) {
        for (int t = 1; s + t < steps; ++t) {
            cost::Weights weights;
            weights.smoothness = static_cast<float>(s * step);
            weights.time = static_cast<float>(t * step);
            weights.closeness = 1.0F - weights.smoothness - weights.time;
            const bool known =
                std::any_of(all.begin(), all.end(), [&](const Tried& one) { return same(one.weights, weights); });
            if (!known && sim::refusal_of(variant_of(weights)).empty()) {
                all.push_back({weights, 0, {}, false});
            }
        }
    }
    return all;
}

sim::Variant variant_of(const cost::Weights& weights)
{
    // Rounded to three decimals, as written: a float's own digits would read 0.30000001.
    const auto rounded = [](float value) { return std::round(1000.0 * static_cast<double>(value)) / 1000.0; };
    sim::Variant variant;
    // The geometric planner alone: results of other methods do not depend on the weights.
    variant.parameters = {
        {"JNK_METHODS", 1.0}, {"GEO_K_S", rounded(weights.smoothness)}, {"GEO_K_T", rounded(weights.time)}};
    return variant;
}

bool dominates(const Outcomes& a, const Outcomes& b)
{
    const bool as_good = a.broken <= b.broken && a.braked <= b.braked && a.separation >= b.separation &&
                         a.deviation <= b.deviation && a.acceleration <= b.acceleration && a.jerk <= b.jerk;
    const bool better = a.broken < b.broken || a.braked < b.braked || a.separation > b.separation ||
                        a.deviation < b.deviation || a.acceleration < b.acceleration || a.jerk < b.jerk;
    return as_good && better;
}

void mark_front(std::vector<Tried>& tried)
{
    for (Tried& one : tried) {
        one.on_front = std::none_of(tried.begin(), tried.end(),
                                    [&](const Tried& other) { return dominates(other.outcomes, one.outcomes); });
    }
}

double relative_effort(const Outcomes& outcomes, const Outcomes& other)
{
    return std::pow(outcomes.deviation / other.deviation * (outcomes.acceleration / other.acceleration) *
                        (outcomes.jerk / other.jerk) * (other.separation / outcomes.separation),
                    0.25);
}

std::size_t fit_of(const std::vector<Tried>& tried, std::size_t standard)
{
    const Outcomes& usual = tried[standard].outcomes;
    std::size_t best = standard;
    double least = 1.0;
    for (std::size_t i = 0; i < tried.size(); ++i) {
        const Outcomes& o = tried[i].outcomes;
        const bool safe = o.broken <= usual.broken && o.failed <= usual.failed && o.braked <= usual.braked &&
                          o.separation > 0.0 && usual.separation > 0.0;
        if (safe && tried[i].on_front && relative_effort(o, usual) < least) {
            least = relative_effort(o, usual);
            best = i;
        }
    }
    return best;
}

std::vector<sim::EncounterResult> fly_weights(const TuneSetup& setup, const cost::Weights& weights)
{
    sim::EncounterSetup encounters = sim::consecutive_setup(setup.from, setup.count);
    encounters.variant = variant_of(weights);
    encounters.block = setup.block;
    sim::BlockFolder folder(setup.out / folder_name(weights));
    folder.claim(encounters.manifest());
    sim::fly_missing(folder, encounters, setup.threads, [](std::size_t, std::size_t) {});
    return sim::read_results(folder, sim::read_setup(folder));
}

std::vector<Tried> fly_combinations(const TuneSetup& setup, const std::function<void(std::size_t, std::size_t)>& done)
{
    std::vector<Tried> tried = combinations(setup.step);
    for (std::size_t i = 0; i < tried.size(); ++i) {
        done(i + 1, tried.size());
        tried[i].outcomes = outcomes_of(fly_weights(setup, tried[i].weights));
    }
    mark_front(tried);
    return tried;
}

Difference difference_of(const std::vector<sim::EncounterResult>& a, const std::vector<sim::EncounterResult>& b,
                         const std::function<double(const sim::EncounterResult&)>& value)
{
    const auto n = static_cast<double>(a.size());
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        sum += value(a[i]) - value(b[i]);
    }
    Difference d{sum / n, 0.0};
    double squares = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double off = value(a[i]) - value(b[i]) - d.mean;
        squares += off * off;
    }
    d.error = std::sqrt(squares / (n - 1.0) / n);
    return d;
}

}  // namespace jink::host
