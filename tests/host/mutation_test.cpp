// SPDX-License-Identifier: BSD-3-Clause
// Files with bytes changed, lost, doubled and swapped: for any input the readers return a usable value or complaints,
// and the planner accepts every accepted value.
#include <algorithm>
#include <cstdlib>
#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "tests/host/scratch.hpp"
#include "toolchain/host/plan_output.hpp"

namespace {

using namespace jink;
using namespace jink::host;
using files::Complaints;

/// JINK_SEED replays one case.
std::uint64_t first_seed()
{
    return std::getenv("JINK_SEED") != nullptr ? std::strtoull(std::getenv("JINK_SEED"), nullptr, 10) : 1;
}
int cases(int all) { return std::getenv("JINK_SEED") != nullptr ? 1 : all; }

std::string mutated(std::string text, Random& random)
{
    static const std::vector<std::string> kPieces{
        "[", "]",    "{",   "}",   ":",    ": ",  "\n",  "- ",   "&a ", "*a",   "!!int ",       "\"",
        "'", "#",    "|\n", ">\n", "%",    "---", "...", "\t",   "\r",  "~",    "null",         "<<: ",
        ",", ".nan", "-1",  "0",   "1e30", "1e",  "?",   "true", " ",   "\xff", "\xEF\xBB\xBF", std::string(1, '\0'),
        "@", "`"};
    const bool digits_only = random.below(3) == 0;
    const std::uint64_t changes = 1 + random.below(random.below(2) == 0 ? 1 : 6);
    for (std::uint64_t i = 0; i < changes && !text.empty(); ++i) {
        const std::size_t at = random.below(text.size());
        const std::size_t length = 1 + random.below(std::min<std::size_t>(20, text.size() - at));
        if (digits_only) {
            const std::size_t digit = text.find_first_of("0123456789", at);
            if (digit != std::string::npos) {
                text[digit] = static_cast<char>('0' + static_cast<char>(random.below(10)));
            }
            continue;
        }
        switch (random.below(6)) {
        case 0: text[at] = static_cast<char>(random.next()); break;
        case 1: text.erase(at, length); break;
        case 2: text.insert(at, text.substr(at, length)); break;
        case 3: text.insert(at, kPieces[random.below(kPieces.size())]); break;
        case 4: text.replace(at, length, kPieces[random.below(kPieces.size())]); break;
        default: text.insert(random.below(text.size()), text.substr(at, length)); break;
        }
    }
    return text;
}

void expect_sensible(const Complaints& complaints, const std::string& text, std::uint64_t seed)
{
    ASSERT_FALSE(complaints.empty()) << "refused without a word, seed " << seed;
    const auto lines = static_cast<std::size_t>(
                           std::count_if(text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; })) +
                       1;
    for (const files::Complaint& complaint : complaints) {
        ASSERT_LE(complaint.line, lines + 1) << "seed " << seed << "\n" << files::to_string(complaint) << "\n" << text;
        ASSERT_FALSE(complaint.text.empty());
        const bool harmless = std::none_of(complaint.text.begin(), complaint.text.end(),
                                           [](char c) { return static_cast<unsigned char>(c) < 0x20; });
        ASSERT_TRUE(harmless) << "seed " << seed << "\n" << complaint.text;
    }
}

const std::string kProblem =
    "title: all of it\nvehicle:\n  kind: multirotor\n  cruise_speed: 5\n  max_climb: 3\n  max_descent: 3\n"
    "  max_acceleration: 5\n  max_vertical_acceleration: 3\n  velocity_lag: 0.25\n  half_extent_level: 1\n"
    "  half_extent_vertical: 1\n  mass: 3\n  drag_coefficient: 0.5\n  effective_area: 2.5\n"
    "  rotors: {count: 4, radius: 0.2}\nleg: {start: [0, 0, 20], end: [60, 0, 20], speed: 5}\nk_sigma: 2\n"
    "threats:\n  - {name: a, position: [20, 1, 20], velocity: [-3, 0, 0], radius: 1.5, sigma_velocity: 0.1, main: "
    "true}\n"
    "  - {position: [12, -8, 21], velocity: [0, 2.5, 0], radius: 0.8}\n"
    "obstacles:\n  - {box: {centre: [14, 5, 20], half_extents: [1, 2, 3], yaw: 30}}\n"
    "  - {capsule: {from: [9, 9, 0], to: [9, 9, 10], radius: 2}}\n"
    "  - {hull: {vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], centre: [5, 5, 5]}}\n"
    "airspace: {floor: 2, ceiling: 120, keep_in: {home: [0, 0, 0], radius: 500}}\n"
    "settings: {l: 4, n: 1, kinds: [simple, symmetric], weights: {k_S: 0.3, k_T: 0.2, k_C: 0.5}, k_p: 1}\n";

