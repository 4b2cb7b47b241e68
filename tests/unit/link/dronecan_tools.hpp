// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/random.hpp"
#include "firmware/link/dronecan/endpoint.hpp"
#include "firmware/link/dronecan/tunnel.hpp"

namespace jink::link::dronecan::test {

using Bytes = std::vector<std::byte>;

inline std::uint64_t base_seed()
{
    const char* const given = std::getenv("JINK_SEED");
    return given != nullptr ? std::strtoull(given, nullptr, 0) : 20260101;
}

inline Bytes from_hex(std::string_view hex)
{
    Bytes bytes;
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
        bytes.push_back(static_cast<std::byte>(std::stoul(std::string(hex.substr(i, 2)), nullptr, 16)));
    }
    return bytes;
}

/// A payload that contains its sender and number.
inline Bytes long_payload(std::uint8_t number, std::size_t length = 40)
{
    Bytes payload(length);
    for (std::size_t i = 0; i < length; ++i) {
        payload[i] = static_cast<std::byte>(number + i);
    }
    return payload;
}

inline std::string to_hex(std::span<const std::byte> bytes)
{
    constexpr std::string_view kDigits = "0123456789ABCDEF";
    std::string hex;
    for (const std::byte b : bytes) {
        hex += kDigits[std::to_integer<std::size_t>(b) >> 4U];
        hex += kDigits[std::to_integer<std::size_t>(b) & 15U];
    }
    return hex;
}

/// In the notation of candump and the golden frames: 1001552A#E8030000003412C0
inline Frame frame_of(std::string_view text)
{
    const Bytes data = from_hex(text.substr(9));
    Frame frame;
    frame.id = static_cast<std::uint32_t>(std::stoul(std::string(text.substr(0, 8)), nullptr, 16));
    frame.length = static_cast<std::uint8_t>(data.size());
    std::copy(data.begin(), data.end(), frame.data.begin());
    return frame;
}

inline std::string text_of(const Frame& frame)
{
    std::string id;
    for (int shift = 24; shift >= 0; shift -= 8) {
        const auto byte = static_cast<std::byte>(frame.id >> static_cast<unsigned>(shift) & 255U);
        id += to_hex(std::span(&byte, 1));
    }
    return id + "#" + to_hex(std::span(frame.data).first(frame.length));
}

inline std::vector<Frame> frames_of(const TransferHead& head, std::span<const std::byte> payload)
{
    TransmitQueue queue;
    std::vector<Frame> frames;
    if (queue.push(head, payload)) {
        while (queue.front() != nullptr) {
            frames.push_back(*queue.front());
            queue.pop();
        }
    }
    return frames;
}

template <Described M>
Bytes payload_of(const M& message)
{
    Bytes bytes(kMaxPayload);
    std::size_t size = 0;
    if (encode(message, bytes, size) != CodecStatus::ok) {
        std::abort();
    }
    bytes.resize(size);
    return bytes;
}

template <Described M>
std::vector<Frame> frames_of(const M& message, std::uint8_t source, std::uint8_t transfer = 0,
                             Priority priority = Priority::medium, std::uint8_t destination = 0)
{
    return frames_of(TransferHead{M::kType, priority, source, destination, transfer}, payload_of(message));
}

/// Calls f.template operator()<M>() for each type.
template <class F>
void for_each_type(F&& f)
{
    f.template operator()<NodeStatus>();
    f.template operator()<GetNodeInfoRequest>();
    f.template operator()<GetNodeInfoResponse>();
    f.template operator()<GetSetRequest>();
    f.template operator()<GetSetResponse>();
    f.template operator()<ExecuteOpcodeRequest>();
    f.template operator()<ExecuteOpcodeResponse>();
    f.template operator()<GlobalTimeSync>();
    f.template operator()<Allocation>();
    f.template operator()<LogMessage>();
    f.template operator()<RangeMeasurement>();
    f.template operator()<Proximity>();
    f.template operator()<TrafficReport>();
    f.template operator()<Fix2>();
    f.template operator()<AhrsSolution>();
    f.template operator()<TunnelTargetted>();
    f.template operator()<TunnelBroadcast>();
}

