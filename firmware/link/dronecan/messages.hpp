// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "firmware/link/dronecan/codec.hpp"

// Data types of the protocol itself and of the tunnel; sensor types are in sensor_messages.hpp. Fields as the public
// definitions name and order them, each described once (see codec.hpp). The signatures prove names, widths and order:
// tests/unit/link/dronecan_types.py computes them from its own list of fields, and dronecan_check.py compares them with
// this file. Units are those of the wire; floats may be NaN.

namespace jink::link::dronecan {

using Text31 = StaticVector<std::uint8_t, 31>;
using Text80 = StaticVector<std::uint8_t, 80>;
using Text90 = StaticVector<std::uint8_t, 90>;
using Text92 = StaticVector<std::uint8_t, 92>;  ///< name of a parameter

using UniqueId = std::array<std::uint8_t, 16>;

enum class Health : std::uint8_t { ok = 0, warning = 1, error = 2, critical = 3 };
enum class Mode : std::uint8_t {
    operational = 0,
    initialization = 1,
    maintenance = 2,
    software_update = 3,
    offline = 7
};

struct NodeStatus {
    static constexpr TypeInfo kType{TransferKind::message, 341, 0xBE5F, 7};
    std::uint32_t uptime = 0;  ///< [s]
    Health health = Health::ok;
    Mode mode = Mode::operational;
    std::uint8_t sub_mode = 0;
    std::uint16_t vendor_status = 0;

    template <class Io, class Self>
    static constexpr void describe(Io& io, Self& m) noexcept
    {
        io(u<32>, m.uptime);
        io(u<2>, m.health);
        io(u<3>, m.mode);
        io(u<3>, m.sub_mode);
        io(u<16>, m.vendor_status);
    }
};

struct SoftwareVersion {
    static constexpr std::uint8_t kHasCommit = 1;
    static constexpr std::uint8_t kHasCrc = 2;
    std::uint8_t major = 0;
    std::uint8_t minor = 0;
    std::uint8_t optional_fields = 0;  ///< kHasCommit, kHasCrc
    std::uint32_t commit = 0;
    std::uint64_t image_crc = 0;

    template <class Io, class Self>
    static constexpr void describe(Io& io, Self& m) noexcept
    {
        io(u<8>, m.major);
        io(u<8>, m.minor);
        io(u<8>, m.optional_fields);
        io(u<32>, m.commit);
        io(u<64>, m.image_crc);
    }
};

struct HardwareVersion {
    std::uint8_t major = 0;
    std::uint8_t minor = 0;
    UniqueId unique_id{};
    StaticVector<std::uint8_t, 255> certificate;

    template <class Io, class Self>
    static constexpr void describe(Io& io, Self& m) noexcept
    {
        io(u<8>, m.major);
        io(u<8>, m.minor);
        io(each(u<8>), m.unique_id);
        io(list(u<8>), m.certificate);
    }
};

struct GetNodeInfoRequest {
    static constexpr TypeInfo kType{TransferKind::request, 1, 0xD9A7, 0};

    template <class Io, class Self>
    static constexpr void describe(Io&, Self&) noexcept
    {
    }
};

struct GetNodeInfoResponse {
    static constexpr TypeInfo kType{TransferKind::response, 1, 0xD9A7, 377};
    NodeStatus status;
    SoftwareVersion software;
    HardwareVersion hardware;
    Text80 name;

    template <class Io, class Self>
    static constexpr void describe(Io& io, Self& m) noexcept
    {
        io(nested, m.status);
        io(nested, m.software);
        io(nested, m.hardware);
        io(tail(u<8>), m.name);
    }
};

/// Value of a parameter: exactly the alternative that `tag` names.
struct ParamValue {
    enum class Tag : std::uint8_t { empty, integer, real, boolean, text };
    Tag tag = Tag::empty;
    std::int64_t integer = 0;
    float real = 0.0F;
    std::uint8_t boolean = 0;
    StaticVector<std::uint8_t, 128> text;

    template <class Io, class Self>
    static constexpr void describe(Io& io, Self& m) noexcept
    {
        if (!io.template tag<3>(m.tag, Tag::text)) {
            return;
        }
        switch (m.tag) {
        case Tag::empty: break;
        case Tag::integer: io(s<64>, m.integer); break;
        case Tag::real: io(f32, m.real); break;
        case Tag::boolean: io(u<8>, m.boolean); break;
        case Tag::text: io(list(u<8>), m.text); break;
        }
    }
};

struct NumericValue {
    enum class Tag : std::uint8_t { empty, integer, real };
    Tag tag = Tag::empty;
    std::int64_t integer = 0;
    float real = 0.0F;

    template <class Io, class Self>
    static constexpr void describe(Io& io, Self& m) noexcept
    {
        if (!io.template tag<2>(m.tag, Tag::real)) {
            return;
        }
        switch (m.tag) {
        case Tag::empty: break;
        case Tag::integer: io(s<64>, m.integer); break;
        case Tag::real: io(f32, m.real); break;
        }
    }
};

/// By name; by index if the name is empty. Sets the value if `value` is not empty.
struct GetSetRequest {
    static constexpr TypeInfo kType{TransferKind::request, 11, 0xFB10, 224};
    std::uint16_t index = 0;  ///< 13 bits
    ParamValue value;
    Text92 name;

