// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/link/mavlink/signing.hpp"

#include <algorithm>

#include "firmware/link/mavlink/sha256.hpp"

namespace jink::link::mavlink {
namespace {

constexpr std::size_t kTimeSize = 6;
constexpr std::size_t kHashSize = 6;
constexpr std::uint64_t kOneMinute = 6'000'000;

[[nodiscard]] std::uint64_t read_time(std::span<const std::byte> frame) noexcept
{
    const std::span<const std::byte> bytes = frame.subspan(frame.size() - kHashSize - kTimeSize, kTimeSize);
    std::uint64_t time = 0;
    for (std::size_t i = 0; i < kTimeSize; ++i) {
        time |= std::to_integer<std::uint64_t>(bytes[i]) << (8U * i);
    }
    return time;
}

}  // namespace

Signing::Hash Signing::hash(std::span<const std::byte> frame) const noexcept
{
    Sha256 sha;
    sha.add(key_);
    sha.add(frame.first(frame.size() - kHashSize));
    const Sha256::Digest digest = sha.finish();
    Hash first;
    std::copy_n(digest.begin(), kHashSize, first.begin());
    return first;
}

void Signing::set_key(const Key& key, std::uint64_t time) noexcept
{
    key_ = key;
    has_key_ = true;
    ++generation_;
    advance_to(time);
}

void Signing::remove_key() noexcept
{
    key_ = {};
    has_key_ = false;
    ++generation_;
}

bool Signing::takes_unsigned(std::uint32_t message_id) const noexcept
{
    return unsigned_.all ||
           std::find(unsigned_.messages.begin(), unsigned_.messages.end(), message_id) != unsigned_.messages.end();
}

void Signing::follow_clock(std::int64_t now_us) noexcept
{
    constexpr std::int64_t kUnit = 10;  // [us]
    if (!has_clock_) {
        has_clock_ = true;
        clock_us_ = now_us;
        clock_time_ = time_;
    }
    if (now_us > clock_us_) {
        advance_to(clock_time_ + static_cast<std::uint64_t>((now_us - clock_us_) / kUnit));
    }
}

/// Stores a new sender: in a free place, or in place of a sender whose frames are stale at any time.
bool Signing::remember(const Stream& stream) noexcept
{
    if (streams_.try_push_back(stream)) {
        return true;
    }
    auto* const old =
        std::find_if(streams_.begin(), streams_.end(), [this](const Stream& s) { return s.time + kOneMinute < time_; });
    if (old == streams_.end()) {
        return false;
    }
    *old = stream;
    return true;
}

SignatureStatus Signing::check(std::span<const std::byte> frame) noexcept
{
    const Hash expected = hash(frame);
    std::byte difference{0};
    for (std::size_t i = 0; i < kHashSize; ++i) {  // no early exit: its duration would show a forger how many bytes
                                                   // match
        difference |= expected[i] ^ frame[frame.size() - kHashSize + i];
    }
    if (difference != std::byte{0}) {
        return SignatureStatus::wrong;
    }
    const std::uint64_t time = read_time(frame);
    if (time + kOneMinute < time_) {
        return SignatureStatus::stale;
    }
    const Stream key{time, std::to_integer<std::uint8_t>(frame[5]), std::to_integer<std::uint8_t>(frame[6]),
                     std::to_integer<std::uint8_t>(frame[frame.size() - kSignatureSize])};
    auto* const stream = std::find_if(streams_.begin(), streams_.end(), [&key](const Stream& s) {
        return s.system_id == key.system_id && s.component_id == key.component_id && s.link_id == key.link_id;
    });
    if (stream == streams_.end()) {
        if (!remember(key)) {
            return SignatureStatus::streams_full;
        }
    } else {
        if (time <= stream->time) {
            return SignatureStatus::stale;
        }
        stream->time = time;
    }
    advance_to(time);
    return SignatureStatus::valid;
}

void Signing::sign(std::span<std::byte> frame) noexcept
{
    advance_to(time_ + 1);
    const std::span<std::byte> signature = frame.last(kSignatureSize);
    signature[0] = std::byte{link_id_};
    for (std::size_t i = 0; i < kTimeSize; ++i) {
        signature[1 + i] = static_cast<std::byte>((time_ >> (8U * i)) & 0xFFU);
    }
    const Hash value = hash(frame);
    std::copy(value.begin(), value.end(), signature.last(kHashSize).begin());
}

}  // namespace jink::link::mavlink
