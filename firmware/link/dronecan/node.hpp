// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "firmware/link/dronecan/allocation_client.hpp"
#include "firmware/link/dronecan/messages.hpp"
#include "firmware/link/dronecan/receiver.hpp"
#include "firmware/link/dronecan/sensor_messages.hpp"
#include "firmware/link/dronecan/time_slave.hpp"
#include "firmware/link/dronecan/transmit_queue.hpp"
#include "firmware/link/link.hpp"
#include "firmware/link/param_server.hpp"

namespace jink::link::dronecan {

/// Types that are received; frames of other types are ignored.
inline constexpr std::array kTakenIn{
    GetNodeInfoRequest::kType, GetSetRequest::kType,   ExecuteOpcodeRequest::kType,
    GlobalTimeSync::kType,     Allocation::kType,      RangeMeasurement::kType,
    Proximity::kType,          TrafficReport::kType,   Fix2::kType,
    AhrsSolution::kType,       TunnelTargetted::kType, TunnelBroadcast::kType,
};
/// Messages that the node sends unasked: each has its own transfer ids.
inline constexpr std::array kSent{
    NodeStatus::kType, Allocation::kType,      LogMessage::kType,
    Proximity::kType,  TunnelTargetted::kType, TunnelBroadcast::kType,
};

/// Index of a type in kSent; kSent.size() if it is not there.
[[nodiscard]] constexpr std::size_t sent_index(std::uint16_t id) noexcept
{
    std::size_t i = 0;
    while (i < kSent.size() && kSent[i].id != id) {
        ++i;
    }
    return i;
}

struct NodeOptions {
    std::uint8_t node = kAnonymous;  ///< fixed node id 1 .. 127; kAnonymous: requests an id from the bus's allocator
    std::uint8_t preferred = 0;      ///< to request from the allocator; 0: any
    std::uint64_t seed = 1;          ///< of the allocation's random waits: differs between devices (from the unique id)
    std::string_view name = "org.jink.coprocessor";  ///< at most 80 characters; must outlive the node
    SoftwareVersion software;
    std::uint8_t hardware_major = 0;
    std::uint8_t hardware_minor = 0;
    UniqueId unique_id{};
};

struct NodeDiagnostics {
    std::array<std::uint32_t, 7> undecodable{};  ///< payloads by CodecStatus
    std::uint32_t unsendable = 0;                ///< messages with a number out of range
    std::uint32_t anonymous = 0;                 ///< messages not sent without a node id
    std::uint32_t id_conflicts = 0;              ///< frames of another node with our id, refused
    std::uint32_t answers = 0;
    std::uint32_t params_unknown = 0;  ///< requests of parameters that do not exist
    std::uint32_t values_refused = 0;  ///< to set: text, not finite, or not exact in a float
    std::uint32_t texts_cut = 0;       ///< of more than 90 characters
};

/// A DroneCAN node: the services that every node provides.
///
/// * NodeStatus once a second and at each change of health or mode, from `service` alone. If the application no longer
///   steps, the node is silent, and others declare it dead after 3 s.
/// * Answers GetNodeInfo, param.GetSet and param.ExecuteOpcode (save, erase) in the same call that receives them.
/// * Requests a node id if none is fixed; until then it sends allocation requests only, and answers nothing.
/// * Follows GlobalTimeSync.
/// * If another node uses our id, health is at least `warning` until 3 s after that node's last frame.
///
/// Memory: 6.7 KiB, most of it the receiver's and the transmit queue's.
class Node {
public:
    static constexpr Seconds kStatusPeriod = 1.0F;
    static constexpr Seconds kConflictShown = 3.0F;

    /// @param params  nullptr: there are no parameters, and each request is answered accordingly
    explicit Node(const NodeOptions& options, ParamServer* params = nullptr) noexcept;

