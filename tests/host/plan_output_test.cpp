// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "toolchain/host/plan_output.hpp"

#include <cmath>
#include <sstream>

#include "tests/host/scratch.hpp"
#include "tests/oracle/problem_threats.hpp"

namespace {

using namespace jink;
using namespace jink::host;
using geometric::CandidateStatus;
using world::PlanStatus;

ProblemFile problem_of(const std::string& text)
{
    auto read = read_problem_text(text, "p.yaml");
    if (const auto* complaints = std::get_if<files::Complaints>(&read)) {
        ADD_FAILURE() << test::all_of(*complaints);
        return {};
    }
    return std::get<ProblemFile>(read);
}

const std::string kCrossing =
    "title: Two that cross\nvehicle: default\nleg: {start: [0, 0, 20], end: [60, 0, 20], speed: 5}\n"
    "threats:\n  - {name: \"the \\\"main\\\" one, left\", position: [20, 6, 20], velocity: [0, -2, 0], radius: 1, "
    "main: true}\n"
    "  - {position: [12, -8, 21], velocity: [0, 2.5, 0], radius: 0.8}\n"
    "obstacles:\n  - {name: mast, cylinder: {from: [14, 5, 0], to: [14, 5, 40], radius: 0.4}}\n"
    "airspace: {floor: 18}\n";

/// The same built by hand, for the planner itself.
struct ByHand : geometric::ProblemThreats {
    geometric::Problem problem_of;

    ByHand()
    {
        threats = {{{{20, 6, 20}, {0, -2, 0}}, 1.0F}, {{{12, -8, 21}, {0, 2.5F, 0}}, 0.8F}};
        obstacles = {{0, geometry::make_cylinder({14, 5, 0}, {14, 5, 40}, 0.4F)}};
        airspace.has_floor = true;
        airspace.floor = 18.0F;
        problem_of.frame = geometric::make_path_frame({0, 0, 20}, {1, 0, 0});
        problem_of.main = 0;
        problem_of.main_radius = 1.0F;
        put_into(problem_of);
        problem_of.start_velocity = {5, 0, 0};
    }
};

TEST(PlanOutput, JsonAgreesWithThePlanner)
{
    const ProblemFile file = problem_of(kCrossing);
    const auto outcome = solve_problem(file, 120000);
    const auto json = nlohmann::json::parse(plan_json(file, *outcome, true).dump());

    ByHand hand;
    // Closest approach of the centres: closing velocity (5, 2), from (20, 6).
    const float when = (20.0F * 5.0F + 6.0F * 2.0F) / 29.0F;
    EXPECT_NEAR(json["distance"].get<float>(), 5.0F * when, 1e-4F);
    hand.problem_of.distance = file.distance;
    hand.problem_of.main_centre_offset = file.main_centre_offset;
    EXPECT_NEAR((file.main_centre_offset - Vec3(20.0F - 5.0F * when, 6.0F - 2.0F * when, 0)).norm(), 0.0F, 1e-4F);
    geometric::Settings settings;
    settings.evaluate_all = settings.all_terms = true;
    auto result = std::make_unique<geometric::Result>();
    WorkBudget budget(120000);
    const PlanStatus status =
        geometric::solve(hand.problem_of, settings, vehicle::VehicleLimits{}, vehicle::Airframe{}, budget, *result);
    ASSERT_EQ(status, PlanStatus::found);
    EXPECT_EQ(json["status"], "found");
    EXPECT_EQ(json["chosen"].get<std::size_t>(), result->chosen);
    ASSERT_EQ(json["candidates"].size(), result->candidates.size());
    EXPECT_EQ(json["work"].get<std::uint32_t>(), budget.spent());

    for (std::size_t i = 0; i < result->candidates.size(); ++i) {
        const geometric::Candidate& c = result->candidates[i];
        const auto& j = json["candidates"][i];
        EXPECT_EQ(j["kind"], to_string(c.shape.family));
        EXPECT_EQ(j["offset"].get<float>(), c.shape.offset);
        EXPECT_EQ(j["status"], name_of(c.status));
        EXPECT_EQ(j["duration"].get<float>(), c.duration);
        const bool costed = c.status == CandidateStatus::available || c.status == CandidateStatus::chosen;
        ASSERT_EQ(j.contains("terms"), costed);
        if (costed) {
            EXPECT_EQ(j["terms"]["time"].get<float>(), c.terms.time);
            EXPECT_EQ(j["terms"]["smoothness_penalised"].get<float>(), c.terms.smoothness_penalised);
            EXPECT_EQ(j["terms"]["energy"].get<float>(), c.terms.energy);
            EXPECT_EQ(j["normalised"]["closeness"].get<float>(), cost::normalise(c.terms, settings.caps).closeness);
            EXPECT_EQ(j["total"].get<float>(), c.total);
        }
        path::TimedPath path;
        ASSERT_TRUE(geometric::make_candidate_path(hand.problem_of, c.shape, settings.waypoints,
                                                   vehicle::VehicleLimits{}, path));
        ASSERT_EQ(j["points"].size(), path.points.size());
        for (std::size_t k = 0; k < path.points.size(); ++k) {
            EXPECT_EQ(j["points"][k][1].get<float>(), path.points[k].position.y());
        }
    }
    ASSERT_EQ(json["path"].size(), result->path.points.size());
    for (std::size_t k = 0; k < result->path.points.size(); ++k) {
        EXPECT_EQ(json["path"][k]["time"].get<float>(), result->path.points[k].time);
        EXPECT_EQ(json["path"][k]["position"][2].get<float>(), result->path.points[k].position.z());
        EXPECT_EQ(json["path"][k]["velocity"][0].get<float>(), result->path.points[k].velocity.x());
    }
}

TEST(PlanOutput, TheChosenOneIsTheCheapestAvailable)
{
    const ProblemFile file =
        problem_of(kCrossing + "settings: {l: 16, n: 7, check_acceleration: false, verify_flight: false}\n");
    const auto outcome = solve_problem(file, 1000000);
    const auto json = plan_json(file, *outcome, false);
    ASSERT_EQ(json["status"], "found");
    std::size_t available = 0;
    for (const auto& c : json["candidates"]) {
        if (c.contains("total")) {
            EXPECT_GE(c["total"].get<float>(),
                      json["candidates"][json["chosen"].get<std::size_t>()]["total"].get<float>());
            ++available;
        }
        EXPECT_FALSE(c.contains("points"));
        const bool hits = c["status"].get<std::string>().starts_with("hits");
        EXPECT_EQ(hits, !c["hits"].is_null()) << c.dump();
    }
    EXPECT_GT(available, 3U);
}

/// Splits a line of CSV with quoted fields.
std::vector<std::string> fields(const std::string& line)
{
    std::vector<std::string> out(1);
    bool quoted = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (line[i] == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"') {
            out.back() += line[i++];
        } else if (line[i] == '"') {
            quoted = !quoted;
        } else if (line[i] == ',' && !quoted) {
            out.emplace_back();
        } else {
            out.back() += line[i];
        }
    }
    return out;
}

