// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "core/base/static_vector.hpp"
#include "firmware/link/dronecan/bits.hpp"
#include "firmware/link/dronecan/float16.hpp"
#include "firmware/link/dronecan/frame.hpp"

// Each data type describes its wire form once, as a list of `io(how, member)`:
//
//     template <class Io, class Self>
//     static constexpr void describe(Io& io, Self& m) { io(u<32>, m.uptime); io(u<2>, m.health); ... }
//
// Each class that walks over the fields is an Io: Encoder, Decoder, and the printer of a test. Nested types are
// described in place of their fields (`nested`), so nothing recurses at run time.

namespace jink::link::dronecan {

template <unsigned Bits>
struct Unsigned {
};
template <unsigned Bits>
struct Signed {
};
struct Float16 {};
struct Float32 {};
struct Nested {};
template <unsigned Bits>
struct Void {
};
/// Every element of a fixed array.
template <class How>
struct Each {
};
/// A dynamic array: number of elements in as many bits as its capacity needs, then the elements.
template <class How>
struct List {
};
/// A dynamic array of elements of a byte or more as the last field of a transfer. The number of elements is omitted;
/// the end of the transfer gives it (tail array optimisation).
template <class How>
struct Tailing {
};
/// Further fields that are not of interest: skipped when reading, omitted when writing.
struct Rest {};

template <unsigned Bits>
inline constexpr Unsigned<Bits> u{};
template <unsigned Bits>
inline constexpr Signed<Bits> s{};
inline constexpr Float16 f16{};
inline constexpr Float32 f32{};
inline constexpr Nested nested{};
template <unsigned Bits>
inline constexpr Void<Bits> filler{};
template <class How>
[[nodiscard]] constexpr Each<How> each(How) noexcept
{
    return {};
}
template <class How>
[[nodiscard]] constexpr List<How> list(How) noexcept
{
    return {};
}
template <class How>
[[nodiscard]] constexpr Tailing<How> tail(How) noexcept
{
    return {};
}
inline constexpr Rest rest{};

/// Bits needed for 0 .. capacity.
[[nodiscard]] constexpr unsigned length_bits(std::size_t capacity) noexcept
{
    return static_cast<unsigned>(std::bit_width(capacity));
}

enum class CodecStatus : std::uint8_t {
    ok,
    no_room,       ///< writing: the buffer is too small
    out_of_range,  ///< writing: a number does not fit its field
    too_short,     ///< reading: the transfer ends within a field
    too_long,      ///< reading: whole bytes are left over
    bad_length,    ///< reading: a dynamic array claims more elements than its capacity
    bad_tag,       ///< reading: a union names an alternative that does not exist
};

/// Writes fields. The first failure is kept, and nothing is written from there on.
class Encoder {
public:
    explicit constexpr Encoder(std::span<std::byte> out) noexcept : writer_(out) {}