    /// Processes a frame. A transfer that the node does not handle itself is returned, valid until the next call.
    [[nodiscard]] const Transfer* receive(const Frame& frame, TimePoint now) noexcept;
    /// Periodic work. Call every step, with the current state. Faults are sent as the status' vendor-specific code; a
    /// change of faults is sent with the next status. With `advising_only`, health is at least `warning` and the mode
    /// operational.
    void service(TimePoint now, const BusStatus& status) noexcept;
    void service(TimePoint now, SystemState state) noexcept { service(now, BusStatus{state, false, 0}); }
    /// Sets the server of the parameters; it must outlive the node.
    void serve(ParamServer& params) noexcept { params_ = &params; }

    /// Queues a message of a type in kSent. False, and counted, if there is no node id yet or a number does not fit.
    template <Described M>
    bool send(const M& message, Priority priority) noexcept
    {
        static_assert(M::kType.kind == TransferKind::message && sent_index(M::kType.id) < kSent.size());
        if (node_ == kAnonymous && M::kType.id != Allocation::kType.id) {
            ++diagnostics_.anonymous;
            return false;
        }
        std::uint8_t& transfer = transfers_[sent_index(M::kType.id)];
        if (!queue(message, {M::kType, priority, node_, 0, transfer})) {
            return false;
        }
        transfer = static_cast<std::uint8_t>((transfer + 1U) % kTransferIds);
        return true;
    }
    /// Sends a LogMessage; at most 90 characters.
    void send_text(Severity severity, std::string_view text) noexcept;

    /// Payload of `transfer` as `message`; false, and counted by cause, if the payload does not fit.
    template <Described M>
    [[nodiscard]] bool decode(const Transfer& transfer, M& message) noexcept
    {
        const CodecStatus status = dronecan::decode(transfer.payload, message);
        if (status != CodecStatus::ok) {
            ++diagnostics_.undecodable[static_cast<std::size_t>(status)];
        }
        return status == CodecStatus::ok;
    }

    /// kAnonymous until a node id is known.
    [[nodiscard]] std::uint8_t id() const noexcept { return node_; }
    [[nodiscard]] TransmitQueue& outgoing() noexcept { return outgoing_; }
    [[nodiscard]] const TransmitQueue& outgoing() const noexcept { return outgoing_; }
    [[nodiscard]] const TimeSlave& time() const noexcept { return time_; }
    [[nodiscard]] const NodeDiagnostics& diagnostics() const noexcept { return diagnostics_; }
    [[nodiscard]] const ReceiverDiagnostics& receiver_diagnostics() const noexcept { return receiver_.diagnostics(); }

private:
    template <Described M>
    bool queue(const M& message, const TransferHead& head) noexcept
    {
        std::size_t size = 0;
        if (encode(message, std::span(buffer_).first(M::kType.max_length), size) != CodecStatus::ok) {
            ++diagnostics_.unsendable;
            return false;
        }
        return outgoing_.push(head, std::span(buffer_).first(size));
    }
    template <Described M>
    void answer(const M& message, const Transfer& request) noexcept
    {
        if (queue(message,
                  {M::kType, static_cast<Priority>(request.priority), node_, request.source, request.transfer})) {
            ++diagnostics_.answers;
        }
    }

    void on_get_node_info(const Transfer& request) noexcept;
    void on_get_set(const Transfer& request) noexcept;
    void on_execute_opcode(const Transfer& request) noexcept;
    void on_time_sync(const Transfer& transfer) noexcept;
    void on_allocation(const Transfer& transfer, TimePoint now) noexcept;
    void set_node(std::uint8_t node) noexcept;

    NodeOptions options_;
    ParamServer* params_;
    std::uint8_t node_ = kAnonymous;
    Receiver receiver_{kTakenIn};
    TransmitQueue outgoing_;
    TimeSlave time_;
    AllocationClient allocation_;
    std::array<std::uint8_t, kSent.size()> transfers_{};
    std::array<std::byte, kMaxPayload> buffer_{};
    NodeStatus status_;
    bool started_ = false;
    bool status_sent_ = false;
    TimePoint start_;
    TimePoint last_status_;
    bool conflict_ = false;
    TimePoint last_conflict_;
    NodeDiagnostics diagnostics_;
};

}  // namespace jink::link::dronecan
