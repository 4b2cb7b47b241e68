// SPDX-License-Identifier: BSD-3-Clause
// Pages of flight logs with aircraft under one id, and with parameters that change in the flight.
#include <gtest/gtest.h>

#include "tests/flight_log/page_log.hpp"

namespace {

using namespace jink::test;
namespace host = jink::host;

/// A second aircraft under the id of each track, 1 km to the east of it.
TEST(FlightPage, TwoAircraftUnderOneIdAreTwoThreats)
{
    using jink::flightlog::TrackTopic;
    const std::string log = rewritten(board_log(), [](const std::string& message) {
        if (!is_of(message, jink::flightlog::TopicId::track)) {
            return message;
        }
        constexpr std::size_t kContent = 5;  // behind the header and the topic's id
        auto track = topic_of<TrackTopic>(std::as_bytes(std::span(message)).subspan(3));
        track.position[0] += 1000.0F;
        ++track.instance;
        std::string other = message;
        std::memcpy(other.data() + kContent, &track, jink::flightlog::kBytesOf<TrackTopic>);
        return message + other;
    });
    const Scratch scratch;
    const host::PageFlight alone = page_of(scratch, board_log());
    const host::PageFlight both = page_of(scratch, log);
    ASSERT_GT(alone.threats.size(), 0U);
    ASSERT_EQ(both.threats.size(), 2 * alone.threats.size());
    EXPECT_EQ(both.least, alone.least);
    EXPECT_EQ(both.least_threat, alone.least_threat);
    for (std::size_t i = 0; i < alone.threats.size(); ++i) {
        EXPECT_EQ(both.threats[2 * i].name, alone.threats[i].name);
        EXPECT_EQ(both.threats[2 * i + 1].name, alone.threats[i].name + " (2)");
        EXPECT_EQ(both.threats[2 * i].position.x.size(), alone.threats[i].position.x.size());
    }
}

std::string parameter_message(const char* name, float value)
{
    jink::ulog::Messages message;
    message.parameter(name, value);
    return {reinterpret_cast<const char*>(message.bytes().data()), message.bytes().size()};
}

/// The log with another value of a parameter from the first message on for which `is_after` holds.
template <class IsAfter>
std::string with_change(const std::string& log, const char* name, float value, IsAfter is_after)
{
    bool is_made = false;
    return rewritten(log, [&](const std::string& message) {
        const bool is_first = !is_made && is_after(message);
        is_made = is_made || is_first;
        return is_first ? parameter_message(name, value) + message : message;
    });
}

/// Before the change as with the old value all the time, after it as with the new one.
TEST(FlightPage, NominalPathsAreAsLongAsTheLookaheadOfTheirTime)
{
    using jink::flightlog::NominalTopic;
    const Scratch scratch;
    const std::string& log = page_flight().log;
    const host::PageFlight before = page_of(scratch, log);
    ASSERT_GT(before.nominal.size(), 10U);
    const double middle = before.nominal[before.nominal.size() / 2].time;
    std::uint64_t start = 0;
    const auto is_nominal = [&](const std::string& message, double from) {
        const auto content = std::as_bytes(std::span(message)).subspan(3);
        if (start == 0 && is_of(message, jink::flightlog::TopicId::step)) {
            start = topic_of<jink::flightlog::StepTopic>(content).timestamp;
        }
        return is_of(message, jink::flightlog::TopicId::nominal) &&
               static_cast<double>(topic_of<NominalTopic>(content).timestamp - start) * 1e-6 > from - 1e-3;
    };
    const auto changed_at = [&](double from) {
        return page_of(scratch, with_change(log, "JNK_LOOKAHEAD", 1.0F,
                                            [&](const std::string& message) { return is_nominal(message, from); }));
    };
    const host::PageFlight after = changed_at(0.0);
    const host::PageFlight both = changed_at(middle);
    ASSERT_EQ(both.nominal.size(), before.nominal.size());
    std::size_t shorter = 0;
    for (std::size_t i = 0; i < both.nominal.size(); ++i) {
        const bool is_before = both.nominal[i].time < middle - 1e-3;
        const host::PageNominal& expected = is_before ? before.nominal[i] : after.nominal[i];
        EXPECT_EQ(both.nominal[i].points.x, expected.points.x) << both.nominal[i].time;
        EXPECT_EQ(both.nominal[i].points.y, expected.points.y) << both.nominal[i].time;
        shorter += !is_before && before.nominal[i].points.x != after.nominal[i].points.x ? 1 : 0;
    }
    EXPECT_GT(shorter, 0U);
}

/// The decision's own limit counts, not the one of the log's beginning or of its end.
TEST(FlightPage, CandidatesAreHeldAgainstTheCostLimitOfTheirTime)
{
    using jink::flightlog::DecisionTopic;
    using jink::flightlog::TopicId;
    const auto chosen = static_cast<std::uint8_t>(jink::geometric::CandidateStatus::chosen);
    // A plan that found nothing: what is not checked is above the limit, or the budget was spent.
    const std::string none_found =
        rewritten(without_candidates(board_log(), [&](const auto& c) { return c.status == chosen; }),
                  [](const std::string& message) {
                      if (!is_of(message, TopicId::decision)) {
                          return message;
                      }
                      auto decision = topic_of<DecisionTopic>(std::as_bytes(std::span(message)).subspan(3));
                      decision.chosen = DecisionTopic::kNoneChosen;
                      std::string made = message;
                      std::memcpy(made.data() + 5, &decision, jink::flightlog::kBytesOf<DecisionTopic>);
                      return made;
                  });
    const Scratch scratch;
    const host::PageDecision spent = page_of(scratch, none_found).decisions.at(0);
    ASSERT_GT(count_of(spent, host::Fate::budget_spent), 0U);
    const std::string limited =
        with_change(none_found, "GEO_MAX_COST", 0.0F,
                    [](const std::string& message) { return is_of(message, TopicId::decision); }) +
        parameter_message("GEO_MAX_COST", 1.0F);
    const host::PageDecision expensive = page_of(scratch, limited).decisions.at(0);
    EXPECT_GT(count_of(expensive, host::Fate::more_expensive), count_of(spent, host::Fate::more_expensive));
    EXPECT_EQ(count_of(expensive, host::Fate::more_expensive) + count_of(expensive, host::Fate::budget_spent),
              count_of(spent, host::Fate::more_expensive) + count_of(spent, host::Fate::budget_spent));
}

}  // namespace
