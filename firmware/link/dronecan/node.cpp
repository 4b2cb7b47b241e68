// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/link/dronecan/node.hpp"

#include <algorithm>
#include <cmath>

namespace jink::link::dronecan {
namespace {

template <std::size_t N>
void assign(StaticVector<std::uint8_t, N>& to, std::string_view text) noexcept
{
    to.clear();
    for (const char c : text.substr(0, N)) {
        to.unchecked_push_back(static_cast<std::uint8_t>(c));
    }
}

[[nodiscard]] Health health_of(SystemState state) noexcept
{
    switch (state) {
    case SystemState::emergency: return Health::critical;
    case SystemState::critical: return Health::error;
    case SystemState::boot:
    case SystemState::standby:
    case SystemState::active: break;
    }
    return Health::ok;
}

[[nodiscard]] LogLevel level_of(Severity severity) noexcept
{
    switch (severity) {
    case Severity::critical:
    case Severity::error: return LogLevel::error;
    case Severity::warning: return LogLevel::warning;
    case Severity::notice:
    case Severity::info: break;
    }
    return LogLevel::info;
}

/// Value in a parameter's type.
template <class Value>
[[nodiscard]] Value value_of(float value, bool integer) noexcept
{
    Value out;
    if (integer) {
        out.tag = Value::Tag::integer;
        out.integer = static_cast<std::int64_t>(std::llround(value));
    } else {
        out.tag = Value::Tag::real;
        out.real = value;
    }
    return out;
}

/// The number in `value`; false unless a float holds the number exactly.
[[nodiscard]] bool number_of(const ParamValue& value, float& number) noexcept
{
    constexpr std::int64_t kExact = 1 << 24;
    switch (value.tag) {
    case ParamValue::Tag::real: number = value.real; return std::isfinite(value.real);
    case ParamValue::Tag::integer:
        number = static_cast<float>(value.integer);
        return value.integer >= -kExact && value.integer <= kExact;
    case ParamValue::Tag::boolean: number = value.boolean != 0 ? 1.0F : 0.0F; return true;
    case ParamValue::Tag::empty:
    case ParamValue::Tag::text: break;
    }
    return false;
}

/// False: longer than any of our names.
[[nodiscard]] bool name_of(const Text92& text, ParamName& name) noexcept
{
    name = {};
    if (text.size() > name.size()) {
        return false;
    }
    std::transform(text.begin(), text.end(), name.begin(), [](std::uint8_t c) { return static_cast<char>(c); });
    return true;
}

}  // namespace

Node::Node(const NodeOptions& options, ParamServer* params) noexcept
    : options_(options), params_(params), allocation_(options.unique_id, options.preferred, options.seed)
{
    set_node(options.node <= kMaxNode ? options.node : kAnonymous);
}

void Node::set_node(std::uint8_t node) noexcept
{
    node_ = node;
    receiver_.set_node(node);
}

const Transfer* Node::receive(const Frame& frame, TimePoint now) noexcept
{
    if (node_ != kAnonymous && frame.extended && !frame.remote && unpack(frame.id).source == node_) {
        ++diagnostics_.id_conflicts;
        conflict_ = true;
        last_conflict_ = now;
        return nullptr;
    }
    const Transfer* const transfer = receiver_.accept(frame, now);
    if (transfer == nullptr) {
        return nullptr;
    }
    if (transfer->type.kind == TransferKind::request) {
        switch (transfer->type.id) {
        case GetNodeInfoRequest::kType.id: on_get_node_info(*transfer); break;
        case GetSetRequest::kType.id: on_get_set(*transfer); break;
        case ExecuteOpcodeRequest::kType.id: on_execute_opcode(*transfer); break;
        default: break;
        }
        return nullptr;
    }
    switch (transfer->type.id) {
    case GlobalTimeSync::kType.id: on_time_sync(*transfer); return nullptr;
    case Allocation::kType.id: on_allocation(*transfer, now); return nullptr;
    default: return transfer;
    }
}

void Node::service(TimePoint now, const BusStatus& own) noexcept
{
    if (!started_) {
        started_ = true;
        start_ = now;
    }
    if (node_ == kAnonymous) {
        if (const std::optional<Allocation> request = allocation_.poll(now)) {
            static_cast<void>(send(*request, Priority::low));
        }
        return;
    }
    conflict_ = conflict_ && now - last_conflict_ <= kConflictShown;
    NodeStatus status;
    status.uptime = static_cast<std::uint32_t>((now.us - start_.us) / 1'000'000);
    status.health = std::max(health_of(own.state), conflict_ || own.advising_only ? Health::warning : Health::ok);
    status.mode = own.state == SystemState::boot && !own.advising_only ? Mode::initialization : Mode::operational;
    status.vendor_status = own.faults;
    const bool changed = status.health != status_.health || status.mode != status_.mode;
    status_ = status;
    if (!status_sent_ || changed || now - last_status_ >= kStatusPeriod) {
        status_sent_ = send(status, Priority::low);
        last_status_ = now;
    }
}

void Node::send_text(Severity severity, std::string_view text) noexcept
{
    LogMessage message;
    message.level = level_of(severity);
    assign(message.source, "jink");
    assign(message.text, text);
    diagnostics_.texts_cut += text.size() > message.text.size() ? 1U : 0U;
    static_cast<void>(send(message, Priority::lowest));
}

void Node::on_get_node_info(const Transfer& request) noexcept
{
    GetNodeInfoRequest asked;
    if (!decode(request, asked)) {
        return;
    }
    GetNodeInfoResponse info;
    info.status = status_;
    info.software = options_.software;
    info.hardware.major = options_.hardware_major;
    info.hardware.minor = options_.hardware_minor;
    info.hardware.unique_id = options_.unique_id;
    assign(info.name, options_.name);
    answer(info, request);
}

void Node::on_get_set(const Transfer& request) noexcept
{
    GetSetRequest asked;
    if (!decode(request, asked)) {
        return;
    }
    GetSetResponse reply;
    std::uint16_t index = asked.index;
    ParamName name{};
    ParamEntry entry;
    const bool named =
        asked.name.empty() || (params_ != nullptr && name_of(asked.name, name) && params_->find(name, index));
    const bool known = params_ != nullptr && named && params_->read(index, entry);
    if (!known) {
        ++diagnostics_.params_unknown;
        answer(reply, request);
        return;
    }
    if (asked.value.tag != ParamValue::Tag::empty) {
        float number = 0.0F;
        if (number_of(asked.value, number)) {
            params_->write(index, number);
        } else {
            ++diagnostics_.values_refused;
        }
        static_cast<void>(params_->read(index, entry));
    }
    reply.value = value_of<ParamValue>(entry.value, entry.integer);
    reply.initial = value_of<ParamValue>(entry.initial, entry.integer);
    reply.high = value_of<NumericValue>(entry.high, entry.integer);
    reply.low = value_of<NumericValue>(entry.low, entry.integer);
    const auto* const end = std::find(entry.name.begin(), entry.name.end(), '\0');
    assign(reply.name, {entry.name.data(), static_cast<std::size_t>(end - entry.name.begin())});
    answer(reply, request);
}

void Node::on_execute_opcode(const Transfer& request) noexcept
{
    ExecuteOpcodeRequest asked;
    if (!decode(request, asked)) {
        return;
    }
    ExecuteOpcodeResponse reply;
    if (params_ != nullptr && asked.opcode == ExecuteOpcodeRequest::kSave) {
        reply.ok = params_->save();
    } else if (params_ != nullptr && asked.opcode == ExecuteOpcodeRequest::kErase) {
        reply.ok = params_->erase();
    }
    answer(reply, request);
}

void Node::on_time_sync(const Transfer& transfer) noexcept
{
    GlobalTimeSync message;
    if (transfer.source != kAnonymous && decode(transfer, message)) {
        time_.receive(transfer.source, transfer.transfer, message.previous_transmission, transfer.stamp);
    }
}

void Node::on_allocation(const Transfer& transfer, TimePoint now) noexcept
{
    Allocation message;
    if (node_ != kAnonymous || !decode(transfer, message)) {
        return;
    }
    allocation_.receive(message, transfer.source, now);
    if (allocation_.node() != kAnonymous) {
        set_node(allocation_.node());
    }
}

}  // namespace jink::link::dronecan
