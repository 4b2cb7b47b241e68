// SPDX-License-Identifier: BSD-3-Clause
#include <bit>
#include <string_view>

#include "toolchain/mesh/stored_map.hpp"

// The file of a map: written and read number by number, little-endian on every host.

namespace jink::mesh {
namespace {

constexpr std::string_view kMagic{"JINKMAP\0", 8};

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

/// A read past the end sets a permanent error.
class Reader {
public:
    explicit Reader(std::string_view text) : text_(text) {}

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
            throw CannotBuild("the file ends too early");
        }
        const std::string_view out = text_.substr(0, length);
        text_.remove_prefix(length);
        return out;
    }
    /// Reads a count of items of `bytes` each; an error if the rest of the file is shorter.
    std::size_t count(std::size_t bytes)
    {
        const std::size_t out = u32();
        if (out > text_.size() / bytes) {
            throw CannotBuild("the file ends too early");
        }
        return out;
    }
    [[nodiscard]] bool done() const { return text_.empty(); }

private:
    std::string_view text_;
};

}  // namespace

std::string StoredMap::file() const
{
    Writer out;
    out.text(kMagic);
    out.u16(version_);
    out.u16(name_.size());
    out.text(name_);
    out.real(metres_per_unit_);
    out.real(slack_);
    out.point(low_);
    out.point(high_);
    for (const std::size_t count : {pieces_.size(), vertices_.size(), faces_.size(), nodes_.size()}) {
        out.u32(count);
    }
    for (const geometry::MeshPiece& piece : pieces_) {
        out.u32(piece.first_vertex);
        out.u32(piece.first_face);
        out.u16(piece.vertices);
        out.u16(piece.faces);
    }
    for (const Point3& v : vertices_) {
        out.point(v);
    }
    for (const geometry::FacePlane& face : faces_) {
        out.point(face.normal);
        out.real(face.offset);
    }
    for (const geometry::MeshNode& node : nodes_) {
        out.point(node.low);
        out.point(node.high);
        out.u16(node.right);
        out.u16(node.piece);
    }
    out.u32(checksum_);
    return out.take();
}

StoredMap StoredMap::from_file(const std::string& text)
{
    Reader in(text);
    if (text.size() < kMagic.size() || in.text(kMagic.size()) != kMagic) {
        throw CannotBuild("not a map file");
    }
    StoredMap map;
    map.version_ = in.u16();
    if (map.version_ != geometry::kMeshVersion) {
        throw CannotBuild("version " + std::to_string(map.version_) + " of the file, where " +
                          std::to_string(geometry::kMeshVersion) + " is read");
    }
    map.name_ = in.text(in.u16());
    map.metres_per_unit_ = in.real();
    map.slack_ = in.real();
    map.low_ = in.point();
    map.high_ = in.point();
    map.pieces_.resize(in.count(12));
    map.vertices_.resize(in.count(12));
    map.faces_.resize(in.count(16));
    map.nodes_.resize(in.count(28));
    for (geometry::MeshPiece& piece : map.pieces_) {
        piece.first_vertex = in.u32();
        piece.first_face = in.u32();
        piece.vertices = in.u16();
        piece.faces = in.u16();
    }
    for (Point3& v : map.vertices_) {
        v = in.point();
    }
    for (geometry::FacePlane& face : map.faces_) {
        face.normal = in.point();
        face.offset = in.real();
    }
    for (geometry::MeshNode& node : map.nodes_) {
        node.low = in.point();
        node.high = in.point();
        node.right = in.u16();
        node.piece = in.u16();
    }
    map.checksum_ = in.u32();
    if (!in.done()) {
        throw CannotBuild("the file goes on after its end");
    }
    if (const geometry::MapStatus status = geometry::check(map.view()); status != geometry::MapStatus::good) {
        throw CannotBuild(to_string(status));
    }
    return map;
}

}  // namespace jink::mesh
