// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/wire_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <iterator>
#include <stdexcept>

#include <lzma.h>

#include "toolchain/sim/input_file.hpp"

namespace jink::sim {
namespace {

constexpr std::array<std::uint8_t, 6> kXzMagic{0xFD, '7', 'z', 'X', 'Z', 0x00};
constexpr std::size_t kRecordHead = 13;
/// Memory that unpacking may take [bytes]; xz -9 needs 65 MiB.
constexpr std::uint64_t kUnpackMemory = std::uint64_t{1} << 28U;

static_assert(std::endian::native == std::endian::little, "records are read as they lie in the file");

template <class T>
T read_as(const std::byte* from)
{
    T value{};
    std::memcpy(&value, from, sizeof value);
    return value;
}

bool is_packed(std::span<const std::byte> bytes)
{
    return bytes.size() >= kXzMagic.size() && std::memcmp(bytes.data(), kXzMagic.data(), kXzMagic.size()) == 0;
}

/// Unpacks all streams of an xz file; keeps the output before any damage.
struct Unpacked {
    std::vector<std::byte> bytes;
    std::string fault;
};

std::string fault_of(lzma_ret result)
{
    switch (result) {
    case LZMA_STREAM_END: return "";
    case LZMA_BUF_ERROR: return "the packed data end too early";
    case LZMA_MEMLIMIT_ERROR: return "unpacking takes too much memory";
    case LZMA_DATA_ERROR:
    case LZMA_FORMAT_ERROR: return "the packed data are damaged";
    default: return "the packed data cannot be read (liblzma " + std::to_string(result) + ")";
    }
}

Unpacked unpack(std::span<const std::byte> packed)
{
    Unpacked out;
    lzma_stream stream = LZMA_STREAM_INIT;
    lzma_ret result = lzma_stream_decoder(&stream, kUnpackMemory, LZMA_CONCATENATED);
    stream.next_in = reinterpret_cast<const std::uint8_t*>(packed.data());
    stream.avail_in = packed.size();
    std::vector<std::uint8_t> piece(std::size_t{1} << 16U);
    while (result == LZMA_OK) {
        stream.next_out = piece.data();
        stream.avail_out = piece.size();
        result = lzma_code(&stream, LZMA_FINISH);
        const std::size_t n = piece.size() - stream.avail_out;
        const auto* const from = reinterpret_cast<const std::byte*>(piece.data());
        out.bytes.insert(out.bytes.end(), from, from + n);
        if (out.bytes.size() > kLargestWireFile) {
            out.fault = "larger than " + std::to_string(kLargestWireFile) + " bytes";
            break;
        }
    }
    lzma_end(&stream);
    if (out.fault.empty()) {
        out.fault = fault_of(result);
    }
    return out;
}

/// The fault in a record's head; empty: none.
std::string fault_of(double time, std::uint8_t direction, std::uint32_t length, double before)
{
    if (!std::isfinite(time) || time < before || time - before > kLongestWirePause) {
        return "the time " + std::to_string(time) + " s does not follow " + std::to_string(before) + " s";
    }
    if (direction > 1) {
        return "direction " + std::to_string(direction) + " is neither 0 nor 1";
    }
    if (length > kLargestWireRecord) {
        return "a record of " + std::to_string(length) + " bytes";
    }
    return "";
}

}  // namespace

WireFile read_wire(std::span<const std::byte> bytes)
{
    if (is_packed(bytes)) {
        const Unpacked unpacked = unpack(bytes);
        WireFile file;
        if (!is_packed(unpacked.bytes)) {
            file = read_wire(unpacked.bytes);
        } else {
            file.fault = "packed twice";
        }
        file.fault = unpacked.fault.empty() ? file.fault : unpacked.fault;
        return file;
    }
    WireFile file;
    double before = 0.0;
    for (std::size_t at = 0; at < bytes.size();) {
        const std::size_t left = bytes.size() - at;
        if (left < kRecordHead) {
            file.fault = "the last record is cut off";
            return file;
        }
        const std::byte* const head = bytes.data() + at;
        const auto time = read_as<double>(head);
        const auto direction = std::to_integer<std::uint8_t>(head[8]);
        const auto length = read_as<std::uint32_t>(head + 9);
        file.fault = fault_of(time, direction, length, before);
        if (!file.fault.empty()) {
            return file;
        }
        if (left - kRecordHead < length) {
            file.fault = "the last record is cut off";
            return file;
        }
        const std::byte* const payload = head + kRecordHead;
        file.records.push_back({time, static_cast<WireDirection>(direction), {payload, payload + length}});
        before = time;
        at += kRecordHead + length;
    }
    if (file.records.empty()) {
        file.fault = "no record";
    }
    return file;
}

WireFile read_wire_file(const std::filesystem::path& path)
{
    std::ifstream in = open_input(path);
    const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    if (in.bad()) {
        throw std::runtime_error(path.string() + " cannot be read");
    }
    return read_wire({reinterpret_cast<const std::byte*>(text.data()), text.size()});
}

}  // namespace jink::sim
