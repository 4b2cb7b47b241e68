// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "firmware/link/mavlink/signing.hpp"
#include "firmware/linux/complaint.hpp"

// Keys of MAVLink signing in files: the hand-written key file, and the signing state that jinkd writes beside its state
// file, readable by its owner alone. No message ever contains a key.

namespace jink::files {

using SigningKey = link::mavlink::Signing::Key;

/// State kept over a restart.
struct SigningState {
    bool has_key = false;
    SigningKey key{};
    std::uint64_t time = 0;  ///< of the last signature [10 us since 2015]
    /// SHA-256 of the key file's key when this was stored; zeros: there was no key file.
    SigningKey given{};
    bool operator==(const SigningState&) const = default;
};

/// The key of a key file: 64 hexadecimal digits, or `passphrase TEXT`, whose key is the SHA-256 of TEXT as with
/// MAVProxy's `signing setup TEXT`. Empty lines and lines that begin with # are ignored. Nothing, with a complaint, if
/// there is no such line, more than one, or an invalid one.
[[nodiscard]] std::optional<SigningKey> parse_key_file(std::string_view text, const std::string& file,
                                                       Complaints& complaints);
/// The same from a file; the key, with a complaint, if users other than its owner may read the file.
[[nodiscard]] std::optional<SigningKey> read_key_file(const std::string& path, Complaints& complaints);

/// Text of a signing state, and back. Nothing if the text was cut or changed: it ends with a checksum.
[[nodiscard]] std::string signing_text(const SigningState& state);
[[nodiscard]] std::optional<SigningState> parse_signing_text(std::string_view text);

/// State at the start of jinkd.
///
/// @param key_file  of --signing-key; may be empty
/// @param store     the signing state; may be empty, or not there yet
/// @param clock     time of the system clock [10 us since 2015]; 0: unknown
/// @return nothing, with complaints, if the key file is not good, or if the store is damaged or cannot be opened and no
///         key file gives the key. The key of the store is used if it was set over the link while this key file was in
///         use, or if there is no key file; else that of the key file. `time` is the later of the clock's and the
///         stored one plus Signing::kRestartMargin.
[[nodiscard]] std::optional<SigningState> load_signing(const std::string& key_file, const std::string& store,
                                                       std::uint64_t clock, Complaints& complaints);

/// "none", "all", or message ids separated by commas. False, with `frames` unchanged, for any other text.
[[nodiscard]] bool parse_unsigned_frames(std::string_view text, link::mavlink::UnsignedFrames& frames);

/// Time of the system clock in units of a signature; 0 before 2015.
[[nodiscard]] std::uint64_t signing_clock(std::int64_t unix_us) noexcept;

}  // namespace jink::files