TEST(PlanOutput, CsvHoldsTheSameInColumns)
{
    const ProblemFile file = problem_of(kCrossing);
    const auto outcome = solve_problem(file, 120000);
    std::istringstream csv(plan_csv(file, *outcome));
    std::string line;
    ASSERT_TRUE(std::getline(csv, line));
    const std::vector<std::string> names = fields(line);
    ASSERT_EQ(names.size(), 20U);
    std::size_t rows = 0;
    std::size_t named = 0;
    for (; std::getline(csv, line); ++rows) {
        const std::vector<std::string> row = fields(line);
        ASSERT_EQ(row.size(), names.size()) << line;
        const geometric::Candidate& c = outcome->result.candidates[rows];
        EXPECT_EQ(row[0], std::to_string(rows));
        EXPECT_EQ(row[4], name_of(c.status));
        EXPECT_EQ(row[5], hit_name(file, c.hit));
        named += row[5] == "the \"main\" one, left" ? 1U : 0U;
        EXPECT_EQ(std::stof(row[3]), c.shape.offset);
        if (c.status == CandidateStatus::available || c.status == CandidateStatus::chosen) {
            EXPECT_EQ(std::stof(row[7]), c.terms.time);
            EXPECT_EQ(std::stof(row[11]), c.terms.energy);
            EXPECT_EQ(std::stof(row[18]), c.total);
        } else {
            EXPECT_EQ(row[18], "");
        }
    }
    EXPECT_EQ(rows, outcome->result.candidates.size());
    EXPECT_GT(named, 0U) << "a name with comma and quotes comes through";
}

TEST(PlanOutput, TableSaysWhatAndWhy)
{
    const ProblemFile file = problem_of(kCrossing);
    const auto outcome = solve_problem(file, 120000);
    const std::string table = plan_table(file, *outcome);
    EXPECT_TRUE(table.starts_with("Two that cross\n"));
    EXPECT_NE(table.find("CHOSEN"), std::string::npos);
    EXPECT_NE(table.find("Fly candidate " + std::to_string(outcome->result.chosen) + ": "), std::string::npos);
    EXPECT_NE(table.find("hits the \"main\" one, left"), std::string::npos) << table;
    EXPECT_NE(table.find("leaves floor"), std::string::npos) << table;
    EXPECT_NE(table.find("1 attempt."), std::string::npos);
    std::istringstream lines(table);
    std::size_t rows = 0;
    for (std::string line; std::getline(lines, line);) {
        rows += line.find("  simple ") < 6 || line.find("  symmetric ") < 6 ? 1U : 0U;
    }
    EXPECT_EQ(rows, outcome->result.candidates.size()) << table;
}

