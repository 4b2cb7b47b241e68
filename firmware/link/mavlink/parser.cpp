// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/link/mavlink/parser.hpp"

#include <algorithm>
#include <cstring>

#include "firmware/link/mavlink/catalogue.hpp"
#include "firmware/link/mavlink/checksum.hpp"

namespace jink::link::mavlink {

std::optional<Frame> Parser::next(std::span<const std::byte>& input) noexcept
{
    for (;;) {  // `take` removes at least one byte of the input per turn
        if (const std::optional<Frame> frame = scan()) {
            return frame;
        }
        if (input.empty()) {
            return std::nullopt;
        }
        take(input);
    }
}

std::optional<Frame> Parser::flush() noexcept
{
    while (pending() > 0) {  // at least one byte is removed per turn
        if (const std::optional<Frame> frame = scan()) {
            return frame;
        }
        if (pending() > 0) {
            ++diagnostics_.cut;
            ++diagnostics_.noise_bytes;
            ++begin_;
        }
    }
    return std::nullopt;
}

void Parser::take(std::span<const std::byte>& input) noexcept
{
    if (end_ == buffer_.size()) {
        // Less than half of the buffer is pending, so more than half was removed since the last move: at most one byte
        // moves per byte received.
        std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_), buffer_.end(), buffer_.begin());
        end_ -= begin_;
        begin_ = 0;
    }
    const std::size_t n = std::min(input.size(), buffer_.size() - end_);
    if (n > 0) {  // an empty span may have no place
        // Without overlap: copy_n moves single bytes where they are not aligned alike.
        std::memcpy(buffer_.data() + end_, input.data(), n);
    }
    end_ += n;
    input = input.subspan(n);
}

/// Drops definite noise and rejected candidates, up to a whole frame or an incomplete candidate.
std::optional<Frame> Parser::scan() noexcept
{
    for (;;) {
        skip_noise();
        Candidate candidate{};
        switch (examine(candidate)) {
        case Verdict::incomplete: return std::nullopt;
        case Verdict::rejected:
            ++diagnostics_.noise_bytes;
            ++begin_;
            break;
        case Verdict::refused: begin_ += candidate.size; break;
        case Verdict::accepted: {
            const Frame frame = deliver(candidate);
            begin_ += candidate.size;
            return frame;
        }
        }
    }
}

void Parser::skip_noise() noexcept
{
    const std::size_t first = begin_;
    while (begin_ < end_ && buffer_[begin_] != kStartV1 && buffer_[begin_] != kStartV2) {
        ++begin_;
    }
    diagnostics_.noise_bytes += static_cast<std::uint32_t>(begin_ - first);
}

/// Checks the candidate at the front as early as its bytes allow.
Parser::Verdict Parser::examine(Candidate& candidate) noexcept
{
    if (const Verdict header = read_header(candidate); header != Verdict::accepted) {
        return header;
    }
    const MessageInfo* const info = find_message(candidate.message_id);
    if (info == nullptr) {
        return reject(diagnostics_.unknown_message);
    }
    if (const Verdict length = check_length(candidate, *info); length != Verdict::accepted) {
        return length;
    }
    if (pending() < candidate.size) {
        return Verdict::incomplete;
    }
    if (!checksum_matches(candidate, *info)) {
        return reject(diagnostics_.bad_checksum);
    }
    return check_signature(candidate);
}

Parser::Verdict Parser::read_header(Candidate& candidate) noexcept
{
    if (pending() < 3) {
        return Verdict::incomplete;
    }
    candidate.length = byte_at(1);
    if (buffer_[begin_] == kStartV1) {
        candidate.version = 1;
        candidate.header_size = kHeaderV1;
    } else {
        const std::byte flags = buffer_[begin_ + 2];
        if ((flags & ~kFlagSigned) != std::byte{0}) {
            return reject(diagnostics_.incompatible_flags);
        }
        candidate.version = 2;
        candidate.header_size = kHeaderV2;
        candidate.is_signed = flags == kFlagSigned;
    }
    if (pending() < candidate.header_size) {
        return Verdict::incomplete;
    }
    if (candidate.version == 1) {
        candidate.header = {byte_at(3), byte_at(4), byte_at(2)};
        candidate.message_id = byte_at(5);
    } else {
        candidate.header = {byte_at(5), byte_at(6), byte_at(4)};
        candidate.message_id = byte_at(7) | (std::uint32_t{byte_at(8)} << 8U) | (std::uint32_t{byte_at(9)} << 16U);
    }
    candidate.size =
        candidate.header_size + candidate.length + kChecksumSize + (candidate.is_signed ? kSignatureSize : 0);
    return Verdict::accepted;
}

