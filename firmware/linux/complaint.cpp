// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/complaint.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>

namespace jink::files {
namespace {

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// Optimal string alignment distance, ignoring case. O(|a| |b|).
std::size_t edit_distance(std::string_view a, std::string_view b)
{
    std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i) {
        d[i][0] = i;
    }
    for (std::size_t j = 0; j <= b.size(); ++j) {
        d[0][j] = j;
    }
    for (std::size_t i = 1; i <= a.size(); ++i) {
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t change = lower(a[i - 1]) == lower(b[j - 1]) ? 0U : 1U;
            d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + change});
            if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1])) {
                d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
            }
        }
    }
    return d[a.size()][b.size()];
}

}  // namespace

std::string to_string(const Complaint& complaint)
{
    std::string text = complaint.file;
    if (complaint.line != 0) {
        text += ":" + std::to_string(complaint.line);
    }
    if (complaint.line != 0 && complaint.column != 0) {
        text += ":" + std::to_string(complaint.column);
    }
    return text + ": " + complaint.text;
}

std::string to_text(float value)
{
    std::array<char, 32> buffer{};
    const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
    return error == std::errc{} ? std::string(buffer.data(), end) : std::string("?");
}

std::string printable(std::string_view text)
{
    constexpr std::size_t kLongest = 60;
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string out;
    for (const char c : text.substr(0, kLongest)) {
        if (c >= ' ' && c <= '~') {
            out += c;
        } else {
            const auto byte = static_cast<unsigned char>(c);
            out += "\\x";
            out += kDigits[byte >> 4U];
            out += kDigits[byte & 15U];
        }
    }
    return text.size() > kLongest ? out + "..." : out;
}

std::size_t end_of_utf8(std::string_view text)
{
    const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
    for (std::size_t i = 0; i < text.size();) {
        const unsigned first = byte(i);
        const std::size_t more = first < 0x80U ? 0U : first < 0xE0U ? 1U : first < 0xF0U ? 2U : 3U;
        // The second byte excludes what has a shorter form, surrogates, and what is beyond U+10FFFF.
        const unsigned low = first == 0xE0U ? 0xA0U : first == 0xF0U ? 0x90U : 0x80U;
        const unsigned high = first == 0xEDU ? 0x9FU : first == 0xF4U ? 0x8FU : 0xBFU;
        bool good = more == 0 || (first >= 0xC2U && first <= 0xF4U && byte(i + 1) >= low && byte(i + 1) <= high);
        for (std::size_t k = 2; k <= more; ++k) {
            good = good && (byte(i + k) & 0xC0U) == 0x80U;
        }
        if (!good) {
            return i;
        }
        i += more + 1;
    }
    return text.size();
}

std::string in_quotes(std::string_view text)
{
    std::string out(1, '\'');
    out += printable(text);
    out += '\'';
    return out;
}

template <class Number>
static NumberStatus parse(std::string_view text, Number& out)
{
    if (text.starts_with('+') && text.size() > 1 && text[1] != '-') {
        text.remove_prefix(1);
    }
    Number value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc::result_out_of_range && end == text.data() + text.size()) {
        return NumberStatus::too_big;
    }
    if (error != std::errc{} || end != text.data() + text.size()) {
        return NumberStatus::not_a_number;
    }
    if (!std::isfinite(value)) {
        return NumberStatus::not_finite;
    }
    out = value;
    return NumberStatus::ok;
}

NumberStatus parse_number(std::string_view text, float& out) { return parse(text, out); }
NumberStatus parse_number(std::string_view text, double& out) { return parse(text, out); }

std::optional<std::string> judge_number(std::string_view text, const Range& range, bool integer, float& out)
{
    // YAML's own spellings of non-finite numbers, which are always refused.
    std::string_view bare = text;
    if (!bare.empty() && (bare[0] == '+' || bare[0] == '-')) {
        bare.remove_prefix(1);
    }
    float value = 0.0F;
    NumberStatus status = parse_number(text, value);
    if (bare == ".nan" || bare == ".NaN" || bare == ".NAN" || bare == ".inf" || bare == ".Inf" || bare == ".INF") {
        status = NumberStatus::not_finite;
    }
    const std::string said = in_quotes(text);
    switch (status) {
    case NumberStatus::not_a_number: return said + " is not a number";
    case NumberStatus::not_finite: return said + " is not finite";
    case NumberStatus::too_big: return said + " is beyond what single precision can hold";
    case NumberStatus::ok: break;
    }
    if (!(value >= range.low && value <= range.high)) {
        return said + " is out of range: " + to_text(range.low) + " to " + to_text(range.high);
    }
    if (integer && value != std::floor(value)) {
        return said + " is not a whole number";
    }
    out = value;
    return std::nullopt;
}

std::optional<std::string> nearest_name(std::string_view name, std::span<const std::string_view> names)
{
    constexpr std::size_t kLongest = 64;  // longer names are not typing errors, and the search stays cheap
    if (name.empty() || name.size() > kLongest) {
        return std::nullopt;
    }
    std::optional<std::string> best;
    std::size_t least = std::max<std::size_t>(1, name.size() / 3) + 1;
    for (const std::string_view candidate : names) {
        const std::size_t distance = edit_distance(name, candidate);
        if (distance < least) {
            least = distance;
            best = std::string(candidate);
        }
    }
    return best;
}

std::string suggestion(std::string_view name, std::span<const std::string_view> names)
{
    const std::optional<std::string> meant = nearest_name(name, names);
    return meant ? "; did you mean '" + *meant + "'?" : std::string{};
}

std::optional<std::string> read_text_file(const std::filesystem::path& path, Complaints& complaints)
{
    return read_file(path, kMaxFileSize, "is larger than 1 MiB: not a hand-written file", complaints);
}

std::optional<std::string> read_file(const std::filesystem::path& path, std::size_t most, const char* too_large,
                                     Complaints& complaints)
{
    const auto refuse = [&](const char* why) {
        complaints.push_back({0, 0, why, path.string()});
        return std::nullopt;
    };
    // O_NONBLOCK: otherwise a FIFO without a writer would block.
    const int file = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (file < 0) {
        return refuse(errno == ENOENT || errno == ENOTDIR ? "no such file" : "cannot be opened");
    }
    struct Closer {
        int descriptor;
        ~Closer() { ::close(descriptor); }
    } const closer{file};
    struct stat status {};
    if (::fstat(file, &status) != 0) {
        return refuse("cannot be read");
    }
    if (S_ISDIR(status.st_mode)) {
        return refuse("is a directory");
    }
    if (!S_ISREG(status.st_mode)) {
        return refuse("is not a regular file");
    }
    std::string text(most + 1, '\0');
    std::size_t size = 0;
    while (size < text.size()) {
        const ssize_t n = ::read(file, text.data() + size, text.size() - size);
        if (n < 0 && errno == EINTR) {
            continue;
        }
        if (n < 0) {
            return refuse("cannot be read");
        }
        if (n == 0) {
            break;
        }
        size += static_cast<std::size_t>(n);
    }
    text.resize(size);
    if (text.size() > most) {
        return refuse(too_large);
    }
    return text;
}

}  // namespace jink::files
