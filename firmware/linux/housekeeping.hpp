// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "firmware/app/coprocessor.hpp"
#include "firmware/link/mavlink/endpoint.hpp"
#include "firmware/link/mavlink/signing.hpp"
#include "firmware/linux/background.hpp"

namespace jink::host {

struct SigningFiles {
    std::string key;                       ///< of --signing-key; may be empty
    std::string store;                     ///< the signing state; empty: keys are not taken from the link
    std::string unsigned_frames = "none";  ///< of --unsigned
};

/// Key, time and exceptions. False, and said why, where jinkd must not start.
[[nodiscard]] bool set_up_signing(const SigningFiles& files, files::SigningState& state,
                                  link::mavlink::Signing& signing);

/// The control loop's side of the background thread: hands over what is to be stored and takes what has been read.
/// Never waits. All references outlive this.
class Housekeeping {
public:
    /// @param given  hash of the key file's key, as the signing state holds it
    Housekeeping(Background& background, app::Coprocessor& coprocessor, const link::mavlink::Endpoint& endpoint,
                 const link::mavlink::Signing& signing, const files::SigningKey& given)
        : background_(background), coprocessor_(coprocessor), endpoint_(endpoint), signing_(signing), given_(given),
          stored_params_(coprocessor.parameters().generation())
    {
    }

    void has_airspace(bool yes) { has_airspace_ = yes; }
    /// A SIGHUP has come.
    void reload();
    /// Once per step. Signing's time is stored at the start, whenever it has moved by Signing::kStoreStep,
    /// and with every change of key.
    void work(TimePoint now);
    /// At the end: hands over what the last steps have changed.
    void store_all();

private:
    [[nodiscard]] bool store_signing();

    Background& background_;
    app::Coprocessor& coprocessor_;
    const link::mavlink::Endpoint& endpoint_;
    const link::mavlink::Signing& signing_;
    files::SigningKey given_;
    bool has_airspace_ = false;
    bool told_no_airspace_ = false;
    bool told_unchecked_ = false;
    std::uint32_t stored_params_;
    std::uint32_t stored_key_ = 0;   ///< Signing::generation() as stored
    std::uint64_t stored_time_ = 0;  ///< Signing::time() as stored
};

}  // namespace jink::host