TEST(PlanOutput, EveryWayToStop)
{
    const std::string close = "vehicle: default\nstart: [0, 0, 20]\ndirection: [1, 0, 0]\ndistance: 2.4\n"
                              "threats: [{position: [2.4, 0, 20], radius: 1}]\n";
    const ProblemFile near = problem_of(close);
    const auto too_close = solve_problem(near, 120000);
    EXPECT_EQ(too_close->status, PlanStatus::too_close);
    EXPECT_NE(plan_table(near, *too_close)
                  .find("Stop: the main threat is 2.40 m away, nearer than 2.5 of its radii (2.50 m)."),
              std::string::npos);
    EXPECT_EQ(plan_json(near, *too_close, true)["status"], "too_close");
    EXPECT_TRUE(plan_json(near, *too_close, true)["chosen"].is_null());
    EXPECT_TRUE(plan_json(near, *too_close, true)["path"].empty());
    EXPECT_EQ(plan_csv(near, *too_close).find('\n') + 1, plan_csv(near, *too_close).size());

    const std::string wall = "vehicle: default\nleg: {start: [0, 0, 20], end: [60, 0, 20]}\n"
                             "obstacles: [{box: {centre: [20, 0, 20], half_extents: [1, 300, 300]}}]\nmain_radius: 2\n";
    const ProblemFile blocked = problem_of(wall);
    const auto none = solve_problem(blocked, 1000000);
    EXPECT_EQ(none->status, PlanStatus::none_available);
    EXPECT_EQ(none->tries, blocked.settings.retries + 1U) << "all attempts made";
    EXPECT_NE(plan_table(blocked, *none).find("Stop: no candidate is available."), std::string::npos);
    EXPECT_NE(plan_table(blocked, *none).find("10 attempts, slower, further out and waiting"), std::string::npos);
    const auto reported = plan_json(blocked, *none, false);
    for (const auto& c : reported["candidates"]) {
        EXPECT_FALSE(c.contains("total"));
    }

    const ProblemFile hurried = problem_of(kCrossing + "settings: {check_acceleration: false}\n");
    for (const std::uint32_t units : {1U, 300U}) {
        const auto spent = solve_problem(hurried, units);
        EXPECT_EQ(spent->status, PlanStatus::budget_spent);
        EXPECT_NE(plan_table(hurried, *spent).find("Stop: the work budget ran out"), std::string::npos);
        const bool are_made = plan_table(hurried, *spent).find("not evaluated") != std::string::npos;
        EXPECT_EQ(are_made, units > 1) << "candidates";
    }
}

TEST(PlanOutput, ContactWithAThreatsPathIsNoNumberInJson)
{
    // Swept closeness to a threat whose path crosses every candidate, time-aware security: available, but in contact
    // with the path.
    const ProblemFile file =
        problem_of("vehicle: default\nleg: {start: [0, 0, 20], end: [60, 0, 20]}\n"
                   "threats:\n  - {position: [20, 0, 20], radius: 1, main: true}\n"
                   "  - {position: [5, -60, 20], velocity: [0, 15, 0], radius: 30}\n"
                   "settings: {closeness: swept, check_acceleration: false, verify_flight: false}\n");
    auto outcome = solve_problem(file, 120000);
    auto json = plan_json(file, *outcome, false);
    for (geometric::Candidate& c : outcome->result.candidates) {
        c.status = CandidateStatus::available;
        c.terms.closeness = std::numeric_limits<float>::infinity();
    }
    json = nlohmann::json::parse(plan_json(file, *outcome, false).dump());
    EXPECT_TRUE(json["candidates"][0]["terms"]["closeness"].is_null());
    EXPECT_NE(plan_csv(file, *outcome).find(",inf,"), std::string::npos);
}

TEST(PlanOutput, EveryStatusHasAName)
{
    for (const auto status : {PlanStatus::found, PlanStatus::no_conflict, PlanStatus::too_close,
                              PlanStatus::none_available, PlanStatus::budget_spent, PlanStatus::bad_input}) {
        EXPECT_NE(name_of(status), "?");
    }
    for (const auto status : {CandidateStatus::available, CandidateStatus::chosen, CandidateStatus::hits_static,
                              CandidateStatus::hits_moving, CandidateStatus::hits_airspace,
                              CandidateStatus::not_flyable, CandidateStatus::not_evaluated}) {
        EXPECT_NE(name_of(status), "?");
    }
    const ProblemFile file = problem_of(kCrossing);
    EXPECT_EQ(hit_name(file, {world::ThreatKind::track, 1}), "threat 1");
    EXPECT_EQ(hit_name(file, {world::ThreatKind::obstacle, 0}), "mast");
    EXPECT_EQ(hit_name(file, {world::ThreatKind::ceiling, 0}), "ceiling");
    EXPECT_EQ(hit_name(file, {world::ThreatKind::keep_in, 0}), "keep-in distance");
    EXPECT_EQ(hit_name(file, {}), "");
}

}  // namespace
