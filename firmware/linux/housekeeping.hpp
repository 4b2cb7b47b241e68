// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "firmware/app/coprocessor.hpp"
#include "firmware/link/mavlink/endpoint.hpp"
#include "firmware/link/mavlink/signing.hpp"
#include "firmware/linux/background.hpp"
#include "firmware/linux/flight_log/recording_ports.hpp"

namespace jink::host {

struct SigningFiles {
    std::string key;                       ///< of --signing-key; may be empty
    std::string store;                     ///< the signing state; empty: keys from the link are refused
    std::string unsigned_frames = "none";  ///< of --unsigned
};

/// Sets up key, time and exceptions. False, with a message, if jinkd must not start.
[[nodiscard]] bool set_up_signing(const SigningFiles& files, files::SigningState& state,
                                  link::mavlink::Signing& signing);

/// The control loop's side of the background thread: passes data to store to it and takes the data it has read. Never
/// waits. All references outlive this.
class Housekeeping {
public:
    /// @param given  hash of the key file's key, as in the signing state
    Housekeeping(Background& background, app::Coprocessor& coprocessor, const link::mavlink::Endpoint& endpoint,
                 const link::mavlink::Signing& signing, const files::SigningKey& given)
        : background_(background), coprocessor_(coprocessor), endpoint_(endpoint), signing_(signing), given_(given),
          stored_params_(coprocessor.parameters().generation())
    {
    }

    void has_airspace(bool yes) { has_airspace_ = yes; }
    /// What is handed to the co-processor is recorded too; nullptr: not.
    void record_to(flightlog::HalRecorder* recorder) { recorder_ = recorder; }
    /// Handles a SIGHUP.
    void reload();
    /// Once per step. Signing's time is stored at the start, whenever it has moved by Signing::kStoreStep, and with
    /// every change of key.
    void work(TimePoint now);
    /// At the end: passes the changes of the last steps to the thread.
    void store_all();

private:
    [[nodiscard]] bool store_signing();

    Background& background_;
    app::Coprocessor& coprocessor_;
    const link::mavlink::Endpoint& endpoint_;
    const link::mavlink::Signing& signing_;
    files::SigningKey given_;
    flightlog::HalRecorder* recorder_ = nullptr;
    bool has_airspace_ = false;
    bool reported_no_airspace_ = false;
    bool reported_unchecked_ = false;
    std::uint32_t stored_params_;
    std::optional<std::uint32_t> noted_params_;  ///< generation that the co-processor knows to be stored
    std::uint32_t stored_key_ = 0;               ///< Signing::generation() as stored
    std::uint64_t stored_time_ = 0;              ///< Signing::time() as stored
};

}  // namespace jink::host