TEST(Mutation, ProblemFilesAreSolvedOrRefusedWithReason)
{
    ASSERT_TRUE(std::holds_alternative<ProblemFile>(read_problem_text(kProblem, "p.yaml")))
        << test::all_of(std::get<Complaints>(read_problem_text(kProblem, "p.yaml")));
    int taken = 0;
    for (int i = 0; i < cases(4000); ++i) {
        const std::uint64_t seed = first_seed() + static_cast<std::uint64_t>(i);
        Random random(seed);
        const std::string text = mutated(kProblem, random);
        const auto read = read_problem_text(text, "p.yaml");
        if (const auto* complaints = std::get_if<Complaints>(&read)) {
            expect_sensible(*complaints, text, seed);
        } else {
            const auto& file = std::get<ProblemFile>(read);
            const auto outcome = solve_problem(file, 20000);
            ASSERT_NE(outcome->status, world::PlanStatus::bad_input) << "JINK_SEED=" << seed << "\n" << text;
            ASSERT_FALSE(plan_table(file, *outcome).empty());
            ASSERT_FALSE(plan_json(file, *outcome, false)
                             .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)
                             .empty());
            ++taken;
        }
        if (HasFatalFailure()) {
            FAIL() << "JINK_SEED=" << seed;
        }
    }
    EXPECT_TRUE(std::getenv("JINK_SEED") != nullptr || taken > 100)
        << "mutations must also leave good files: " << taken;
}

TEST(Mutation, VehicleFilesGiveAVehicleOrComplaints)
{
    const std::string good = test::slurp(JINK_SOURCES "/firmware/vehicles/default/vehicle.yaml");
    int taken = 0;
    for (int i = 0; i < cases(3000); ++i) {
        const std::uint64_t seed = first_seed() + static_cast<std::uint64_t>(i);
        Random random(seed);
        const std::string text = mutated(good, random);
        Complaints complaints;
        const auto root = files::parse_yaml(text, "v.yaml", complaints);
        const auto vehicle = root ? files::read_vehicle(*root, "", "v.yaml", complaints) : std::nullopt;
        if (!vehicle) {
            expect_sensible(complaints, text, seed);
        } else {
            ASSERT_TRUE(complaints.empty()) << "JINK_SEED=" << seed;
            ASSERT_TRUE(vehicle::is_valid(vehicle->limits) && vehicle::is_valid(vehicle->airframe) &&
                        cost::is_valid(vehicle->caps))
                << "JINK_SEED=" << seed << "\n"
                << text;
            // Each value is valid for its parameter: a refusal is then of the set.
            app::Parameters parameters;
            const app::ParamStatus status = parameters.set_all(files::apply_vehicle(*vehicle, parameters.values()));
            ASSERT_TRUE(status == app::ParamStatus::ok || status == app::ParamStatus::inconsistent)
                << "JINK_SEED=" << seed << "\n"
                << text;
            ++taken;
        }
        if (HasFatalFailure()) {
            FAIL() << "JINK_SEED=" << seed;
        }
    }
    EXPECT_TRUE(std::getenv("JINK_SEED") != nullptr || taken > 100) << taken;
}

TEST(Mutation, ParameterFilesGiveValuesInRangeOrComplaints)
{
    const files::ParamValues initial = app::Parameters().values();
    const std::string good = files::param_file_text(initial);
    int taken = 0;
    for (int i = 0; i < cases(5000); ++i) {
        const std::uint64_t seed = first_seed() + static_cast<std::uint64_t>(i);
        Random random(seed);
        const std::string text = mutated(good, random);
        Complaints complaints;
        const auto values = files::apply_param_text(text, "f", initial, complaints);
        if (!values) {
            expect_sensible(complaints, text, seed);
        } else {
            ++taken;
            for (std::size_t k = 0; k < values->size(); ++k) {
                const app::ParamInfo& info = app::param_table()[k];
                ASSERT_TRUE((*values)[k] >= info.low && (*values)[k] <= info.high)
                    << "JINK_SEED=" << seed << " " << info.name;
            }
        }
        if (HasFatalFailure()) {
            FAIL() << "JINK_SEED=" << seed;
        }
    }
    EXPECT_TRUE(std::getenv("JINK_SEED") != nullptr || taken > 100) << taken;
}

TEST(Mutation, HostileYamlIsRefusedNotSuffered)
{
    std::string laughs = "a: &a [1, 1, 1, 1, 1, 1, 1, 1]\n";
    for (char c = 'b'; c < 'n'; ++c) {
        const std::string before(1, static_cast<char>(c - 1));
        laughs += std::string(1, c) + ": &" + c + " [";
        for (int i = 0; i < 8; ++i) {
            laughs += (i == 0 ? "*" : ", *") + before;
        }
        laughs += "]\n";
    }
    const std::vector<std::string> texts{
        std::string(20000, '['),
        std::string(20000, '{'),
        std::string(20000, '-') + " a",
        laughs + "threats: *m\n",
        "threats: &t [*t]\n",
        "&r {vehicle: *r}\n",
        "<<: {vehicle: default}\n",
        "? [complex]\n: 1\n",
        "vehicle: !!binary AAAA\n",
        "vehicle: " + std::string(100000, 'v') + "\n",
        std::string(1000, '\n') + "vehicle: [\n",
    };
    for (const std::string& text : texts) {
        const auto read = read_problem_text(text, "p.yaml");
        ASSERT_TRUE(std::holds_alternative<Complaints>(read)) << text.substr(0, 60);
        expect_sensible(std::get<Complaints>(read), text, 0);
    }
}

}  // namespace
