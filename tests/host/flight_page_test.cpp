// SPDX-License-Identifier: BSD-3-Clause
// Data of the page of jink report: columns, unknown values, fates.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include <nlohmann/json.hpp>

#include "toolchain/host/flight_page.hpp"

namespace {

using namespace jink::host;
namespace flightlog = jink::flightlog;

std::vector<unsigned> bytes_of(const std::string& base64)
{
    std::vector<unsigned> bytes;
    unsigned bits = 0;
    int count = 0;
    for (const char c : base64) {
        if (c == '=') {
            break;
        }
        const unsigned six = c >= 'A' && c <= 'Z'   ? unsigned(c - 'A')
                             : c >= 'a' && c <= 'z' ? unsigned(c - 'a') + 26
                             : c >= '0' && c <= '9' ? unsigned(c - '0') + 52
                             : c == '+'             ? 62
                                                    : 63;
        bits = bits << 6U | six;
        count += 6;
        if (count >= 8) {
            count -= 8;
            bytes.push_back(bits >> unsigned(count) & 255U);
        }
    }
    return bytes;
}

std::vector<double> decoded(const nlohmann::json& column)
{
    const std::vector<unsigned> bytes = bytes_of(column["data"].get<std::string>());
    const std::size_t width = column["bytes"];
    std::vector<double> values;
    for (std::size_t i = 0; i + width <= bytes.size(); i += width) {
        std::uint64_t code = 0;
        for (std::size_t k = width; k-- > 0;) {
            code = code << 8U | bytes[i + k];
        }
        const std::uint64_t none = width == 2 ? 0xFFFFU : 0xFFFFFFFFU;
        values.push_back(code == none ? kUnknown
                                      : column["from"].get<double>() + column["step"].get<double>() * double(code));
    }
    return values;
}

std::vector<double> through_page(const Column& values)
{
    PageFlight flight;
    flight.separation = values;
    return decoded(nlohmann::json::parse(page_data({{"x", {flight}}}))[0]["flights"][0]["separation"]);
}

TEST(FlightPageData, ColumnsAreExactToHalfACentimetre)
{
    std::mt19937_64 random(5);
    for (int round = 0; round < 300; ++round) {
        const double span = std::pow(10.0, std::uniform_real_distribution<>(-3.0, 6.9)(random));
        std::uniform_real_distribution<> value(-span, span);
        Column values(random() % 70);
        for (double& v : values) {
            v = random() % 9 == 0 ? kUnknown : value(random);
        }
        const std::vector<double> read = through_page(values);
        ASSERT_EQ(read.size(), values.size());
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (std::isnan(values[i])) {
                EXPECT_TRUE(std::isnan(read[i]));
            } else {
                EXPECT_NEAR(read[i], values[i], 0.005 + 1e-8) << span;
            }
        }
    }
}

TEST(FlightPageData, EdgesOfTheRange)
{
    EXPECT_EQ(through_page({}).size(), 0U);
    for (const double strange : {kUnknown, double(INFINITY), -double(INFINITY), 1e300, -2e7}) {
        const std::vector<double> read = through_page({strange, 1.0});
        EXPECT_TRUE(std::isnan(read[0])) << strange;
        EXPECT_NEAR(read[1], 1.0, 1e-9);
        EXPECT_TRUE(std::isnan(through_page({strange})[0]));
    }
    // The last code of two bytes means unknown: one step before, at and after it.
    for (const double high : {655.33, 655.34, 655.35, 655.36}) {
        EXPECT_NEAR(through_page({0.0, high})[1], high, 1e-9);
    }
    EXPECT_NEAR(through_page({-kMaxShown, kMaxShown})[1], kMaxShown, 0.01);
}

TEST(FlightPageData, TextsCannotLeaveTheirElement)
{
    PageFlight flight;
    flight.title = "</script><script>alert(1)</script> \xFF \u2028";
    const std::string text = page_data({{"<x>", {flight}}});
    EXPECT_EQ(text.find('<'), std::string::npos);
    EXPECT_EQ(nlohmann::json::parse(text)[0]["flights"][0]["title"].get<std::string>().substr(0, 9), "</script>");
    EXPECT_THROW(static_cast<void>(make_page("no mark", {})), BadFlight);
    EXPECT_EQ(make_page("a \"JINK_FLIGHTS\" b", {}), "a [] b");
}

TEST(FlightPageData, UncheckedCandidates)
{
    EXPECT_EQ(flightlog::fate_of_unchecked(true, true, false), flightlog::Fate::more_expensive);
    EXPECT_EQ(flightlog::fate_of_unchecked(true, false, true), flightlog::Fate::more_expensive) << "above GEO_MAX_COST";
    EXPECT_EQ(flightlog::fate_of_unchecked(true, false, false), flightlog::Fate::budget_spent);
    EXPECT_EQ(flightlog::fate_of_unchecked(false, true, false), flightlog::Fate::budget_spent)
        << "its cost was never computed";
    EXPECT_EQ(flightlog::fate_of_unchecked(false, false, false), flightlog::Fate::budget_spent);
}

TEST(ReadRun, ARefusalPointsAtTheWrongValue)
{
    using nlohmann::json;
    const json good{{"format", "jink-sim run"},
                    {"version", 2},
                    {"flights",
                     {{{"name", "one: [2], {\"3\"}"},
                       {"as_expected", true},
                       {"promise", 0.7},
                       {"least", {{"surface", 1.5}, {"t", 1.0}, {"threat", "a\\"}}},
                       {"mission", {{0, 0, 30}, {60, 0, 30}}},
                       {"threats", {{{"name", "a\\"}, {"radius", 1.0}, {"moves", true}, {"positions", {{9, 0, 30}}}}}},
                       {"series", {{"t", {0.0}}, {"position", {{1, 2, 30}}}, {"mode", {"mission"}}}},
                       {"decisions", {{{"t", 0.5}, {"text", ""}, {"start", {0, 0, 30}}}}}}}}};
    const json wrong{{"@", "]}"}};  // an object where none is expected
    const auto file = std::filesystem::path(testing::TempDir()) / "wrong_run.json";
    const json flat = good.flatten();
    std::size_t refused = 0;
    for (const auto& [at, value] : flat.items()) {
        for (const int indent : {-1, 0, 3}) {
            json one = good;
            one[json::json_pointer(at)] = wrong;
            const std::string text = one.dump(indent);
            std::ofstream(file, std::ios::binary) << text;
            std::string said;
            try {
                static_cast<void>(read_run(file));
            } catch (const BadFlight& error) {
                said = error.what();
            }
            const std::size_t place = text.rfind('{', text.find("\"@\""));
            const std::size_t begin = text.rfind('\n', place) + 1;
            const auto line = std::count(text.begin(), text.begin() + std::ptrdiff_t(place), '\n') + 1;
            const std::string expected =
                file.string() + ":" + std::to_string(line) + ":" + std::to_string(place - begin + 1) + ": ";
            EXPECT_TRUE(said.starts_with(expected)) << at << ": " << said << " expected: " << expected << "\n" << text;
            refused += said.empty() ? 0U : 1U;
        }
    }
    EXPECT_EQ(refused, 3 * flat.size());
}

}  // namespace
