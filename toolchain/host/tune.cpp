// SPDX-License-Identifier: BSD-3-Clause
// jink tune: the planner's weights and their outcomes in the closed loop.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>

#include "toolchain/host/commands.hpp"
#include "toolchain/host/tune_study.hpp"
#include "toolchain/sim/option_range.hpp"

namespace jink::host {
namespace {

using sim::EncounterResult;

struct TuneOptions {
    std::string out;
    TuneSetup setup;
    std::size_t check = 400;
    unsigned threads = 0;
};

void print(const Tried& tried, const Outcomes& usual)
{
    const Outcomes& o = tried.outcomes;
    char name[16] = "-";
    if (tried.published > 0) {
        std::snprintf(name, sizeof name, "%d", tried.published);
    }
    std::printf("%6.3f %6.3f %6.3f %9s %7zu %9zu %7zu %9.2f %9.2f %9.1f %9.0f %9.3f%s\n",
                static_cast<double>(tried.weights.smoothness), static_cast<double>(tried.weights.time),
                static_cast<double>(tried.weights.closeness), name, o.broken, o.avoidable, o.braked, o.separation,
                o.deviation, o.acceleration, o.jerk, relative_effort(o, usual), tried.on_front ? "  front" : "");
}

void print_difference(const char* what, const Difference& d)
{
    std::printf("  %-34s %12.4f +- %.4f%s\n", what, d.mean, 2.0 * d.error,
                std::abs(d.mean) > 2.0 * d.error ? "" : "   (none that can be told)");
}

/// Checks the fit on new encounters: the encounters that chose the fit are biased in its favour.
void check_fit(const TuneOptions& options, const TuneSetup& setup, const Tried& fit, const Tried& standard)
{
    TuneSetup fresh = setup;
    fresh.out = setup.out / "check";
    fresh.from = setup.from + setup.count;
    fresh.count = options.check;
    const std::vector<EncounterResult> ours = fly_weights(fresh, fit.weights);
    const std::vector<EncounterResult> usual = fly_weights(fresh, standard.weights);
    const Outcomes a = outcomes_of(ours);
    const Outcomes b = outcomes_of(usual);
    std::printf("\n%zu fresh encounters, the fit beside the default (fit, default):\n"
                "  promises broken %zu, %zu; of these avoidable %zu, %zu; braked %zu, %zu; separation, 5 %% below "
                "%.2f m, %.2f m\n"
                "Fit minus default, flight by flight, mean with its 95 %% interval:\n",
                fresh.count, a.broken, b.broken, a.avoidable, b.avoidable, a.braked, b.braked, a.separation,
                b.separation);
    print_difference("least separation [m]",
                     difference_of(ours, usual, [](const EncounterResult& r) { return r.separation; }));
    print_difference("deviation from the leg, rms [m]",
                     difference_of(ours, usual, [](const EncounterResult& r) { return r.deviation_rms; }));
    print_difference("acceleration^2 [m2/s3]",
                     difference_of(ours, usual, [](const EncounterResult& r) { return r.acceleration; }));
    print_difference("jerk^2 [m2/s5]", difference_of(ours, usual, [](const EncounterResult& r) { return r.jerk; }));
}

void run_tune(const TuneOptions& options)
{
    TuneSetup setup = options.setup;
    setup.out = options.out;
    setup.threads = options.threads;
    std::vector<Tried> tried = fly_combinations(
        setup, [](std::size_t i, std::size_t all) { std::fprintf(stderr, "combination %zu of %zu\n", i, all); });
    const auto found = std::find_if(tried.begin(), tried.end(), [](const Tried& one) {
        return one.published > 0 && variant_of(one.weights) == variant_of(cost::Weights{});
    });
    const auto standard = static_cast<std::size_t>(found - tried.begin());
    const Tried usual = tried[standard];
    const Tried fit = tried[fit_of(tried, standard)];
    std::printf("%zu combinations, each over the %zu encounters of seeds %llu to %llu\n\n", tried.size(), setup.count,
                static_cast<unsigned long long>(setup.from),
                static_cast<unsigned long long>(setup.from + setup.count - 1));
    std::printf("%6s %6s %6s %9s %7s %9s %7s %9s %9s %9s %9s %9s\n", "smooth", "time", "close", "published", "broken",
                "avoidable", "braked", "sep. 5%", "dev. rms", "acc.^2", "jerk^2", "effort");
    for (const Tried& one : tried) {
        if (one.published > 0) {
            print(one, usual.outcomes);
        }
    }
    std::printf("\n");
    std::sort(tried.begin(), tried.end(), [&](const Tried& a, const Tried& b) {
        return relative_effort(a.outcomes, usual.outcomes) < relative_effort(b.outcomes, usual.outcomes);
    });
    for (const Tried& one : tried) {
        if (one.on_front && one.published == 0) {
            print(one, usual.outcomes);
        }
    }
    std::printf("\nfront: nothing else is as good in all of broken, braked, separation, deviation, acceleration and\n"
                "jerk. effort: geometric mean of deviation, acceleration, jerk and 1 / separation over the default's\n"
                "(published 5). Fit: the least effort on the front that breaks and brakes no more often than the\n"
                "default: GEO_K_S %.3f, GEO_K_T %.3f\n",
                static_cast<double>(fit.weights.smoothness), static_cast<double>(fit.weights.time));
    if (variant_of(fit.weights) == variant_of(usual.weights)) {
        std::printf("which is the default.\n");
    } else if (options.check > 0) {
        check_fit(options, setup, fit, usual);
    }
}

}  // namespace

void add_tune(CLI::App& jink)
{
    auto options = std::make_shared<TuneOptions>();
    CLI::App* command = jink.add_subcommand(
        "tune", "the planner's weights against closed-loop outcomes of random encounters: the source's seven "
                "combinations, the front of a grid, a fit, and the fit on fresh encounters");
    command->add_option("--out", options->out, "folder of the flights; what is finished there is not flown again")
        ->required();
    command->add_option("--from", options->setup.from, "the first seed")->capture_default_str()->check(sim::any_seed());
    command->add_option("--count", options->setup.count, "encounters to a combination")
        ->capture_default_str()
        ->check(sim::whole(2, 1'000'000));
    command->add_option("--step", options->setup.step, "of the grid of weights")
        ->capture_default_str()
        ->check(CLI::IsMember({0.05, 0.1, 0.2}));
    command->add_option("--check", options->check, "fresh encounters for the fit; 0: none")
        ->capture_default_str()
        ->check(sim::whole(0, 1'000'000));
    command->add_option("--threads", options->threads, "default: one to a core")->check(sim::whole(1, 1024));
    command->callback([options] {
        if (options->check == 1) {
            throw CLI::ValidationError("--check", "0, or 2 and more");
        }
        run_tune(*options);
    });
}

}  // namespace jink::host
