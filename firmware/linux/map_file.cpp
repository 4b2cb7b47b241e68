// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/map_file.hpp"

#include <bit>
#include <stdexcept>

namespace jink::files {
namespace {

using geometry::MapStatus;
using geometry::MeshMap;
using geometry::MeshNode;
using geometry::MeshPiece;

constexpr std::string_view kMagic{"JINKMAP\0", 8};
/// Of a stored piece, vertex and node [bytes].
constexpr std::size_t kPieceBytes = 20;
constexpr std::size_t kVertexBytes = 12;
constexpr std::size_t kNodeBytes = 28;

class Writer {
public:
    void u16(std::size_t value)
    {
        out_.push_back(static_cast<char>(value & 0xFFU));
        out_.push_back(static_cast<char>((value >> 8U) & 0xFFU));
    }
    void u32(std::size_t value)
    {
        u16(value & 0xFFFFU);
        u16((value >> 16U) & 0xFFFFU);
    }
    void i32(std::int32_t value) { u32(std::bit_cast<std::uint32_t>(value)); }
    void real(float value) { u32(std::bit_cast<std::uint32_t>(value)); }
    void point(const Point3& v)
    {
        real(v.x);
        real(v.y);
        real(v.z);
    }
    void text(std::string_view text) { out_.append(text); }
    [[nodiscard]] std::string take() { return std::move(out_); }

private:
    std::string out_;
};

/// What is wrong with the text, up to `parse_map`.
struct BadMap : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Reads past the end as an error, once and for all.
class MapReader {
public:
    explicit MapReader(std::string_view text) : text_(text) {}

    std::uint16_t u16()
    {
        const std::string_view two = text(2);
        return static_cast<std::uint16_t>(static_cast<unsigned char>(two[0]) |
                                          (static_cast<unsigned char>(two[1]) << 8U));
    }
    std::uint32_t u32()
    {
        const std::uint32_t low = u16();
        return low | (static_cast<std::uint32_t>(u16()) << 16U);
    }
    std::int32_t i32() { return std::bit_cast<std::int32_t>(u32()); }
    float real() { return std::bit_cast<float>(u32()); }
    Point3 point()
    {
        const float x = real();
        const float y = real();
        return {x, y, real()};
    }
    std::string_view text(std::size_t length)
    {
        if (text_.size() < length) {
            throw BadMap("the file ends too early");
        }
        const std::string_view out = text_.substr(0, length);
        text_.remove_prefix(length);
        return out;
    }
    /// A count of things of `bytes` each, which the rest of the file can hold.
    std::size_t count(std::size_t bytes)
    {
        const std::size_t out = u32();
        if (out > text_.size() / bytes) {
            throw BadMap("the file ends too early");
        }
        return out;
    }
    [[nodiscard]] bool done() const { return text_.empty(); }

private:
    std::string_view text_;
};

void read_head(MapReader& in, MapTables& map)
{
    map.version = in.u16();
    if (map.version != geometry::kMeshVersion) {
        throw BadMap("version " + std::to_string(map.version) + " of the file, where " +
                     std::to_string(geometry::kMeshVersion) + " is read: make it anew by jink mesh build");
    }
    map.name = in.text(in.u16());
    map.metres_per_unit = in.real();
    map.slack = in.real();
    const std::uint16_t known = in.u16();
    if (known > 1) {
        throw BadMap("the origin is neither known nor unknown");
    }
    map.origin = {known == 1, in.i32(), in.i32(), in.i32()};
    map.low = in.point();
    map.high = in.point();
}

void read_tables(MapReader& in, MapTables& map)
{
    map.pieces.resize(in.count(kPieceBytes));
    map.vertices.resize(in.count(kVertexBytes));
    map.nodes.resize(in.count(kNodeBytes));
    for (MeshPiece& piece : map.pieces) {
        piece.centre = in.point();
        piece.first_vertex = in.u32();
        piece.vertices = in.u32();
    }
    for (Point3& v : map.vertices) {
        v = in.point();
    }
    for (MeshNode& node : map.nodes) {
        node.low = in.point();
        node.high = in.point();
        node.right = in.u16();
        node.piece = in.u16();
    }
    map.checksum = in.u32();
    if (!in.done()) {
        throw BadMap("the file goes on after its end");
    }
}

}  // namespace

MeshMap MapTables::view() const
{
    MeshMap map;
    map.name = name;
    map.version = version;
    map.metres_per_unit = metres_per_unit;
    map.slack = slack;
    map.origin = origin;
    map.low = low;
    map.high = high;
    map.pieces = pieces;
    map.vertices = vertices;
    map.nodes = nodes;
    map.checksum = checksum;
    return map;
}

std::string map_file_of(const MeshMap& map)
{
    Writer out;
    out.text(kMagic);
    out.u16(map.version);
    out.u16(map.name.size());
    out.text(map.name);
    out.real(map.metres_per_unit);
    out.real(map.slack);
    out.u16(map.origin.known ? 1 : 0);
    out.i32(map.origin.latitude);
    out.i32(map.origin.longitude);
    out.i32(map.origin.altitude);
    out.point(map.low);
    out.point(map.high);
    for (const std::size_t count : {map.pieces.size(), map.vertices.size(), map.nodes.size()}) {
        out.u32(count);
    }
    for (const MeshPiece& piece : map.pieces) {
        out.point(piece.centre);
        out.u32(piece.first_vertex);
        out.u32(piece.vertices);
    }
    for (const Point3& v : map.vertices) {
        out.point(v);
    }
    for (const MeshNode& node : map.nodes) {
        out.point(node.low);
        out.point(node.high);
        out.u16(node.right);
        out.u16(node.piece);
    }
    out.u32(map.checksum);
    return out.take();
}

std::optional<MapTables> parse_map(std::string_view text, const std::string& file, Complaints& complaints)
{
    try {
        MapReader in(text);
        if (text.size() < kMagic.size() || in.text(kMagic.size()) != kMagic) {
            throw BadMap("not a map file: jink mesh build makes them");
        }
        MapTables map;
        read_head(in, map);
        read_tables(in, map);
        if (const MapStatus status = geometry::check(map.view()); status != MapStatus::good) {
            throw BadMap(to_string(status));
        }
        return map;
    } catch (const BadMap& bad) {
        complaints.push_back({0, 0, bad.what(), file});
        return std::nullopt;
    }
}

std::optional<MapTables> read_map_file(const std::filesystem::path& path, Complaints& complaints)
{
    const std::optional<std::string> text = read_file(path, kMaxMapFile, "is larger than any map", complaints);
    return text ? parse_map(*text, path.string(), complaints) : std::nullopt;
}

const char* to_string(MapStatus status)
{
    switch (status) {
    case MapStatus::good: return "good";
    case MapStatus::empty: return "no piece";
    case MapStatus::wrong_version: return "stored in another version";
    case MapStatus::wrong_units: return "not in metres";
    case MapStatus::wrong_origin: return "an origin that is not on the globe, or nearer to a pole than 5 degrees";
    case MapStatus::too_large: return "more pieces or vertices than a map may have, or too deep a tree";
    case MapStatus::sizes_differ: return "tables that do not belong together";
    case MapStatus::bad_coordinate: return "a coordinate that is not finite, or beyond 1000 m";
    case MapStatus::bad_bounds: return "a box that does not hold its piece";
    case MapStatus::bad_tree: return "a tree that does not hold every piece once";
    case MapStatus::wrong_checksum: return "wrong checksum";
    }
    return "unknown";
}

}  // namespace jink::files
