// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/block_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <sstream>

namespace jink::sim {
namespace {

namespace fs = std::filesystem;

constexpr const char* kManifest = "manifest.txt";

std::optional<std::string> text_of(const fs::path& file)
{
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return in ? std::optional(text.str()) : std::nullopt;
}

/// The last line of a block.
std::string seal(const std::string& text)
{
    std::array<char, 64> line{};
    const int n =
        std::snprintf(line.data(), line.size(), "end %td %016llx\n", std::count(text.begin(), text.end(), '\n'),
                      static_cast<unsigned long long>(checksum(text)));
    return {line.data(), static_cast<std::size_t>(n)};
}

/// The first line in which two manifests differ.
std::string difference(const std::string& there, const std::string& asked)
{
    std::istringstream a(there);
    std::istringstream b(asked);
    std::string of_there;
    std::string of_asked;
    do {
        of_there = std::getline(a, of_there) ? of_there : "nothing";
        of_asked = std::getline(b, of_asked) ? of_asked : "nothing";
    } while (of_there == of_asked && a && b);
    return "'" + of_there + "' there, '" + of_asked + "' asked for";
}

}  // namespace

std::uint64_t checksum(const std::string& text) noexcept
{
    std::uint64_t hash = 14695981039346656037U;
    for (const char c : text) {
        hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211U;
    }
    return hash;
}

BlockFolder::BlockFolder(fs::path folder) : folder_(std::move(folder)) {}

BlockFolder::~BlockFolder()
{
    if (lock_ >= 0) {
        ::close(lock_);
    }
}

void BlockFolder::claim(const std::string& manifest)
{
    std::error_code bad;
    fs::create_directories(folder_, bad);
    if (!fs::is_directory(folder_)) {
        throw BadFolder(folder_.string() + " is no folder and cannot be made one");
    }
    lock_ = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (lock_ < 0 || ::flock(lock_, LOCK_EX | LOCK_NB) != 0) {
        throw BadFolder(folder_.string() + " is being used by another run");
    }
    if (const auto there = text_of(folder_ / kManifest)) {
        if (*there != manifest) {
            throw BadFolder(folder_.string() + " belongs to another set-up: " + difference(*there, manifest));
        }
        return;
    }
    const std::string unfinished = std::string(kManifest) + ".part";
    const bool holds_else = std::any_of(fs::directory_iterator(folder_), fs::directory_iterator(),
                                        [&](const auto& entry) { return entry.path().filename() != unfinished; });
    if (holds_else) {
        throw BadFolder(folder_.string() + " is not empty and has no " + kManifest);
    }
    write_file(kManifest, manifest);
}

std::string BlockFolder::manifest() const
{
    const auto text = text_of(folder_ / kManifest);
    if (!text) {
        throw BadFolder(folder_.string() + " has no " + kManifest);
    }
    return *text;
}

std::vector<std::size_t> BlockFolder::missing(std::size_t count) const
{
    std::vector<std::size_t> missing;
    for (std::size_t i = 0; i < count; ++i) {
        if (!read(i)) {
            missing.push_back(i);
        }
    }
    return missing;
}

fs::path BlockFolder::block(std::size_t index) const
{
    std::array<char, 40> name{};
    std::snprintf(name.data(), name.size(), "block_%06zu.txt", index);
    return folder_ / name.data();
}

std::optional<std::string> BlockFolder::read(std::size_t index) const
{
    const auto text = text_of(block(index));
    if (!text || text->size() < 2) {
        return std::nullopt;
    }
    const std::size_t before = text->rfind('\n', text->size() - 2);
    const std::size_t body = before == std::string::npos ? 0 : before + 1;
    std::string lines = text->substr(0, body);
    return text->substr(body) == seal(lines) ? std::optional(std::move(lines)) : std::nullopt;
}

void BlockFolder::write(std::size_t index, const std::string& text) const
{
    write_file(block(index).filename().string(), text + seal(text));
}

void BlockFolder::write_file(const std::string& name, const std::string& text) const
{
    const fs::path file = folder_ / name;
    const fs::path part = file.string() + ".part";
    std::ofstream out(part, std::ios::binary | std::ios::trunc);
    out << text;
    out.close();
    std::error_code bad;
    if (out) {
        fs::rename(part, file, bad);
    }
    if (!out || bad) {
        throw BadFolder(file.string() + " cannot be written");
    }
}

}  // namespace jink::sim
