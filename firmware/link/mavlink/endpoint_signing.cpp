// SPDX-License-Identifier: BSD-3-Clause
// Keys set over the link.
#include <algorithm>

#include "firmware/link/mavlink/endpoint.hpp"

namespace jink::link::mavlink {

/// Armed vehicles keep their key, as in ArduPilot: with a key that only one side has, the autopilot refuses all our
/// frames. Without a key any sender may set one (as in PX4 and ArduPilot); to change a key, the sender needs the key.
void Endpoint::on_setup_signing(const Context& c) noexcept
{
    SetupSigning m;
    if (!decode(c.frame, m) || !for_us(m.target_system, m.target_component)) {
        ++diagnostics_.frames_ignored;
        return;
    }
    const bool has_key = signing_ != nullptr && signing_->has_key();
    const char* refusal = nullptr;
    if (signing_ == nullptr || !signing_->keys_can_be_set()) {
        refusal = "jink: no signing key set: no place to store it";
    } else if (has_key && !c.frame.is_signed) {
        refusal = "jink: no signing key set: message not signed";
    } else if (autopilot_.armed) {
        refusal = "jink: no signing key set: armed";
    } else if (m.initial_timestamp > Signing::kLatestStart) {
        refusal = "jink: no signing key set: time out of range";
    }
    if (refusal != nullptr) {
        ++diagnostics_.keys_refused;
        send_text(Severity::warning, refusal);
        return;
    }
    Signing::Key key;
    std::transform(m.secret_key.begin(), m.secret_key.end(), key.begin(), [](std::uint8_t b) { return std::byte{b}; });
    if (key == Signing::Key{} && m.initial_timestamp == 0) {
        // The last signed text: the sender of the request still expects signatures.
        send_text(Severity::warning, "jink: signing is off");
        signing_->remove_key();
    } else {
        signing_->set_key(key, m.initial_timestamp);
        send_text(Severity::notice, "jink: signing key set");
    }
    ++diagnostics_.keys_set;
}

}  // namespace jink::link::mavlink