/// Text of all fields in order: integers as such, floats as their bits, arrays with their length in front.
class Printer {
public:
    template <unsigned Bits, class T>
    void operator()(Unsigned<Bits>, const T& value)
    {
        add(std::to_string(static_cast<std::uint64_t>(value)));
    }
    template <unsigned Bits, class T>
    void operator()(Signed<Bits>, const T& value)
    {
        add(std::to_string(static_cast<std::int64_t>(value)));
    }
    void operator()(Float16, const float& value) { (*this)(f32, value); }
    void operator()(Float32, const float& value) { add('f', std::to_string(std::bit_cast<std::uint32_t>(value))); }
    template <class M>
    void operator()(Nested, const M& m)
    {
        M::describe(*this, m);
    }
    template <unsigned Bits>
    void operator()(Void<Bits>)
    {
    }
    template <class How, class T, std::size_t N>
    void operator()(Each<How> how, const std::array<T, N>& values)
    {
        static_cast<void>(how);
        for (const T& value : values) {
            (*this)(How{}, value);
        }
    }
    template <class How, class T, std::size_t N>
    void operator()(List<How>, const StaticVector<T, N>& values)
    {
        add('[', std::to_string(values.size()).append("]"));
        for (const T& value : values) {
            (*this)(How{}, value);
        }
    }
    template <class How, class T, std::size_t N>
    void operator()(Tailing<How>, const StaticVector<T, N>& values)
    {
        (*this)(List<How>{}, values);
    }
    void operator()(Rest) {}
    template <unsigned Bits, class Tag>
    bool tag(const Tag& value, Tag)
    {
        add('t', std::to_string(static_cast<unsigned>(value)));
        return true;
    }

    std::string text;

private:
    /// Not "f" + word: GCC 12 sees an overlap in that which is not there (GCC bug 105329).
    void add(char kind, const std::string& word) { add(std::string(1, kind).append(word)); }
    void add(const std::string& word) { text.append(text.empty() ? "" : " ").append(word); }
};

template <Described M>
std::string print(const M& message)
{
    Printer printer;
    M::describe(printer, message);
    return printer.text;
}

/// Fills a message with random values of every field's whole range; floats: any bits of the wire.
class Filler {
public:
    explicit Filler(Random& random) : random_(random) {}

    template <unsigned Bits, class T>
    void operator()(Unsigned<Bits>, T& value)
    {
        value = static_cast<T>(any() >> (64 - Bits));
    }
    template <unsigned Bits, class T>
    void operator()(Signed<Bits>, T& value)
    {
        value = static_cast<T>(static_cast<std::int64_t>(any()) >> (64 - Bits));
    }
    void operator()(Float16, float& value) { value = from_float16(static_cast<std::uint16_t>(any())); }
    void operator()(Float32, float& value) { value = std::bit_cast<float>(static_cast<std::uint32_t>(any())); }
    template <class M>
    void operator()(Nested, M& m)
    {
        M::describe(*this, m);
    }
    template <unsigned Bits>
    void operator()(Void<Bits>)
    {
    }
    template <class How, class T, std::size_t N>
    void operator()(Each<How>, std::array<T, N>& values)
    {
        for (T& value : values) {
            (*this)(How{}, value);
        }
    }
    template <class How, class T, std::size_t N>
    void operator()(List<How>, StaticVector<T, N>& values)
    {
        const std::uint64_t kind = random_.below(4);  // empty and full ones often
        const std::size_t size = kind == 0 ? 0 : kind == 1 ? N : static_cast<std::size_t>(random_.below(N + 1));
        values.clear();
        for (std::size_t i = 0; i < size; ++i) {
            T value{};
            (*this)(How{}, value);
            values.unchecked_push_back(value);
        }
    }
    template <class How, class T, std::size_t N>
    void operator()(Tailing<How>, StaticVector<T, N>& values)
    {
        (*this)(List<How>{}, values);
    }
    void operator()(Rest) {}
    template <unsigned Bits, class Tag>
    bool tag(Tag& value, Tag last)
    {
        value = static_cast<Tag>(random_.below(static_cast<std::uint64_t>(last) + 1));
        return true;
    }

private:
    std::uint64_t any()
    {
        const std::uint64_t kind = random_.below(8);  // all zeros and all ones now and then
        return kind == 0 ? 0 : kind == 1 ? ~std::uint64_t{0} : random_.next();
    }

    Random& random_;
};

template <Described M>
M random_message(Random& random)
{
    M message{};
    Filler filler(random);
    M::describe(filler, message);
    return message;
}

}  // namespace jink::link::dronecan::test
