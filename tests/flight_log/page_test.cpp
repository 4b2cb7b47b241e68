// SPDX-License-Identifier: BSD-3-Clause
// Pages of flight logs and runs: samples against the log's own messages, damaged logs, and the pages in a browser.
#include <sys/wait.h>

#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "tests/flight_log/page_log.hpp"
#include "toolchain/sim/in_process.hpp"
#include "toolchain/sim/report.hpp"
#include "toolchain/sim/scenario_file.hpp"

namespace {

using namespace jink::test;
namespace host = jink::host;
namespace sim = jink::sim;

TEST(FlightPage, SamplesAreWhatTheLogSays)
{
    const Scratch scratch;
    const host::PageFlight flight = page_of(scratch, page_flight().log);
    ASSERT_EQ(flight.decisions.size(), page_flight().manoeuvres);
    ASSERT_GT(flight.decisions.size(), 0U);
    EXPECT_EQ(flight.safety_distance, 1.0);
    EXPECT_EQ(flight.complaints, std::vector<std::string>());
    // Every own state of the log, against the samples around it.
    std::istringstream in(page_flight().log);
    jink::ulog::Reader log(in);
    std::uint64_t start = 0;
    std::size_t compared = 0;
    while (const auto message = log.next()) {
        if (message->type != jink::ulog::Type::data) {
            continue;
        }
        const auto content = message->content.subspan(2);
        const std::string& topic = log.topic(jink::ulog::read_number<std::uint16_t>(message->content))->name;
        const auto stamp = jink::ulog::read_number<std::uint64_t>(content);
        start = start == 0 && topic == "jink_step" ? stamp : start;
        if (topic != "jink_own") {
            continue;
        }
        jink::flightlog::OwnTopic own;
        std::memcpy(&own, content.data(), jink::flightlog::kBytesOf<jink::flightlog::OwnTopic>);
        const double time = static_cast<double>(stamp - start) * 1e-6;
        const auto i = static_cast<std::size_t>(time / 0.1);
        if (i + 1 >= flight.t.size() || std::isnan(flight.own.x[i])) {
            continue;
        }
        const double share = (time - flight.t[i]) / 0.1;
        // Between samples the path bends by less than 5 m/s2 * (0.1 s)^2, and a state is up to 0.1 s old.
        constexpr double kBend = 0.15;
        EXPECT_NEAR(flight.own.x[i] + share * (flight.own.x[i + 1] - flight.own.x[i]), double(own.position[0]), kBend);
        EXPECT_NEAR(flight.own.z[i] + share * (flight.own.z[i + 1] - flight.own.z[i]), double(own.position[2]), kBend);
        ++compared;
    }
    EXPECT_GT(compared, 500U);
}

TEST(FlightPage, CandidatesBeginAtTheVehicleAndTheChosenOneIsTheCheapestThatIsClear)
{
    const Scratch scratch;
    const host::PageFlight flight = page_of(scratch, page_flight().log);
    std::size_t chosen = 0;
    for (const host::PageDecision& decision : flight.decisions) {
        const auto i = static_cast<std::size_t>(decision.time / 0.1);
        double least_unchecked = 2.0;
        double cost = 0.0;
        for (const host::PageCandidate& candidate : decision.candidates) {
            ASSERT_EQ(candidate.points.x.size(), 25U);
            EXPECT_LT(std::hypot(candidate.points.x[0] - flight.own.x[i], candidate.points.y[0] - flight.own.y[i]),
                      1.5);
            if (candidate.fate == host::Fate::more_expensive) {
                least_unchecked = std::min(least_unchecked, candidate.cost);
            } else if (candidate.fate == host::Fate::chosen) {
                cost = candidate.cost;
                ++chosen;
            }
        }
        EXPECT_LE(cost, least_unchecked + 0.15) << "0.15: penalty for changing sides";
    }
    EXPECT_GT(chosen, 0U);
}

/// Until something is in the way the vehicle flies where the paths led.
TEST(FlightPage, NominalPathsLeadWhereTheVehicleFlies)
{
    const Scratch scratch;
    const host::PageFlight flight = page_of(scratch, page_flight().log);
    const auto own_at = [&](double time) {
        const auto i = static_cast<std::size_t>(time / 0.1);
        return std::array{flight.own.x.at(i), flight.own.y.at(i), flight.own.z.at(i)};
    };
    std::size_t compared = 0;
    double before = 0.0;
    for (const host::PageNominal& nominal : flight.nominal) {
        EXPECT_GE(nominal.time, before);
        before = nominal.time;
        ASSERT_GE(nominal.points.x.size(), 2U);
        const auto own = own_at(nominal.time);
        if (std::isnan(own[0]) || nominal.time < 2.0 || nominal.time > flight.decisions.at(0).time - 1.0) {
            continue;
        }
        EXPECT_LT(std::hypot(nominal.points.x[0] - own[0], nominal.points.y[0] - own[1], nominal.points.z[0] - own[2]),
                  1.5);
        const auto later = own_at(nominal.time + 1.0);
        const double along_x = nominal.points.x[1] - nominal.points.x[0];
        const double along_y = nominal.points.y[1] - nominal.points.y[0];
        const double moved_x = later[0] - own[0];
        const double moved_y = later[1] - own[1];
        EXPECT_GT(along_x * moved_x + along_y * moved_y,
                  0.9 * std::hypot(along_x, along_y) * std::hypot(moved_x, moved_y));
        ++compared;
    }
    EXPECT_GT(compared, 10U);
}

TEST(FlightPage, DamagedLogsGiveAPageOrAReason)
{
    const Scratch scratch;
    std::mt19937 random(20260117);
    const std::string& good = page_flight().log;
    std::size_t pages = 0;
    std::size_t refused = 0;
    for (int i = 0; i < 60; ++i) {
        std::string log = good.substr(0, i % 3 == 0 ? random() % good.size() : good.size() / 4);
        for (unsigned flips = i % 3 == 1 ? 1 + random() % 30 : 0; flips > 0 && !log.empty(); --flips) {
            log[random() % log.size()] = static_cast<char>(random());
        }
        if (i % 3 == 2) {  // numbers that cannot be, in place of what was measured
            for (int k = 0; k < 200; ++k) {
                const float value = k % 2 == 0 ? std::numeric_limits<float>::quiet_NaN() : 3e38F;
                std::memcpy(log.data() + 8000 + random() % (log.size() - 8004), &value, sizeof value);
            }
        }
        try {
            const std::vector<host::PageSource> sources{host::read_flight_log(scratch.write("bad.ulg", log))};
            EXPECT_LT(host::page_data(sources).size(), 10 * good.size());
            ++pages;
        } catch (const host::BadFlight& error) {
            EXPECT_NE(std::string(error.what()).find("bad.ulg: "), std::string::npos) << error.what();
            ++refused;
        }
    }
    EXPECT_GT(pages, 10U);
    EXPECT_GT(refused, 0U);
}

TEST(FlightPage, ABoardsLogHasItsCandidates)
{
    const Scratch scratch;
    const host::PageFlight flight = page_of(scratch, board_log());
    ASSERT_GT(flight.decisions.size(), 0U);
    std::size_t chosen = 0;
    for (const host::PageDecision& decision : flight.decisions) {
        EXPECT_GT(decision.candidates.size(), 8U);
        EXPECT_EQ(decision.known, static_cast<double>(decision.candidates.size()));
        EXPECT_TRUE(decision.text.starts_with("guidance ")) << decision.text;
        for (const host::PageCandidate& candidate : decision.candidates) {
            EXPECT_EQ(candidate.points.x.size(), 25U);
        }
        chosen += count_of(decision, host::Fate::chosen);
    }
    EXPECT_GT(chosen, 0U);
    ASSERT_EQ(flight.threats.size(), 1U);
    const auto& x = flight.threats[0].position.x;
    EXPECT_EQ(std::count_if(x.begin(), x.end(), [](double value) { return std::isnan(value); }), 0) << x.size();
}

TEST(FlightPage, CandidatesThatTheLogLacksAreCountedAndTheOthersKeepTheirFate)
{
    using jink::flightlog::CandidateTopic;
    using jink::flightlog::DecisionTopic;
    const Scratch scratch;
    const host::PageDecision whole = page_of(scratch, board_log()).decisions.at(0);
    ASSERT_EQ(count_of(whole, host::Fate::chosen), 1U);
    ASSERT_GT(count_of(whole, host::Fate::more_expensive), 0U);
    const auto chosen = static_cast<std::uint8_t>(jink::geometric::CandidateStatus::chosen);
    // Without the chosen one the rest was still not checked because of it.
    const std::string headless = without_candidates(board_log(), [&](const auto& c) { return c.status == chosen; });
    const host::PageDecision rest = page_of(scratch, headless).decisions.at(0);
    EXPECT_EQ(rest.candidates.size() + 1, whole.candidates.size());
    EXPECT_EQ(rest.known, whole.known);
    EXPECT_EQ(count_of(rest, host::Fate::more_expensive), count_of(whole, host::Fate::more_expensive));
    EXPECT_EQ(count_of(rest, host::Fate::budget_spent), count_of(whole, host::Fate::budget_spent));
    // None of them.
    const std::string none = without_candidates(board_log(), [](const auto&) { return true; });
    const host::PageDecision bare = page_of(scratch, none).decisions.at(0);
    EXPECT_TRUE(bare.candidates.empty());
    EXPECT_EQ(bare.known, whole.known);
    // The decision itself: neither curves nor their number are known.
    const std::string lost =
        without<DecisionTopic>(board_log(), jink::flightlog::TopicId::decision, [](const auto&) { return true; });
    const std::vector<host::PageSource> sources{host::read_flight_log(scratch.write("lost.ulg", lost))};
    const host::PageDecision& unknown = sources[0].flights[0].decisions.at(0);
    EXPECT_TRUE(unknown.candidates.empty());
    EXPECT_TRUE(std::isnan(unknown.known));
    EXPECT_NE(host::page_data(sources).find("\"candidates_known\":null"), std::string::npos);
}

/// Logs of before have neither their number nor the chosen one in the decision: they are complete.
TEST(FlightPage, ALogThatDoesNotSayHowManyCandidatesThereAreIsTakenAsComplete)
{
    std::string log = page_flight().log;
    const std::string fields = "uint16_t candidates;uint16_t chosen;";
    const std::size_t at = log.find(fields);
    ASSERT_NE(at, std::string::npos);
    log.replace(at, fields.size(), "uint16_t something1;uint16_t other1;");
    const Scratch scratch;
    const host::PageFlight before = page_of(scratch, log);
    const host::PageFlight now = page_of(scratch, page_flight().log);
    ASSERT_EQ(before.decisions.size(), now.decisions.size());
    for (std::size_t i = 0; i < now.decisions.size(); ++i) {
        EXPECT_EQ(before.decisions[i].known, now.decisions[i].known);
        ASSERT_EQ(before.decisions[i].candidates.size(), now.decisions[i].candidates.size());
        for (std::size_t k = 0; k < now.decisions[i].candidates.size(); ++k) {
            EXPECT_EQ(before.decisions[i].candidates[k].fate, now.decisions[i].candidates[k].fate);
        }
    }
}

/// The same scenario twice, the second time with other parameters.
void write_runs(const Scratch& scratch)
{
    for (const char* file : {"run.json", "changed.json"}) {
        std::vector<sim::ReportedFlight> flights;
        for (const char* name : {"head_on", "wall", "tuning_2"}) {
            sim::Scenario scenario = sim::load_scenario(std::string(JINK_SCENARIOS "/") + name + ".yaml");
            scenario.parameters["JNK_LOOKAHEAD"] = file[0] == 'r' ? 8.0 : 6.0;
            flights.push_back(sim::report_on(scenario, sim::fly_in_process(scenario), false));
        }
        static_cast<void>(scratch.write(file, sim::run_text(flights, true)));
    }
}

TEST(FlightPage, ShowsItAllInABrowser)
{
    if (std::system("command -v chromium >/dev/null") != 0) {
        GTEST_SKIP() << "no chromium";
    }
    const Scratch scratch;
    write_runs(scratch);
    static_cast<void>(scratch.write("flight.ulg", page_flight().log));
    // Of its first decision every third candidate is missing.
    static_cast<void>(scratch.write("board.ulg", without_candidates(board_log(), [](const auto& candidate) {
                                        return candidate.decision == 1 && candidate.index % 3 == 0;
                                    })));
    sim::Scenario seen = sim::load_scenario(JINK_SCENARIOS "/scan_wall.yaml");
    seen.duration = 14.0;
    seen.areas = sim::load_scenario(JINK_SCENARIOS "/storm_crossing.yaml").areas;
    static_cast<void>(scratch.write("wall.ulg", fly_recorded(seen, {}).log));
    const std::string command = "/usr/bin/python3 -B '" JINK_VIEWER_TEST "' --jink '" JINK_PROGRAM "' --input '" +
                                scratch.path().string() + "'";
    const int status = std::system(command.c_str());
    if (WIFEXITED(status) && WEXITSTATUS(status) == 77) {
        GTEST_SKIP() << "the viewer has not been built";
    }
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << "see the lines FAILED above";
}

}  // namespace
