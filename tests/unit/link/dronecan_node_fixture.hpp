// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "tests/unit/link/dronecan_tools.hpp"

namespace jink::link::dronecan::test {

inline constexpr std::uint8_t kOwn = 42;
inline constexpr std::uint8_t kAsker = 10;

inline ParamName param_name(std::string_view text)
{
    ParamName name{};
    std::copy(text.begin(), text.end(), name.begin());
    return name;
}

/// Two parameters, one an integer; refuses values out of range, as the application does.
class Params final : public ParamServer {
public:
    bool read(std::uint16_t index, ParamEntry& entry) const noexcept override
    {
        if (index >= entries.size()) {
            return false;
        }
        entry = entries[index];
        return true;
    }
    bool find(const ParamName& name, std::uint16_t& index) const noexcept override
    {
        for (std::size_t i = 0; i < entries.size(); ++i) {
            if (entries[i].name == name) {
                index = static_cast<std::uint16_t>(i);
                return true;
            }
        }
        return false;
    }
    void write(std::uint16_t index, float value) noexcept override
    {
        ++writes;
        ParamEntry& entry = entries[index];
        if (value >= entry.low && value <= entry.high && (!entry.integer || std::round(value) == value)) {
            entry.value = value;
        }
    }
    bool save() noexcept override { return can_save && ++saves > 0; }
    bool erase() noexcept override { return ++erases > 0; }

    std::array<ParamEntry, 2> entries{
        ParamEntry{param_name("JNK_MODE"), 2.0F, 2.0F, 0.0F, 2.0F, true},
        ParamEntry{param_name("JNK_SIXTEEN_CHAR"), 12.5F, 10.0F, 1.0F, 60.0F, false},
    };
    int writes = 0, saves = 0, erases = 0;
    bool can_save = true;
};

class DronecanNode : public testing::Test {
protected:
    /// All queued output of the node, assembled by a separate receiver; payloads by type and kind.
    struct Heard {
        TypeInfo type;
        std::uint8_t source, transfer, priority;
        Bytes payload;
    };
    std::vector<Heard> heard(Node& node, std::uint8_t listener = kAsker)
    {
        static constexpr std::array kListen{NodeStatus::kType,
                                            GetNodeInfoResponse::kType,
                                            GetSetResponse::kType,
                                            Allocation::kType,
                                            ExecuteOpcodeResponse::kType,
                                            LogMessage::kType,
                                            TunnelTargetted::kType,
                                            Proximity::kType};
        Receiver receiver(kListen);
        receiver.set_node(listener);
        std::vector<Heard> all;
        while (node.outgoing().front() != nullptr) {
            if (const Transfer* const t = receiver.accept(*node.outgoing().front(), now)) {
                all.push_back({t->type, t->source, t->transfer, t->priority, {t->payload.begin(), t->payload.end()}});
            }
            node.outgoing().pop();
        }
        return all;
    }
    template <Described M>
    std::optional<M> answer(Node& node, std::uint8_t listener = kAsker)
    {
        M message;
        for (const Heard& h : heard(node, listener)) {
            if (h.type.id == M::kType.id && h.type.kind == M::kType.kind &&
                decode(h.payload, message) == CodecStatus::ok) {
                return message;
            }
        }
        return std::nullopt;
    }
    template <Described M>
    const Transfer* give(Node& node, const M& message, std::uint8_t source = kAsker)
    {
        const Transfer* transfer = nullptr;
        for (const Frame& frame : frames_of(message, source, transfer_, Priority::high, kOwn)) {
            transfer = node.receive(frame, now);
        }
        transfer_ = static_cast<std::uint8_t>((transfer_ + 1U) % kTransferIds);
        return transfer;
    }
    static NodeOptions fixed()
    {
        NodeOptions options;
        options.node = kOwn;
        options.software = {1, 2, SoftwareVersion::kHasCommit, 0xDEADBEEF, 0};
        options.hardware_major = 3;
        for (std::size_t i = 0; i < options.unique_id.size(); ++i) {
            options.unique_id[i] = static_cast<std::uint8_t>(0xA0 + i);
        }
        return options;
    }

    Params params;
    TimePoint now{1'000'000};
    std::uint8_t transfer_ = 0;
};

}  // namespace jink::link::dronecan::test
