// SPDX-License-Identifier: BSD-3-Clause
// The other end of dronecan_check.py: reads frames from standard input, one transfer a line ("node id#data id#data
// ..."), and answers with the type's id and kind, its fields, and the frames that our own encoder makes of them.
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <sstream>

#include "tests/unit/link/dronecan_tools.hpp"

namespace {

using namespace jink;
using namespace jink::link::dronecan;
using namespace jink::link::dronecan::test;

constexpr std::array kAll{
    NodeStatus::kType,
    GetNodeInfoRequest::kType,
    GetNodeInfoResponse::kType,
    GetSetRequest::kType,
    GetSetResponse::kType,
    ExecuteOpcodeRequest::kType,
    ExecuteOpcodeResponse::kType,
    GlobalTimeSync::kType,
    Allocation::kType,
    LogMessage::kType,
    RangeMeasurement::kType,
    Proximity::kType,
    TrafficReport::kType,
    Fix2::kType,
    AhrsSolution::kType,
    TunnelTargetted::kType,
    TunnelBroadcast::kType,
};

std::string answer(const Transfer& transfer, std::uint8_t destination)
{
    std::string text = "undecoded";
    for_each_type([&]<class M>() {
        M message;
        if (M::kType.id != transfer.type.id || M::kType.kind != transfer.type.kind ||
            decode(transfer.payload, message) != CodecStatus::ok) {
            return;
        }
        text = std::to_string(M::kType.id) + "|" + print(message) + "|";
        for (const Frame& frame : frames_of(message, transfer.source, transfer.transfer,
                                            static_cast<Priority>(transfer.priority), destination)) {
            text.append(" ").append(text_of(frame));
        }
    });
    return text;
}

}  // namespace

int main()
{
    Receiver receiver(kAll);
    TimePoint now;
    std::string line;
    while (std::getline(std::cin, line)) {
        std::istringstream words(line);
        unsigned node = 0;
        words >> node;
        receiver.set_node(static_cast<std::uint8_t>(node));
        now = now + 3.0F;
        std::string result = "nothing";
        std::string word;
        while (words >> word) {
            const Transfer* const transfer = receiver.accept(frame_of(word), now);
            if (transfer != nullptr) {
                result = answer(*transfer, static_cast<std::uint8_t>(node));
            }
        }
        std::puts(result.c_str());
    }
    return 0;
}
