// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/link/dronecan/receiver.hpp"

#include <algorithm>

namespace jink::link::dronecan {
namespace {

constexpr std::uint32_t kHighestId = 0x1FFFFFFF;

[[nodiscard]] constexpr std::uint32_t key_of(const FrameId& id) noexcept
{
    return static_cast<std::uint32_t>(id.kind) << 24U | static_cast<std::uint32_t>(id.type) << 8U | id.source;
}

/// Whether `bytes` end with `payload`.
[[nodiscard]] bool ends_with(std::span<const std::byte> bytes, std::span<const std::byte> payload) noexcept
{
    return bytes.size() >= payload.size() &&
           std::equal(payload.begin(), payload.end(), bytes.last(payload.size()).begin());
}

}  // namespace

bool Receiver::is_sound(const Frame& frame, const FrameId& id) noexcept
{
    std::uint32_t* cause = nullptr;
    if (!frame.extended) {
        cause = &diagnostics_.standard_id;
    } else if (frame.remote) {
        cause = &diagnostics_.remote;
    } else if (frame.length == 0 || frame.length > Frame::kBytes) {
        cause = &diagnostics_.bad_length;
    } else if (frame.id > kHighestId ||
               (id.kind != TransferKind::message && (id.source == kAnonymous || id.destination == kAnonymous))) {
        cause = &diagnostics_.bad_id;
    }
    if (cause != nullptr) {
        ++*cause;
    }
    return cause == nullptr;
}

const TypeInfo* Receiver::find_type(const FrameId& id) const noexcept
{
    const bool service = id.kind != TransferKind::message;
    if (service && id.destination != node_) {
        return nullptr;
    }
    // An anonymous message carries two bits of its type: only types 0 .. 3 are possible.
    for (const TypeInfo& type : wanted_) {
        if (type.kind == id.kind && type.id == id.type) {
            return &type;
        }
    }
    return nullptr;
}

Receiver::Session* Receiver::find_session(std::uint32_t key) noexcept
{
    for (Session& session : sessions_) {
        if (session.used && session.key == key) {
            return &session;
        }
    }
    return nullptr;
}

Receiver::Session& Receiver::make_session(std::uint32_t key, TimePoint now) noexcept
{
    Session* chosen = &sessions_.front();
    for (Session& session : sessions_) {
        if (!session.used) {
            chosen = &session;
            break;
        }
        if (session.touched < chosen->touched) {
            chosen = &session;
        }
    }
    if (chosen->used) {
        ++diagnostics_.sessions_evicted;
        if (chosen->assembly != kNone) {
            ++diagnostics_.assemblies_evicted;
            drop(*chosen);
        }
    }
    *chosen = Session{};
    chosen->used = true;
    chosen->key = key;
    chosen->touched = now;
    return *chosen;
}

Receiver::Assembly& Receiver::make_assembly(Session& session, TimePoint now) noexcept
{
    Assembly* chosen = &assemblies_.front();
    for (Assembly& assembly : assemblies_) {
        if (!assembly.used) {
            chosen = &assembly;
            break;
        }
        if (assembly.began < chosen->began) {
            chosen = &assembly;
        }
    }
    if (chosen->used) {
        ++diagnostics_.assemblies_evicted;
        drop(sessions_[chosen->session]);
    }
    chosen->used = true;
    chosen->toggle = false;
    chosen->length = 0;
    chosen->began = now;
    chosen->session = static_cast<std::uint8_t>(&session - sessions_.data());
    session.assembly = static_cast<std::uint8_t>(chosen - assemblies_.data());
    return *chosen;
}

void Receiver::drop(Session& session) noexcept
{
    if (session.assembly != kNone) {
        assemblies_[session.assembly].used = false;
        session.assembly = kNone;
    }
}

bool Receiver::is_repetition(const Session& session, const Piece& piece) noexcept
{
    return session.heard && session.transfer == piece.tail.transfer && piece.now - session.began <= kTransferTimeout;
}

const Transfer* Receiver::accept(const Frame& frame, TimePoint now) noexcept
{
    ++diagnostics_.frames;
    const FrameId id = unpack(frame.id);
    if (!is_sound(frame, id)) {
        return nullptr;
    }
    const TypeInfo* const type = find_type(id);
    if (type == nullptr) {
        ++diagnostics_.ignored;
        return nullptr;
    }
    const Piece piece{frame, *type, id, unpack(frame.data[frame.length - 1U]), now};
    if (piece.tail.start && piece.tail.toggle) {  // Cyphal's: DroneCAN's toggle starts at 0
        ++diagnostics_.wrong_toggle;
        return nullptr;
    }
    if (id.source == kAnonymous) {
        return accept_anonymous(piece);
    }
    return piece.tail.start ? begin(piece) : go_on(piece);
}

const Transfer* Receiver::accept_anonymous(const Piece& piece) noexcept
{
    if (!piece.tail.start || !piece.tail.end) {
        ++diagnostics_.anonymous_refused;
        return nullptr;
    }
    std::copy(piece.frame.data.begin(), piece.frame.data.end(), single_.begin());
    return deliver(piece, piece.now, std::span(single_).first(piece.frame.length - 1U));
}

bool Receiver::make_way(Session& session, const Piece& piece) noexcept
{
    if (session.assembly != kNone) {
        const Assembly& assembly = assemblies_[session.assembly];
        const bool expired = piece.now - assembly.began > kTransferTimeout;
        const bool same = !expired && assembly.transfer == piece.tail.transfer;
        const std::span<const std::byte> so_far = std::span(assembly.bytes).first(assembly.length);
        if (same && !piece.tail.end && so_far.size() == piece.payload().size() && ends_with(so_far, piece.payload())) {
            ++diagnostics_.duplicates;
            return false;
        }
        ++(expired ? diagnostics_.timed_out : diagnostics_.interrupted);
        drop(session);
        if (same) {  // frames of two transfers with the same id would be mixed up
            return false;
        }
    }
    if (is_repetition(session, piece)) {
        ++diagnostics_.duplicates;
        return false;
    }
    return true;
}

const Transfer* Receiver::begin(const Piece& piece) noexcept
{
    const std::uint32_t key = key_of(piece.id);
    Session* session = find_session(key);
    if (session != nullptr) {
        session->touched = piece.now;
        if (!make_way(*session, piece)) {
            return nullptr;
        }
    }
    if (!piece.tail.end && piece.frame.length != Frame::kBytes) {
        ++diagnostics_.short_frame;
        return nullptr;
    }
    if (piece.tail.end && piece.payload().size() > piece.type.max_length) {
        ++diagnostics_.too_long;
        return nullptr;
    }
    if (session == nullptr) {
        session = &make_session(key, piece.now);
    }
    if (piece.tail.end) {
        session->heard = true;
        session->transfer = piece.tail.transfer;
        session->began = piece.now;
        std::copy(piece.frame.data.begin(), piece.frame.data.end(), single_.begin());
        return deliver(piece, piece.now, std::span(single_).first(piece.frame.length - 1U));
    }
    Assembly& assembly = make_assembly(*session, piece.now);
    assembly.transfer = piece.tail.transfer;
    return add(*session, assembly, piece);
}

const Transfer* Receiver::go_on(const Piece& piece) noexcept
{
    Session* const session = find_session(key_of(piece.id));
    if (session == nullptr || session->assembly == kNone) {
        const bool repeated = session != nullptr && is_repetition(*session, piece);
        ++(repeated ? diagnostics_.duplicates : diagnostics_.missed_start);
        return nullptr;
    }
    session->touched = piece.now;
    Assembly& assembly = assemblies_[session->assembly];
    const std::span<const std::byte> so_far = std::span(assembly.bytes).first(assembly.length);
    std::uint32_t* cause = nullptr;
    if (piece.now - assembly.began > kTransferTimeout) {
        cause = &diagnostics_.timed_out;
    } else if (piece.tail.transfer != assembly.transfer) {
        cause = &diagnostics_.wrong_transfer;
    } else if (piece.tail.toggle != assembly.toggle) {
        // The controller may deliver a frame twice if its acknowledgement was disturbed; the first has a start bit.
        constexpr std::size_t kFirst = Frame::kBytes - 1;
        if (!piece.tail.end && piece.frame.length == Frame::kBytes && so_far.size() > kFirst &&
            ends_with(so_far, piece.payload())) {
            ++diagnostics_.duplicates;
            return nullptr;
        }
        cause = &diagnostics_.wrong_toggle;
    } else if (piece.frame.length == 1 || (!piece.tail.end && piece.frame.length != Frame::kBytes)) {
        cause = &diagnostics_.short_frame;
    } else if (so_far.size() + piece.payload().size() > piece.type.max_length + kCrcBytes) {
        cause = &diagnostics_.too_long;
    }
    if (cause != nullptr) {
        ++*cause;
        drop(*session);
        return nullptr;
    }
    return add(*session, assembly, piece);
}

const Transfer* Receiver::add(Session& session, Assembly& assembly, const Piece& piece) noexcept
{
    const std::span<const std::byte> payload = piece.payload();
    std::copy(payload.begin(), payload.end(), assembly.bytes.begin() + assembly.length);
    assembly.length = static_cast<std::uint16_t>(assembly.length + payload.size());
    assembly.toggle = !assembly.toggle;
    if (!piece.tail.end) {
        return nullptr;
    }
    drop(session);  // the bytes stay until the next frame
    const std::span<const std::byte> all = std::span(assembly.bytes).first(assembly.length);
    Checksum checksum(piece.type.crc_seed);
    checksum.add(all.subspan(kCrcBytes));
    if (std::to_integer<unsigned>(all[0]) + 256U * std::to_integer<unsigned>(all[1]) != checksum.value()) {
        ++diagnostics_.bad_crc;
        return nullptr;
    }
    session.heard = true;
    session.transfer = assembly.transfer;
    session.began = assembly.began;
    return deliver(piece, assembly.began, all.subspan(kCrcBytes));
}

const Transfer* Receiver::deliver(const Piece& piece, TimePoint began, std::span<const std::byte> payload) noexcept
{
    ++diagnostics_.transfers;
    transfer_ = {piece.type, piece.id.source, piece.tail.transfer, piece.id.priority, began, payload};
    return &transfer_;
}

}  // namespace jink::link::dronecan
