// SPDX-License-Identifier: BSD-3-Clause
// Flight logs read by @foxglove/ulog (npm), an independent implementation: every value of every message must be the
// same as by jink's own reader. Exit code 77: the peer is not installed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/flight_log/recorded_flight.hpp"
#include "tests/flight_log/stream_flight.hpp"
#include "tests/peer/peer_process.hpp"
#include "toolchain/sim/random_scenario.hpp"

namespace jink::test {
namespace {

using Lines = std::vector<std::string>;

std::string hex_of(std::uint32_t bits)
{
    std::array<char, 9> text{};
    std::snprintf(text.data(), text.size(), "%08x", bits);
    return text.data();
}

std::string value_of(const std::string& type, std::span<const std::byte> bytes)
{
    if (type == "float") {
        return hex_of(ulog::read_number<std::uint32_t>(bytes));
    }
    std::uint64_t value = 0;
    std::memcpy(&value, bytes.data(), ulog::size_of_type(type));
    return std::to_string(value);
}

std::string line_of(const ulog::Format& format, std::span<const std::byte> content)
{
    std::string line = format.name;
    for (const ulog::Field& field : format.fields) {
        const std::size_t size = ulog::size_of_type(field.type);
        for (std::size_t i = 0; i < field.count; ++i) {
            line += " " + value_of(field.type, content.subspan(field.offset + i * size, size));
        }
    }
    return line;
}

/// Of jink's own reader, as ulog.js prints them.
Lines own_lines(const std::string& log)
{
    std::istringstream in(log);
    ulog::Reader reader(in);
    Lines data;
    while (const auto message = reader.next()) {
        const std::span<const std::byte> content = message->content;
        if (message->type == ulog::Type::data) {
            data.push_back(line_of(*reader.topic(ulog::read_number<std::uint16_t>(content)), content.subspan(2)));
        } else if (message->type == ulog::Type::text) {
            const std::span<const std::byte> text = content.subspan(9);
            data.push_back(std::string("text ") + static_cast<char>(content[0]) + " " +
                           std::to_string(ulog::read_number<std::uint64_t>(content.subspan(1))) + " " +
                           std::string(reinterpret_cast<const char*>(text.data()), text.size()));
        }
    }
    Lines lines;
    for (const auto& [name, info] : reader.infos()) {
        lines.push_back("info " + name + " " + (info.type == "char" ? info.text() : value_of(info.type, info.value)));
    }
    for (const auto& [name, parameter] : reader.parameters()) {
        const float value = parameter.number().value_or(0.0F);
        lines.push_back("param " + name + " " + hex_of(std::bit_cast<std::uint32_t>(value)));
    }
    lines.insert(lines.end(), data.begin(), data.end());
    return lines;
}

/// The head in the order of names: the peer's is that of the file.
void sort_head(Lines& lines)
{
    const auto end = std::find_if(lines.begin(), lines.end(), [](const std::string& line) {
        return !line.starts_with("info ") && !line.starts_with("param ");
    });
    std::sort(lines.begin(), end);
}

Lines peer_lines(const std::string& log)
{
    const std::filesystem::path file =
        std::filesystem::temp_directory_path() / ("jink_ulog_peer_" + std::to_string(::getpid()) + ".ulg");
    std::ofstream(file, std::ios::binary) << log;
    PeerProcess peer({"node", "ulog.js", file.string()}, JINK_PEER_DIR);
    peer.finish_sending();
    std::istringstream output(peer.read_output());
    EXPECT_EQ(peer.wait(), 0);
    std::filesystem::remove(file);
    Lines lines;
    for (std::string line; std::getline(output, line);) {
        lines.push_back(line);
    }
    return lines;
}

void expect_the_same(const std::string& log, std::size_t more_than = 1'000)
{
    Lines own = own_lines(log);
    Lines peer = peer_lines(log);
    sort_head(own);
    sort_head(peer);
    ASSERT_EQ(own.size(), peer.size());
    ASSERT_GT(own.size(), more_than);
    for (std::size_t i = 0; i < own.size(); ++i) {
        ASSERT_EQ(own[i], peer[i]) << "line " << i;
    }
}

const std::string& flight()
{
    static const std::string log = [] {
        sim::Scenario scenario = sim::random_scenario(1);
        scenario.duration = 14.0;
        return fly_recorded(scenario, {}).log;
    }();
    return log;
}

TEST(UlogPeer, ReadsEveryValueOfAFlight)
{
    ASSERT_NE(flight().find("guidance rejoining -> avoiding"), std::string::npos) << "nothing was decided";
    expect_the_same(flight());
}

TEST(UlogPeer, ReadsObstaclesAndClosedAreas)
{
    sim::Scenario scenario = sim::crowded_scenario(1);
    scenario.duration = 5.0;
    scenario.areas.resize(2);
    scenario.areas[0].centre = {0.0, 300.0, 0.0};
    scenario.areas[1].centre = {0.0, -300.0, 0.0};
    scenario.areas[1].velocity = {1.0, 0.0, 0.0};
    for (sim::ClosedArea& area : scenario.areas) {
        area.radius = 10.0;
        area.top = 50.0;
    }
    const std::string log = fly_recorded(scenario, {}).log;
    const Lines lines = own_lines(log);
    for (const char* topic : {"jink_obstacle ", "jink_area "}) {
        EXPECT_GT(std::count_if(lines.begin(), lines.end(), [&](const auto& line) { return line.starts_with(topic); }),
                  5)
            << topic;
    }
    expect_the_same(log, 500);
}

TEST(UlogPeer, ReadsALogThatIsCut)
{
    for (const std::size_t lost : {1U, 17U, 100U, 1'000U}) {
        expect_the_same(flight().substr(0, flight().size() - lost));
    }
}

/// As a receiver puts it together, with and without gaps.
TEST(UlogPeer, ReadsALogThatABoardStreams)
{
    for (const double loss : {0.0, 0.2}) {
        StreamFlight s;
        s.lose_data = loss;
        ASSERT_TRUE(s.begin());
        ASSERT_EQ(s.ask(StreamFlight::kStart), StreamFlight::kAccepted);
        ASSERT_TRUE(s.fly_to_data());
        s.see_a_mast();
        s.fly(600);
        ASSERT_GT(s.manoeuvres, 0) << "nothing was decided";
        ASSERT_EQ(s.receiver.lost > 0, loss > 0.0);
        const Lines lines = own_lines(s.receiver.file);
        EXPECT_GT(std::count_if(lines.begin(), lines.end(),
                                [](const auto& line) { return line.starts_with("jink_candidate "); }),
                  8);
        expect_the_same(s.receiver.file, 200);
    }
}

}  // namespace
}  // namespace jink::test

int main(int argc, char** argv)
{
    if (!std::filesystem::exists(JINK_PEER_DIR "/node_modules/@foxglove/ulog") ||
        std::system("node --version >/dev/null 2>&1") != 0) {
        std::puts("skipped: no node, or the peer is not installed (tests/peer/setup.sh)");
        return 77;
    }
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
