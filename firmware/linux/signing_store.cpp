// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/signing_store.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <span>

#include "firmware/link/mavlink/sha256.hpp"
#include "firmware/linux/param_store.hpp"

namespace jink::files {
namespace {

constexpr std::string_view kSigningHead = "# Signing key and time, written by jinkd. Keep it secret.\n";
constexpr std::string_view kPassphrase = "passphrase ";
constexpr std::string_view kHexDigits = "0123456789abcdefABCDEF";

SigningKey digest_of(std::span<const std::byte> bytes)
{
    link::mavlink::Sha256 sha;
    sha.add(bytes);
    return sha.finish();
}

std::string key_to_hex(const SigningKey& key)
{
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string out;
    for (const std::byte b : key) {
        out += kDigits[std::to_integer<unsigned>(b) >> 4U];
        out += kDigits[std::to_integer<unsigned>(b) & 15U];
    }
    return out;
}

std::optional<SigningKey> key_from_hex(std::string_view text)
{
    SigningKey key{};
    if (text.size() != 2 * key.size()) {
        return std::nullopt;
    }
    for (std::size_t i = 0; i < key.size(); ++i) {
        unsigned value = 0;
        const char* const end = text.data() + 2 * i + 2;
        if (std::from_chars(text.data() + 2 * i, end, value, 16).ptr != end) {
            return std::nullopt;
        }
        key[i] = static_cast<std::byte>(value);
    }
    return key;
}

std::string_view next_line(std::string_view& text)
{
    const std::size_t size = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, size);
    text.remove_prefix(std::min(text.size(), size + 1));
    if (line.ends_with('\r')) {
        line.remove_suffix(1);
    }
    return line;
}

/// The value of a "name value" line with exactly this name.
std::optional<std::string_view> value_of(std::string_view line, std::string_view name)
{
    return line.starts_with(name) ? std::optional(line.substr(name.size())) : std::nullopt;
}

}  // namespace

std::optional<SigningKey> parse_key_file(std::string_view text, const std::string& file, Complaints& complaints)
{
    std::optional<SigningKey> key;
    for (std::size_t number = 1; !text.empty(); ++number) {
        const std::string_view line = next_line(text);
        if (line.empty() || line.starts_with('#')) {
            continue;
        }
        const bool phrase = line.starts_with(kPassphrase) && line.size() > kPassphrase.size();
        const auto read =
            phrase ? digest_of(std::as_bytes(std::span(line.substr(kPassphrase.size())))) : key_from_hex(line);
        if (!read || key) {
            const std::size_t digits = std::min(line.find_first_not_of(kHexDigits), line.size());
            complaints.push_back(
                {number, key ? 1 : std::min(digits, 2 * SigningKey{}.size()) + 1,
                 key ? "there is a key already" : "neither 64 hexadecimal digits nor 'passphrase' and a text", file});
            return std::nullopt;
        }
        key = read;
    }
    if (!key) {
        complaints.push_back({0, 0, "there is no key", file});
    } else if (*key == SigningKey{}) {
        complaints.push_back({0, 0, "a key of zeros means no key", file});
        key.reset();
    }
    return key;
}

std::optional<SigningKey> read_key_file(const std::string& path, Complaints& complaints)
{
    const std::optional<std::string> text = read_text_file(path, complaints);
    if (!text) {
        return std::nullopt;
    }
    const std::optional<SigningKey> key = parse_key_file(*text, path, complaints);
    struct stat status {};
    if (key && ::stat(path.c_str(), &status) == 0 && (status.st_mode & (S_IRWXG | S_IRWXO)) != 0) {
        complaints.push_back({0, 0, "others than its owner have access to this key: chmod 600", path});
    }
    return key;
}

std::string signing_text(const SigningState& state)
{
    std::string text(kSigningHead);
    text += "key " + (state.has_key ? key_to_hex(state.key) : std::string("none")) + "\n";
    text += "time " + std::to_string(state.time) + "\n";
    text += "given " + key_to_hex(state.given) + "\n";
    return with_checksum(text);
}

std::optional<SigningState> parse_signing_text(std::string_view text)
{
    std::optional<std::string_view> body = without_checksum(text);
    if (!body || !body->starts_with(kSigningHead)) {
        return std::nullopt;
    }
    body->remove_prefix(kSigningHead.size());
    const auto key = value_of(next_line(*body), "key ");
    const auto time = value_of(next_line(*body), "time ");
    const auto given = value_of(next_line(*body), "given ");
    if (!key || !time || !given || !body->empty()) {
        return std::nullopt;
    }
    SigningState out;
    const auto [end, error] = std::from_chars(time->data(), time->data() + time->size(), out.time);
    const std::optional<SigningKey> given_key = key_from_hex(*given);
    const std::optional<SigningKey> stored = key_from_hex(*key);
    if (error != std::errc{} || end != time->data() + time->size() || !given_key || (!stored && *key != "none")) {
        return std::nullopt;
    }
    out.has_key = stored.has_value();
    out.key = stored.value_or(SigningKey{});
    out.given = *given_key;
    return out;
}

std::optional<SigningState> load_signing(const std::string& key_file, const std::string& store, std::uint64_t clock,
                                         Complaints& complaints)
{
    SigningState out;
    if (!key_file.empty()) {
        const std::optional<SigningKey> key = read_key_file(key_file, complaints);
        if (!key) {
            return std::nullopt;
        }
        out.has_key = true;
        out.key = *key;
        out.given = digest_of(*key);
    }
    out.time = clock;
    std::error_code error;
    if (store.empty() || (!std::filesystem::exists(store, error) && !error)) {
        return out;
    }
    const std::optional<std::string> text = read_text_file(store, complaints);
    const std::optional<SigningState> stored = text ? parse_signing_text(*text) : std::nullopt;
    if (!stored) {
        complaints.push_back({0, 0, "the signing state is damaged", store});
        return out.has_key ? std::optional(out) : std::nullopt;
    }
    if (key_file.empty() || stored->given == out.given) {
        out.has_key = stored->has_key;
        out.key = stored->key;
    }
    out.time = std::max(clock, stored->time + link::mavlink::Signing::kRestartMargin);
    return out;
}

bool parse_unsigned_frames(std::string_view text, link::mavlink::UnsignedFrames& frames)
{
    link::mavlink::UnsignedFrames out;
    out.all = text == "all";
    bool more = !out.all && text != "none";
    while (more) {
        const std::size_t size = std::min(text.find(','), text.size());
        std::uint32_t id = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + size, id);
        if (error != std::errc{} || end != text.data() + size || id > 0xFFFFFFU || !out.messages.try_push_back(id)) {
            return false;
        }
        more = size < text.size();
        text.remove_prefix(more ? size + 1 : size);
    }
    frames = out;
    return true;
}

std::uint64_t signing_clock(std::int64_t unix_us) noexcept
{
    constexpr std::int64_t kEpoch = 1'420'070'400'000'000;  // 2015-01-01 UTC [us]
    return unix_us > kEpoch ? static_cast<std::uint64_t>(unix_us - kEpoch) / 10U : 0U;
}

}  // namespace jink::files