    template <unsigned Bits, class T>
    constexpr void operator()(Unsigned<Bits>, const T& value) noexcept
    {
        put(static_cast<std::uint64_t>(value), Bits,
            Bits == 64 || static_cast<std::uint64_t>(value) >> (Bits % 64) == 0);
    }
    template <unsigned Bits, std::signed_integral T>
    constexpr void operator()(Signed<Bits>, const T& value) noexcept
    {
        const std::int64_t above = static_cast<std::int64_t>(value) >> (Bits - 1U);  // only copies of the sign
        put(static_cast<std::uint64_t>(static_cast<std::int64_t>(value)), Bits, above == 0 || above == -1);
    }
    /// A finite number that would become infinite is out of range; infinity and NaN are written unchanged.
    void operator()(Float16, const float& value) noexcept
    {
        const std::uint16_t half = to_float16(value);
        put(half, 16, !std::isfinite(value) || (half & 0x7C00U) != 0x7C00U);
    }
    constexpr void operator()(Float32, const float& value) noexcept
    {
        put(std::bit_cast<std::uint32_t>(value), 32, true);
    }
    template <class M>
    constexpr void operator()(Nested, const M& m) noexcept
    {
        M::describe(*this, m);
    }
    template <unsigned Bits>
    constexpr void operator()(Void<Bits>) noexcept
    {
        put(0, Bits, true);
    }
    template <class How, class T, std::size_t N>
    constexpr void operator()(Each<How>, const std::array<T, N>& values) noexcept
    {
        for (const T& value : values) {
            (*this)(How{}, value);
        }
    }
    template <class How, class T, std::size_t N>
    constexpr void operator()(List<How>, const StaticVector<T, N>& values) noexcept
    {
        put(values.size(), length_bits(N), true);
        (*this)(Tailing<How>{}, values);
    }
    template <class How, class T, std::size_t N>
    constexpr void operator()(Tailing<How>, const StaticVector<T, N>& values) noexcept
    {
        for (const T& value : values) {
            (*this)(How{}, value);
        }
    }
    constexpr void operator()(Rest) noexcept {}
    /// Writes the number of a union's alternative; true if the alternative is to be described.
    template <unsigned Bits, class Tag>
    constexpr bool tag(const Tag& value, Tag last) noexcept
    {
        put(static_cast<std::uint64_t>(value), Bits, value <= last);
        return status_ == CodecStatus::ok;
    }

    [[nodiscard]] constexpr CodecStatus status() const noexcept { return status_; }
    [[nodiscard]] constexpr std::size_t bytes() const noexcept { return writer_.bytes(); }

private:
    constexpr void put(std::uint64_t value, unsigned bits, bool fits) noexcept
    {
        if (status_ != CodecStatus::ok) {
            return;
        }
        if (!fits) {
            status_ = CodecStatus::out_of_range;
        } else if (!writer_.put(value, bits)) {
            status_ = CodecStatus::no_room;
        }
    }

    BitWriter writer_;
    CodecStatus status_ = CodecStatus::ok;
};

/// Reads fields. The first failure is kept; fields after it keep their values.
class Decoder {
public:
    explicit constexpr Decoder(std::span<const std::byte> in) noexcept : reader_(in) {}

    template <unsigned Bits, class T>
    constexpr void operator()(Unsigned<Bits>, T& value) noexcept
    {
        if (const std::uint64_t bits = get(Bits); status_ == CodecStatus::ok) {
            value = static_cast<T>(bits);
        }
    }
    template <unsigned Bits, std::signed_integral T>
    constexpr void operator()(Signed<Bits>, T& value) noexcept
    {
        if (const std::uint64_t bits = get(Bits); status_ == CodecStatus::ok) {
            constexpr unsigned kAbove = 64 - Bits;
            value = static_cast<T>(static_cast<std::int64_t>(bits << kAbove) >> kAbove);
        }
    }
    constexpr void operator()(Float16, float& value) noexcept
    {
        if (const std::uint64_t bits = get(16); status_ == CodecStatus::ok) {
            value = from_float16(static_cast<std::uint16_t>(bits));
        }
    }
    constexpr void operator()(Float32, float& value) noexcept
    {
        if (const std::uint64_t bits = get(32); status_ == CodecStatus::ok) {
            value = std::bit_cast<float>(static_cast<std::uint32_t>(bits));
        }
    }
    template <class M>
    constexpr void operator()(Nested, M& m) noexcept
    {
        M::describe(*this, m);
    }
    template <unsigned Bits>
    constexpr void operator()(Void<Bits>) noexcept
    {
        static_cast<void>(get(Bits));
    }
    template <class How, class T, std::size_t N>
    constexpr void operator()(Each<How>, std::array<T, N>& values) noexcept
    {
        for (T& value : values) {
            (*this)(How{}, value);
        }
    }
    template <class How, class T, std::size_t N>
    constexpr void operator()(List<How>, StaticVector<T, N>& values) noexcept
    {
        const std::uint64_t length = get(length_bits(N));
        values.clear();
        if (status_ == CodecStatus::ok && length > N) {
            status_ = CodecStatus::bad_length;
        }
        for (std::uint64_t i = 0; status_ == CodecStatus::ok && i < length; ++i) {
            append(How{}, values);
        }
    }
    template <class How, class T, std::size_t N>
    constexpr void operator()(Tailing<How>, StaticVector<T, N>& values) noexcept
    {
        // Less than a byte left is padding.
        values.clear();
        while (status_ == CodecStatus::ok && reader_.left() >= 8) {
            if (values.full()) {
                status_ = CodecStatus::bad_length;
                return;
            }
            append(How{}, values);
        }
    }
    constexpr void operator()(Rest) noexcept { has_rest_ = true; }
    template <unsigned Bits, class Tag>
    constexpr bool tag(Tag& value, Tag last) noexcept
    {
        const std::uint64_t bits = get(Bits);
        if (status_ == CodecStatus::ok && bits > static_cast<std::uint64_t>(last)) {
            status_ = CodecStatus::bad_tag;
        }
        if (status_ == CodecStatus::ok) {
            value = static_cast<Tag>(bits);
        }
        return status_ == CodecStatus::ok;
    }

