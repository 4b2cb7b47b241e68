// SPDX-License-Identifier: BSD-3-Clause
// A flight image's log over the emulated line: asked for and acknowledged like a ground station does, put together and
// read. The board is the unmodified release image.
//
//   jink_board_log IMAGE MACHINE SCENARIO SECONDS
//
// Prints what the log holds. Status 1: the log does not hold the flight.
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <map>
#include <numeric>
#include <sstream>

#include <unistd.h>

#include "firmware/flight_log/topics.hpp"
#include "firmware/linux/flight_log/ulog_reader.hpp"
#include "tests/flight_log/stream_receiver.hpp"
#include "tests/target/board/board.hpp"
#include "toolchain/sim/scenario_file.hpp"

namespace {

using namespace jink;

/// Takes the parts that came since the last call, and acknowledges those that ask for it.
class GroundStation {
public:
    explicit GroundStation(target::Board& board) : board_(board) {}

    void start()
    {
        link::mavlink::CommandLong command;
        command.command = 2510;  // LOGGING_START
        board_.say(command);
    }
    void receive()
    {
        for (; next_ < board_.heard().size(); ++next_) {
            const target::Board::Heard& heard = board_.heard()[next_];
            const std::span<const std::byte> payload(heard.payload);
            const auto is = [&](std::uint32_t id) { return heard.id == id && heard.from.component_id == 196; };
            if (!is(link::mavlink::LoggingData::kInfo.id) && !is(link::mavlink::LoggingDataAcked::kInfo.id)) {
                continue;
            }
            const bool acknowledged = is(link::mavlink::LoggingDataAcked::kInfo.id);
            // Places in the payload, as MAVLink orders fields: sequence, target, length, offset, data.
            const auto sequence = ulog::read_number<std::uint16_t>(payload);
            receiver.take(sequence, std::to_integer<std::uint8_t>(payload[5]),
                          payload.subspan(6, std::to_integer<std::size_t>(payload[4])), acknowledged);
            if (acknowledged) {
                link::mavlink::LoggingAck ack;
                ack.sequence = sequence;
                board_.say(ack);
            }
        }
    }

    test::StreamReceiver receiver;

private:
    target::Board& board_;
    std::size_t next_ = 0;
};

template <class T>
T topic_of(std::span<const std::byte> content)
{
    T topic;
    std::memcpy(static_cast<void*>(&topic), content.data(), std::min(content.size(), sizeof topic));
    return topic;
}

/// @return whether the file is whole and has the flight
bool holds_the_flight(const std::string& file, double seconds)
{
    std::istringstream in(file);
    ulog::Reader reader(in);
    std::map<std::string, unsigned> topics;
    std::map<std::uint32_t, unsigned> lacking;  // candidates of each decision
    std::uint32_t left_out = 0;
    bool is_timed = false;
    bool controlled = false;
    while (const auto message = reader.next()) {
        if (message->type != ulog::Type::data) {
            continue;
        }
        const std::string& name = reader.topic(ulog::read_number<std::uint16_t>(message->content))->name;
        ++topics[name];
        const std::span<const std::byte> content = message->content.subspan(2);
        if (name == "jink_step") {
            const auto step = topic_of<flightlog::StepTopic>(content);
            controlled = controlled || step.control == static_cast<std::uint8_t>(app::Control::ours);
            is_timed = is_timed || step.duration_us != 0;
        } else if (name == "jink_decision") {
            const auto decision = topic_of<flightlog::DecisionTopic>(content);
            lacking[decision.decision] = decision.candidates;
        } else if (name == "jink_candidate") {
            --lacking[topic_of<flightlog::CandidateTopic>(content).decision];
        } else if (name == "jink_stream") {
            left_out = topic_of<flightlog::StreamTopic>(content).candidates_left_out;
        }
    }
    for (const auto& [name, count] : topics) {
        std::printf("%s %u\n", name.c_str(), count);
    }
    std::printf("end: %s\n", std::string(ulog::to_string(reader.end())).c_str());
    const unsigned missing = std::accumulate(lacking.begin(), lacking.end(), 0U,
                                             [](unsigned sum, const auto& decision) { return sum + decision.second; });
    std::printf("candidates missing: %u, left out: %u\n", missing, left_out);
    const auto least = [&](const char* name, double per_second) {
        return topics[name] >= static_cast<unsigned>(per_second * seconds);
    };
    // The emulated processor counts no cycles.
    return reader.end() == ulog::End::complete && controlled && !is_timed && topics["jink_decision"] > 0 &&
           topics["jink_candidate"] > 8 && missing == left_out && least("jink_step", 9.0) && least("jink_own", 9.0) &&
           least("jink_app_counters", 0.8);
}

}  // namespace

int main(int argc, char** argv)
{
    if (argc != 5) {
        std::fprintf(stderr, "usage: %s IMAGE MACHINE SCENARIO SECONDS\n", argv[0]);
        return 2;
    }
    std::string folder_name = "/tmp/jink_board_XXXXXX";
    const std::filesystem::path folder = ::mkdtemp(folder_name.data());
    int status = 1;
    try {
        const sim::Scenario scenario = sim::load_scenario(argv[3]);
        target::Board board(argv[1], argv[2], scenario, folder);
        GroundStation ground(board);
        board.debugger().go();
        const auto is_heard = [&] {
            return std::any_of(board.heard().begin(), board.heard().end(),
                               [](const auto& h) { return h.id == link::mavlink::Timesync::kInfo.id; });
        };
        bool good = board.fly_until(is_heard, 5.0);  // from here on the board knows its system
        ground.start();
        good = good && board.fly_until(
                           [&] {
                               ground.receive();
                               return ground.receiver.in_data;
                           },
                           board.seconds() + 5.0);
        const double begun = board.seconds();
        const double end = std::stod(argv[4]);
        static_cast<void>(board.fly_until(
            [&] {
                ground.receive();
                return false;
            },
            end));
        std::printf("data from %.2f s to %.2f s, %zu bytes, %d parts lost\n", begun, end, ground.receiver.file.size(),
                    ground.receiver.lost);
        good = good && holds_the_flight(ground.receiver.file, end - begun) && ground.receiver.lost == 0;
        status = good ? 0 : 1;
    } catch (const std::exception& e) {
        std::printf("%s: %s\n", argv[3], e.what());
    }
    std::filesystem::remove_all(folder);
    return status;
}
