// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/param_store.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "core/base/crc.hpp"

namespace jink::files {
namespace {

constexpr std::string_view kHead =
    "# Parameters set over a link, written by jinkd. Delete this file to take them back.\n";
constexpr std::string_view kEnd = "# end ";

std::string end_line(std::string_view text)
{
    Crc crc;
    for (const char c : text) {
        crc.add(static_cast<std::uint8_t>(c));
    }
    std::array<char, 32> line{};
    const int n = std::snprintf(line.data(), line.size(), "# end %08x\n", crc.value());
    return {line.data(), static_cast<std::size_t>(n)};
}

std::string reason(const char* what) { return std::string(what) + ": " + std::strerror(errno); }

bool write_all(int file, std::string_view text)
{
    while (!text.empty()) {
        const ssize_t n = ::write(file, text.data(), text.size());
        if (n > 0) {
            text.remove_prefix(static_cast<std::size_t>(n));
        } else if (n == 0 || errno != EINTR) {
            return false;
        }
    }
    return true;
}

/// A device or a pipe is written, not replaced.
std::string write_into(const std::string& path, std::string_view text)
{
    const int file = ::open(path.c_str(), O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (file < 0) {
        return reason("cannot be opened");
    }
    std::string why = write_all(file, text) ? std::string{} : reason("cannot be written");
    if (::close(file) != 0 && why.empty()) {
        why = reason("cannot be closed");
    }
    return why;
}

/// Makes the new name survive a power cut.
bool sync_folder(const std::string& path)
{
    const std::size_t slash = path.rfind('/');
    const std::string folder = slash == std::string::npos ? "." : slash == 0 ? "/" : path.substr(0, slash);
    const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) {
        return false;
    }
    const bool synced = ::fsync(descriptor) == 0 || errno == EINVAL;  // a file system without support for it
    return ::close(descriptor) == 0 && synced;
}

/// Applies as many of the values as are consistent. @return number of refused values
std::size_t apply_each(const ParamValues& wanted, const std::string& file, app::Parameters& parameters,
                       Complaints& complaints)
{
    const std::size_t refused = parameters.set_each(wanted);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        if (refused > 0 && parameters.values()[i] != wanted[i]) {
            complaints.push_back({0, 0,
                                  std::string(app::param_table()[i].name) + " = " + to_text(wanted[i]) +
                                      " does not fit together with the others",
                                  file});
        }
    }
    return refused;
}

}  // namespace

std::string state_text(const ParamValues& initial, const ParamValues& values)
{
    std::string text(kHead);
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (std::bit_cast<std::uint32_t>(values[i]) != std::bit_cast<std::uint32_t>(initial[i])) {
            text += std::string(app::param_table()[i].name) + "," + to_text(values[i]) + "\n";
        }
    }
    return with_checksum(text);
}

std::string with_checksum(const std::string& text) { return text + end_line(text); }

std::optional<std::string_view> without_checksum(std::string_view text)
{
    const std::size_t end = text.rfind(kEnd);
    if (end == std::string_view::npos || text.substr(end) != end_line(text.substr(0, end))) {
        return std::nullopt;
    }
    return text.substr(0, end);
}

std::string replace_file(const std::string& path, std::string_view text, FileAccess access)
{
    namespace fs = std::filesystem;
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (fs::exists(status) && !fs::is_regular_file(status)) {
        return access == FileAccess::owner_only ? "is no regular file" : write_into(path, text);
    }
    const fs::path resolved = fs::exists(status) ? fs::canonical(path, error) : fs::path(path);
    const std::string target = error || resolved.empty() ? path : resolved.string();
    const std::string fresh = target + ".new";
    const auto mode = static_cast<mode_t>(access);
    const int file = ::open(fresh.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NONBLOCK | O_NOFOLLOW | O_CLOEXEC, mode);
    if (file < 0) {
        return reason("cannot be opened");
    }
    std::string why;
    if (access == FileAccess::owner_only && ::fchmod(file, mode) != 0) {  // the file may exist already, with another
                                                                          // mode
        why = reason("cannot be kept secret");
    } else if (!write_all(file, text)) {
        why = reason("cannot be written");
    } else if (::fsync(file) != 0) {
        why = reason("cannot be synchronised");
    }
    if (::close(file) != 0 && why.empty()) {
        why = reason("cannot be closed");
    }
    if (why.empty() && ::rename(fresh.c_str(), target.c_str()) != 0) {
        why = reason("cannot be renamed");
    }
    if (!why.empty()) {
        ::unlink(fresh.c_str());
        return why;
    }
    return sync_folder(target) ? std::string{} : reason("the folder cannot be synchronised");
}

bool is_same_file(const std::string& a, const std::string& b)
{
    namespace fs = std::filesystem;
    const auto whole_path = [](const std::string& name) {
        std::error_code error;
        return fs::weakly_canonical(fs::absolute(name, error), error);
    };
    std::error_code error;
    return !a.empty() && !b.empty() && (fs::equivalent(a, b, error) || whole_path(a) == whole_path(b));
}

std::optional<Overwritten> find_overwritten(const std::vector<std::string>& inputs,
                                            const std::vector<std::string>& outputs)
{
    std::vector<std::string> taken = inputs;
    for (const std::string& output : outputs) {
        std::error_code error;
        if (output.empty() || std::filesystem::is_other(output, error)) {
            continue;
        }
        const auto other = std::find_if(taken.begin(), taken.end(),
                                        [&](const std::string& name) { return is_same_file(output, name); });
        if (other != taken.end()) {
            return Overwritten{output, *other};
        }
        taken.push_back(output);
    }
    return std::nullopt;
}

StateLoad apply_state(std::string_view text, const std::string& file, app::Parameters& parameters,
                      Complaints& complaints)
{
    StateLoad out;
    const std::optional<std::string_view> body = without_checksum(text);
    if (!body) {
        complaints.push_back({0, 0, "its checksum is wrong: left out as a whole", file});
        out.refused = 1;
        return out;
    }
    ParamValues wanted = parameters.values();
    std::string_view rest = *body;
    for (std::size_t number = 1; !rest.empty(); ++number) {
        const std::size_t size = rest.find('\n');
        Complaints found;
        const auto changed = apply_param_text(rest.substr(0, size), file, wanted, found);
        for (Complaint& complaint : found) {
            complaint.line = number;
            complaints.push_back(std::move(complaint));
        }
        out.refused += changed ? 0U : 1U;
        out.taken += changed && *changed != wanted ? 1U : 0U;
        wanted = changed.value_or(wanted);
        rest = size == std::string_view::npos ? std::string_view{} : rest.substr(size + 1);
    }
    const std::size_t misfits = apply_each(wanted, file, parameters, complaints);
    out.refused += misfits;
    out.taken -= std::min(out.taken, misfits);
    return out;
}

StateLoad load_state(const std::string& path, app::Parameters& parameters, Complaints& complaints)
{
    std::error_code error;
    if (!std::filesystem::exists(path, error) && !error) {
        return {};
    }
    const std::optional<std::string> text = read_text_file(path, complaints);
    return text ? apply_state(*text, path, parameters, complaints) : StateLoad{0, 1};
}

}  // namespace jink::files
