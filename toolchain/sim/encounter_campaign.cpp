// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/encounter_campaign.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <map>
#include <mutex>
#include <set>
#include <sstream>

#include "firmware/linux/complaint.hpp"
#include "toolchain/sim/encounter_summary.hpp"
#include "toolchain/sim/in_process.hpp"
#include "toolchain/sim/input_file.hpp"
#include "toolchain/sim/parallel.hpp"
#include "toolchain/sim/scenario_writer.hpp"
#include "toolchain/sim/source_digest.hpp"

namespace jink::sim {
namespace {

namespace fs = std::filesystem;

constexpr const char* kKind = "jink encounters 1";
constexpr const char* kBlanks = " \t\r";

std::string number(std::uint64_t value)
{
    std::ostringstream text;
    text << value;
    return text.str();
}

template <class Number>
bool read(const std::string& text, Number& value)
{
    const auto [end, bad] = std::from_chars(text.data(), text.data() + text.size(), value);
    return bad == std::errc{} && end == text.data() + text.size() && !text.empty();
}

std::vector<std::uint64_t> seeds_of(const fs::path& file)
{
    std::ifstream in = open_input(file);
    std::vector<std::uint64_t> seeds;
    std::set<std::uint64_t> known;
    std::size_t at = 0;
    for (std::string line; std::getline(in, line);) {
        ++at;
        const std::string text = line.substr(0, line.find('#'));
        const std::size_t from = text.find_first_not_of(kBlanks);
        if (from == std::string::npos) {
            continue;
        }
        const std::size_t end = std::min(text.find_first_of(kBlanks, from), text.size());
        const std::size_t more = text.find_first_not_of(kBlanks, end);
        const auto refuse = [&](std::size_t column, const char* why) {
            throw std::runtime_error(files::to_string({at, column + 1, why, file.string()}));
        };
        std::uint64_t seed = 0;
        if (!read(text.substr(from, end - from), seed)) {
            refuse(from, "no seed: a whole number from 0 to 2^64 - 1 is expected");
        }
        if (more != std::string::npos) {
            refuse(more, "one seed to a line is expected");
        }
        if (!known.insert(seed).second) {
            refuse(from, "this seed comes twice");
        }
        seeds.push_back(seed);
    }
    if (seeds.empty()) {
        throw std::runtime_error(file.string() + " lists no seeds");
    }
    return seeds;
}

std::string fly_block(const EncounterSetup& setup, std::size_t index, const std::function<void()>& pause)
{
    std::string text = encounter_columns() + "\n";
    const std::size_t end = std::min((index + 1) * setup.block, setup.seeds.size());
    for (std::size_t i = index * setup.block; i < end; ++i) {
        text.append(to_line(fly_encounter(setup.seeds[i], setup.variant))).append("\n");
        pause();
    }
    return text;
}

/// A file that repeats one of the worst encounters and expects the same ending.
void write_replay(const BlockFolder& folder, const Variant& variant, const EncounterResult& result)
{
    Scenario scenario = encounter_scenario(result.seed, variant);
    scenario.expect.outcomes = {result.outcome};
    if (scenario.to_goal) {
        scenario.expect.goal_reached = result.goal_at >= 0.0;
    }
    folder.write_file("worst/" + scenario.name + ".yaml",
                      scenario_text(scenario, encounter_columns() + "\n" + to_line(result)));
}

void write_worst(const BlockFolder& folder, const FolderSetup& setup, const std::vector<EncounterResult>& results)
{
    std::error_code bad;
    fs::remove_all(folder.path() / "worst", bad);
    fs::create_directories(folder.path() / "worst", bad);
    for (const EncounterResult& result : worst_of(results)) {
        write_replay(folder, setup.variant, result);
    }
}

}  // namespace

std::string parameters_text(const Variant& variant)
{
    std::string text;
    for (const auto& [name, value] : variant.parameters) {
        std::array<char, 32> buffer{};
        const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
        text.append(" ").append(name).append("=").append(buffer.data(), end);
    }
    return text;
}

std::map<std::string, double> parse_parameters(const std::vector<std::string>& texts)
{
    std::map<std::string, double> values;
    for (const std::string& text : texts) {
        const std::size_t equals = text.find('=');
        double value = 0.0;
        if (equals == std::string::npos || equals == 0 || !read(text.substr(equals + 1), value) ||
            !std::isfinite(value)) {
            throw std::runtime_error("'" + text + "' is not NAME=VALUE");
        }
        values[text.substr(0, equals)] = value;
    }
    return values;
}

std::string EncounterSetup::manifest() const
{
    std::ostringstream text;
    const std::string clock = variant.board.clock == 0 ? "" : "\nclock " + number(variant.board.clock);
    const std::string sets = variant.board.reduced_sets ? "\nreach_sets reduced" : "";
    const std::string kind =
        variant.kind == EncounterKind::open ? "" : "\nencounters " + std::string(to_string(variant.kind));
    const std::string vehicle = variant.as_recorded ? "\nvehicle as_recorded" : "";
    text << kKind << kind << vehicle << "\nplanner " << to_string(variant.planner) << "\nset"
         << parameters_text(variant) << clock << sets << "\nseeds " << seeds_text << "\ncount " << seeds.size()
         << "\nblock " << block << "\nsources " << source_digest() << "\n";
    return text.str();
}

EncounterSetup consecutive_setup(std::uint64_t from, std::size_t count)
{
    EncounterSetup setup;
    for (std::size_t i = 0; i < count; ++i) {
        setup.seeds.push_back(from + i);
    }
    setup.seeds_text = "from " + number(from);
    return setup;
}

EncounterSetup listed_setup(const fs::path& file)
{
    EncounterSetup setup;
    setup.seeds = seeds_of(file);
    std::string all;
    for (const std::uint64_t seed : setup.seeds) {
        all.append(number(seed)).append("\n");
    }
    setup.seeds_text = "listed, checksum " + number(checksum(all));
    return setup;
}

FolderSetup read_setup(const BlockFolder& folder)
{
    std::istringstream lines(folder.manifest());
    std::string kind;
    std::getline(lines, kind);
    std::map<std::string, std::string> values;
    for (std::string line; std::getline(lines, line);) {
        const std::size_t blank = std::min(line.find(' '), line.size());
        values[line.substr(0, blank)] = line.substr(std::min(blank + 1, line.size()));
    }
    FolderSetup setup;
    const bool good = kind == kKind && (values["planner"] == "product" || values["planner"] == "source") &&
                      read(values["count"], setup.count) && read(values["block"], setup.block) && setup.block > 0;
    if (!good) {
        throw BadFolder(folder.path().string() + " is no folder of encounters");
    }
    setup.variant.planner = values["planner"] == "product" ? PlannerKind::product : PlannerKind::source;
    const auto of_kind = std::find_if(kEncounterKinds.begin(), kEncounterKinds.end(),
                                      [&](EncounterKind one) { return to_string(one) == values["encounters"]; });
    setup.variant.kind = of_kind != kEncounterKinds.end() ? *of_kind : EncounterKind::open;
    setup.variant.as_recorded = values["vehicle"] == "as_recorded";
    static_cast<void>(values.count("clock") == 0 || read(values["clock"], setup.variant.board.clock));
    setup.variant.board.reduced_sets = values["reach_sets"] == "reduced";
    std::istringstream parameters(values["set"]);
    setup.variant.parameters = parse_parameters({std::istream_iterator<std::string>(parameters), {}});
    setup.seeds_text = values["seeds"];
    setup.same_sources = values["sources"] == source_digest();
    return setup;
}

void fly_blocks(const BlockFolder& folder, const EncounterSetup& setup,
                const std::function<std::optional<std::size_t>()>& next, const std::function<void()>& pause)
{
    for (std::optional<std::size_t> index = next(); index; index = next()) {
        folder.write(*index, fly_block(setup, *index, pause));
    }
}

void fly_missing(const BlockFolder& folder, const EncounterSetup& setup, unsigned threads,
                 const std::function<void(std::size_t done, std::size_t all)>& done)
{
    const std::vector<std::size_t> missing = folder.missing(setup.blocks());
    std::size_t finished = 0;
    std::mutex mutex;
    in_parallel(missing.size(), threads, [&](std::size_t i) {
        folder.write(missing[i], fly_block(setup, missing[i], [] {}));
        const std::lock_guard lock(mutex);
        done(++finished, missing.size());
    });
}

std::vector<EncounterResult> read_results(const BlockFolder& folder, const FolderSetup& setup)
{
    const std::size_t blocks = (setup.count + setup.block - 1) / setup.block;
    const std::vector<std::size_t> missing = folder.missing(blocks);
    if (!missing.empty()) {
        throw BadFolder(folder.path().string() + ": " + number(missing.size()) + " of " + number(blocks) +
                        " blocks are missing; the same command as before flies them");
    }
    std::vector<EncounterResult> results;
    for (std::size_t i = 0; i < blocks; ++i) {
        std::istringstream lines(folder.read(i).value_or(""));
        std::string line;
        std::getline(lines, line);
        bool good = line == encounter_columns();
        while (good && std::getline(lines, line)) {
            const std::optional<EncounterResult> result = parse_line(line);
            good = result.has_value();
            if (result) {
                results.push_back(*result);
            }
        }
        if (!good || results.size() != std::min((i + 1) * setup.block, setup.count)) {
            throw BadFolder(folder.path().string() + ": block " + number(i) + " is none of this program's");
        }
    }
    return results;
}

std::size_t count_avoidable(const std::vector<EncounterResult>& results)
{
    return static_cast<std::size_t>(
        std::count_if(results.begin(), results.end(), [](const EncounterResult& r) { return r.failed_avoidable; }));
}

std::string summarise(const BlockFolder& folder, const FolderSetup& setup, const std::vector<EncounterResult>& results)
{
    const std::string text = summary_text(setup, results);
    folder.write_file("summary.txt", text);
    if (setup.same_sources) {
        write_worst(folder, setup, results);
    }
    return text;
}

}  // namespace jink::sim