Parser::Verdict Parser::check_length(const Candidate& candidate, const MessageInfo& info) noexcept
{
    if (candidate.version == 1) {
        if (candidate.length < info.min_length) {
            return reject(diagnostics_.too_short);
        }
        return candidate.length > info.min_length ? reject(diagnostics_.too_long) : Verdict::accepted;
    }
    const bool longer = candidate.length > info.max_length && longer_ == LongerPayload::reject;
    return longer ? reject(diagnostics_.too_long) : Verdict::accepted;
}

bool Parser::checksum_matches(const Candidate& candidate, const MessageInfo& info) noexcept
{
    const std::size_t covered = candidate.header_size + candidate.length;
    Checksum checksum;
    checksum.add(std::span(buffer_).subspan(begin_ + 1, covered - 1));
    checksum.add(std::byte{info.crc_extra});
    diagnostics_.checksum_bytes += static_cast<std::uint32_t>(covered);
    return byte_at(covered) == (checksum.value() & 0xFFU) && byte_at(covered + 1) == (checksum.value() >> 8U);
}

Parser::Verdict Parser::check_signature(const Candidate& candidate) noexcept
{
    std::uint32_t* cause = nullptr;
    if (signing_ == nullptr || !signing_->has_key()) {
        diagnostics_.signed_unchecked += candidate.is_signed ? 1U : 0U;
    } else if (!candidate.is_signed && signing_->takes_unsigned(candidate.message_id)) {
        ++diagnostics_.unsigned_taken;
    } else if (!candidate.is_signed) {
        cause = &diagnostics_.unsigned_refused;
    } else {
        switch (signing_->check(std::span(buffer_).subspan(begin_, candidate.size))) {
        case SignatureStatus::valid: break;
        case SignatureStatus::wrong: cause = &diagnostics_.wrong_signature; break;
        case SignatureStatus::stale: cause = &diagnostics_.stale_signature; break;
        case SignatureStatus::streams_full: cause = &diagnostics_.signature_streams; break;
        }
    }
    if (cause == nullptr) {
        return Verdict::accepted;
    }
    ++*cause;
    return Verdict::refused;
}

void Parser::follow_sequence(const Header& header) noexcept
{
    auto* const sender = std::find_if(senders_.begin(), senders_.end(), [&header](const Sender& s) {
        return s.system_id == header.system_id && s.component_id == header.component_id;
    });
    if (sender == senders_.end()) {
        if (!senders_.try_push_back({header.system_id, header.component_id, header.sequence})) {
            ++diagnostics_.untracked_senders;
        }
        return;
    }
    const auto step = static_cast<std::uint8_t>(header.sequence - sender->sequence);
    if (step == 0) {
        ++diagnostics_.repeated;
    } else {
        diagnostics_.lost += step - 1U;
    }
    sender->sequence = header.sequence;
}

Frame Parser::deliver(const Candidate& candidate) noexcept
{
    std::memcpy(payload_.data(), buffer_.data() + begin_ + candidate.header_size, candidate.length);
    if (candidate.length < payload_length_) {
        std::memset(payload_.data() + candidate.length, 0, payload_length_ - candidate.length);
    }
    payload_length_ = candidate.length;
    follow_sequence(candidate.header);
    ++diagnostics_.accepted;
    return {candidate.message_id,
            candidate.version,
            candidate.header,
            candidate.is_signed,
            static_cast<std::uint8_t>(candidate.length),
            payload_};
}

}  // namespace jink::link::mavlink