    /// Valid after the last field.
    [[nodiscard]] constexpr CodecStatus status() const noexcept
    {
        return status_ == CodecStatus::ok && !has_rest_ && reader_.left() >= 8 ? CodecStatus::too_long : status_;
    }

private:
    [[nodiscard]] constexpr std::uint64_t get(unsigned bits) noexcept
    {
        std::uint64_t value = 0;
        if (status_ == CodecStatus::ok && !reader_.get(value, bits)) {
            status_ = CodecStatus::too_short;
        }
        return value;
    }
    template <class How, class T, std::size_t N>
    constexpr void append(How how, StaticVector<T, N>& values) noexcept
    {
        T value{};
        (*this)(how, value);
        if (status_ == CodecStatus::ok) {
            values.unchecked_push_back(value);
        }
    }

    BitReader reader_;
    CodecStatus status_ = CodecStatus::ok;
    bool has_rest_ = false;
};

/// Properties of a data type that the transport needs. 8 bytes.
struct TypeInfo {
    TransferKind kind;
    std::uint16_t id;
    std::uint16_t crc_seed;    ///< CRC-16 after the eight bytes of the type's signature
    std::uint16_t max_length;  ///< bytes of the longest payload
};

/// A structure of messages.hpp.
template <class M>
concept Described = std::default_initializable<M> && requires
{
    {
        M::kType
        } -> std::convertible_to<const TypeInfo&>;
};

/// Longest payload of all types (GetNodeInfo's response) [bytes].
inline constexpr std::size_t kMaxPayload = 377;

/// Writes the payload of `message` to the beginning of `out`.
///
/// @param out   M::kType.max_length bytes hold any message
/// @param size  bytes written; 0 on failure
/// @return ok, no_room, out_of_range
template <Described M>
[[nodiscard]] CodecStatus encode(const M& message, std::span<std::byte> out, std::size_t& size) noexcept
{
    for (std::byte& byte : out) {
        byte = std::byte{0};
    }
    Encoder encoder(out);
    M::describe(encoder, message);
    size = encoder.status() == CodecStatus::ok ? encoder.bytes() : 0;
    return encoder.status();
}

/// Reads a payload. Its length must be the type's exactly, except for padding bits.
///
/// @param message  unchanged on failure
/// @return ok, too_short, too_long, bad_length, bad_tag. Floats are passed unchanged, NaN and infinity included.
template <Described M>
[[nodiscard]] CodecStatus decode(std::span<const std::byte> payload, M& message) noexcept
{
    M read{};
    Decoder decoder(payload);
    M::describe(decoder, read);
    if (decoder.status() == CodecStatus::ok) {
        message = read;
    }
    return decoder.status();
}

}  // namespace jink::link::dronecan
