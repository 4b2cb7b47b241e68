// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/matrix_command.hpp"

#include <algorithm>
#include <iomanip>
#include <ostream>
#include <vector>

#include <CLI/CLI.hpp>

#include "toolchain/sim/in_process.hpp"
#include "toolchain/sim/matrix.hpp"
#include "toolchain/sim/option_range.hpp"
#include "toolchain/sim/parallel.hpp"

namespace jink::sim {
namespace {

template <class All>
std::vector<std::string> names_of(const All& all)
{
    std::vector<std::string> names;
    for (const auto one : all) {
        names.emplace_back(to_string(one));
    }
    return names;
}

template <class One>
bool is_wanted(const std::string& name, One one)
{
    return name.empty() || name == to_string(one);
}

Conditions conditions_of(const MatrixOptions& options) { return options.rough ? Conditions::rough : Conditions::calm; }

std::vector<Cell> wanted_cells(const MatrixOptions& options)
{
    std::vector<Cell> cells;
    for (const Behaviour behaviour : kBehaviours) {
        for (const Flyer flyer : kFlyers) {
            for (const Meeting meeting : kMeetings) {
                if (is_wanted(options.behaviour, behaviour) && is_wanted(options.flyer, flyer) &&
                    is_wanted(options.meeting, meeting) && can_fly(flyer, behaviour)) {
                    Cell& cell = cells.emplace_back();
                    cell.flyer = flyer;
                    cell.behaviour = behaviour;
                    cell.meeting = meeting;
                }
            }
        }
    }
    return cells;
}

void fly_cells(const MatrixOptions& options, std::vector<Cell>& cells)
{
    in_parallel(cells.size(), options.threads, [&](std::size_t k) {
        const Cell& c = cells[k];
        cells[k] = fly_cell(c.flyer, c.behaviour, c.meeting, options.from, options.count, conditions_of(options));
    });
}

void add(const Cell& cell, Cell& sum)
{
    sum.flights += cell.flights;
    sum.hits += cell.hits;
    sum.avoidable += cell.avoidable;
    sum.foreseeable += cell.foreseeable;
    sum.unwarned += cell.unwarned;
    sum.taken_over += cell.taken_over;
    sum.given_back += cell.given_back;
    sum.finished += cell.finished;
    sum.critical_texts += cell.critical_texts;
    sum.own_critical += cell.own_critical;
    sum.broken_rules += cell.broken_rules;
    sum.least = std::min(sum.least, cell.least);
}

void print_counts(std::ostream& out, const Cell& c)
{
    out << std::setw(8) << c.flights << std::setw(6) << c.hits << std::setw(10) << c.avoidable << std::setw(9)
        << c.unwarned << std::setw(9) << std::fixed << std::setprecision(2) << c.least << std::setw(11) << c.taken_over
        << std::setw(11) << c.given_back << std::setw(9);
    if (is_mission(c.behaviour)) {
        out << c.finished;
    } else {
        out << "-";
    }
    out << std::setw(9) << c.critical_texts << std::setw(9) << c.own_critical << std::setw(7) << c.broken_rules;
}

void print_head(std::ostream& out)
{
    out << std::left << std::setw(14) << "behaviour" << std::setw(12) << "autopilot" << std::setw(12) << "encounter"
        << std::right
        << " flights  hits avoidable unwarned  least m taken over given back finished critical own crit  rules\n";
}

void print_cells(std::ostream& out, const MatrixOptions& options, const std::vector<Cell>& cells)
{
    print_head(out);
    for (std::size_t i = 0; i < cells.size(); ++i) {
        Cell line = cells[i];
        std::string meeting(to_string(line.meeting));
        if (options.brief) {
            meeting = "all";
            while (i + 1 < cells.size() && cells[i + 1].behaviour == line.behaviour &&
                   cells[i + 1].flyer == line.flyer) {
                line.bad.insert(line.bad.end(), cells[i + 1].bad.begin(), cells[i + 1].bad.end());
                add(cells[++i], line);
            }
        }
        out << std::left << std::setw(14) << to_string(line.behaviour) << std::setw(12) << to_string(line.flyer)
            << std::setw(12) << meeting << std::right;
        print_counts(out, line);
        for (std::size_t k = 0; k < std::min<std::size_t>(line.bad.size(), 6); ++k) {
            out << (k == 0 ? "  seeds " : ",") << line.bad[k];
        }
        out << "\n";
    }
}

void print(std::ostream& out, const Vec& v) { out << " " << v.x() << " " << v.y() << " " << v.z(); }

/// Each change of mode, and the vehicle's position about home every 5 s.
void print_samples(std::ostream& out, const Scenario& scenario, const Record& record)
{
    constexpr std::size_t kEvery = 250;
    Mode before = Mode::brake;
    for (std::size_t i = 0; i < record.samples.size(); ++i) {
        const Sample& sample = record.samples[i];
        if (sample.mode != before || i % kEvery == 0) {
            out << "  " << sample.time << " s  " << to_string(sample.mode) << " at";
            print(out, sample.position - scenario.home);
            out << " m, velocity";
            print(out, sample.velocity);
            out << " m/s, command";
            print(out, sample.setpoint);
            out << " m/s\n";
        }
        before = sample.mode;
    }
}

/// Repeats the flights of the cells and prints the texts and broken rules of each.
void print_flights(std::ostream& out, const MatrixOptions& options, const std::vector<Cell>& cells)
{
    for (const Cell& cell : cells) {
        for (std::size_t i = 0; i < options.count; ++i) {
            const Scenario scenario =
                matrix_scenario(cell.flyer, cell.behaviour, cell.meeting, options.from + i, conditions_of(options));
            const Record record = fly_in_process(scenario);
            out << scenario.name << ": meets at " << nominal_flight(cell.flyer, cell.behaviour, scenario.seed).meets_at
                << " s, told at " << record.reported.front() << " s, ";
            for (const Turn& turn : scenario.threats.front().turns) {
                out << "turns at " << turn.at << " s, ";
            }
            out << "least " << record.closest.surface << " m at " << record.closest.time << " s, ends "
                << to_string(record.final_mode) << " at " << record.duration << " s, goal at " << record.goal_at
                << " s\n";
            for (const Text& text : record.heard.texts) {
                out << "  " << text.time << " s  " << text.severity << "  " << text.text << "\n";
            }
            for (const std::string& fault : record.faults) {
                out << "  fault: " << fault << "\n";
            }
            print_samples(out, scenario, record);
        }
    }
}

}  // namespace

CLI::App& add_matrix(CLI::App& cli, MatrixOptions& options)
{
    CLI::App* command =
        cli.add_subcommand("matrix", "encounters in every behaviour of every simulated autopilot; exit status 1 when a "
                                     "hit was avoidable, a rule was broken or the autopilot said a CRITICAL text");
    command->add_option("--from", options.from, "the first seed, default 1")->check(any_seed());
    command->add_option("--count", options.count, "seeds to a cell, default 20")->check(whole(1, 100'000));
    command->add_option("--behaviour", options.behaviour, "this one alone")
        ->check(CLI::IsMember(names_of(kBehaviours)));
    command->add_option("--encounter", options.meeting, "this one alone")->check(CLI::IsMember(names_of(kMeetings)));
    command->add_option("--autopilot", options.flyer, "this one alone")->check(CLI::IsMember(names_of(kFlyers)));
    command->add_option("--threads", options.threads, "default 2")->check(whole(1, 1024));
    command->add_flag("--brief", options.brief, "a line for all encounters of a behaviour");
    command->add_flag("--rough", options.rough,
                      "1 Hz ADS-B in its steps, an estimator with bias and latency, gusts of a wind of 15 kt");
    command->add_flag("--texts", options.texts, "and what was said, flight by flight");
    return *command;
}

int run_matrix(const MatrixOptions& options, std::ostream& out)
{
    std::vector<Cell> cells = wanted_cells(options);
    fly_cells(options, cells);
    print_cells(out, options, cells);
    if (options.texts) {
        print_flights(out, options, cells);
    }
    Cell sum;
    unsigned missions = 0;
    for (const Cell& cell : cells) {
        add(cell, sum);
        missions += is_mission(cell.behaviour) ? cell.flights : 0U;
    }
    out << cells.size() << " cells, " << sum.flights << " flights: " << sum.hits << " hits, " << sum.avoidable
        << " of them avoidable, " << sum.foreseeable << " of these since the intruder's last turn, " << sum.finished
        << " of " << missions << " missions finished, " << sum.critical_texts << " critical texts of the autopilot, "
        << sum.broken_rules << " flights with a broken rule\n";
    return sum.avoidable == 0 && sum.critical_texts == 0 && sum.broken_rules == 0 ? 0 : 1;
}

}  // namespace jink::sim