    template <class Io, class Self>
    static constexpr void describe(Io& io, Self& m) noexcept
    {
        io(u<13>, m.index);
        io(nested, m.value);
        io(tail(u<8>), m.name);
    }
};

/// The name is empty if there is no such parameter.
struct GetSetResponse {
    static constexpr TypeInfo kType{TransferKind::response, 11, 0xFB10, 371};
    ParamValue value;
    ParamValue initial;
    NumericValue high;
    NumericValue low;
    Text92 name;

    template <class Io, class Self>
    static constexpr void describe(Io& io, Self& m) noexcept
    {
        io(filler<5>);
        io(nested, m.value);
        io(filler<5>);
        io(nested, m.initial);
        io(filler<6>);
        io(nested, m.high);
        io(filler<6>);
        io(nested, m.low);
        io(tail(u<8>), m.name);
    }
};

struct ExecuteOpcodeRequest {
    static constexpr TypeInfo kType{TransferKind::request, 10, 0xD7D4, 7};
    static constexpr std::uint8_t kSave = 0;
    static constexpr std::uint8_t kErase = 1;
    std::uint8_t opcode = 0;
    std::int64_t argument = 0;  ///< 48 bits

    template <class Io, class Self>
    static constexpr void describe(Io& io, Self& m) noexcept
    {
        io(u<8>, m.opcode);
        io(s<48>, m.argument);
    }
};

struct ExecuteOpcodeResponse {
    static constexpr TypeInfo kType{TransferKind::response, 10, 0xD7D4, 7};
    std::int64_t argument = 0;  ///< 48 bits
    bool ok = false;

    template <class Io, class Self>
    static constexpr void describe(Io& io, Self& m) noexcept
    {
        io(s<48>, m.argument);
        io(u<1>, m.ok);
    }
};

/// Time at which this master's previous message began on the bus; 0: there was none.
struct GlobalTimeSync {
    static constexpr TypeInfo kType{TransferKind::message, 4, 0x7908, 7};
    std::uint64_t previous_transmission = 0;  ///< [us], 56 bits

    template <class Io, class Self>
    static constexpr void describe(Io& io, Self& m) noexcept
    {
        io(u<56>, m.previous_transmission);
    }
};

struct Allocation {
    static constexpr TypeInfo kType{TransferKind::message, 1, 0xF258, 18};
    std::uint8_t node = 0;  ///< 7 bits; 0: any
    bool first_part = false;
    StaticVector<std::uint8_t, 16> unique_id;  ///< the part that is known

    template <class Io, class Self>
    static constexpr void describe(Io& io, Self& m) noexcept
    {
        io(u<7>, m.node);
        io(u<1>, m.first_part);
        io(tail(u<8>), m.unique_id);
    }
};

enum class LogLevel : std::uint8_t { debug = 0, info = 1, warning = 2, error = 3 };

struct LogMessage {
    static constexpr TypeInfo kType{TransferKind::message, 16383, 0x4570, 123};
    LogLevel level = LogLevel::info;
    Text31 source;
    Text90 text;

    template <class Io, class Self>
    static constexpr void describe(Io& io, Self& m) noexcept
    {
        io(u<3>, m.level);
        io(list(u<8>), m.source);
        io(tail(u<8>), m.text);
    }
};

/// Protocol carried by a tunnel.
enum class TunnelProtocol : std::uint8_t { mavlink = 0, mavlink2 = 1 };

/// Bytes of one node's serial port for another node.
struct TunnelTargetted {
    static constexpr TypeInfo kType{TransferKind::message, 3001, 0x7CA9, 127};
    static constexpr std::size_t kBytes = 120;
    std::uint8_t protocol = 0;
    std::uint8_t target = 0;   ///< 7 bits
    std::int8_t serial = 0;    ///< 5 bits
    std::uint8_t options = 0;  ///< 1: the port is kept for the tunnel
    std::uint32_t baud_rate = 0;
    StaticVector<std::uint8_t, kBytes> bytes;

    template <class Io, class Self>
    static constexpr void describe(Io& io, Self& m) noexcept
    {
        io(u<8>, m.protocol);
        io(u<7>, m.target);
        io(s<5>, m.serial);
        io(u<4>, m.options);
        io(u<24>, m.baud_rate);
        io(tail(u<8>), m.bytes);
    }
};

/// Bytes for all nodes that listen to a channel.
struct TunnelBroadcast {
    static constexpr TypeInfo kType{TransferKind::message, 2010, 0x1C82, 63};
    std::uint8_t protocol = 0;
    std::uint8_t channel = 0;
    StaticVector<std::uint8_t, 60> bytes;

    template <class Io, class Self>
    static constexpr void describe(Io& io, Self& m) noexcept
    {
        io(u<8>, m.protocol);
        io(u<8>, m.channel);
        io(tail(u<8>), m.bytes);
    }
};

}  // namespace jink::link::dronecan
