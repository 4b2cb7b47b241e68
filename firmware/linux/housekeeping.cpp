// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/housekeeping.hpp"

#include <ctime>
#include <memory>
#include <utility>

namespace jink::host {

bool set_up_signing(const SigningFiles& files, jink::files::SigningState& state, link::mavlink::Signing& signing)
{
    link::mavlink::UnsignedFrames frames;
    if (!jink::files::parse_unsigned_frames(files.unsigned_frames, frames)) {
        complain_now("--unsigned " + files.unsigned_frames + ": expected none, all, or up to 8 message ids");
        return false;
    }
    timespec t{};
    ::clock_gettime(CLOCK_REALTIME, &t);
    const std::uint64_t clock = jink::files::signing_clock(t.tv_sec * std::int64_t{1'000'000} + t.tv_nsec / 1000);
    jink::files::Complaints complaints;
    const auto loaded = jink::files::load_signing(files.key, files.store, clock, complaints);
    for (const jink::files::Complaint& complaint : complaints) {
        complain_now(jink::files::to_string(complaint));
    }
    if (!loaded) {
        return false;
    }
    state = *loaded;
    signing.take_unsigned(frames);
    signing.let_keys_be_set(!files.store.empty());
    signing.advance_to(state.time);
    if (state.has_key) {
        signing.set_key(state.key, state.time);
        complain_now(frames.all                ? "frames are signed; unsigned ones are taken too"
                     : frames.messages.empty() ? "frames are signed; unsigned ones are refused"
                                               : "frames are signed; unsigned ones are refused, with exceptions");
    }
    return true;
}

void Housekeeping::reload()
{
    if (has_airspace_) {
        background_.reload();
    } else if (!reported_no_airspace_) {
        background_.print(Stream::error, "jinkd: SIGHUP: there is no airspace file to read anew");
        reported_no_airspace_ = true;
    }
}

bool Housekeeping::store_signing()
{
    if (!background_.store_signing({signing_.has_key(), signing_.key(), signing_.time(), given_})) {
        return false;
    }
    stored_key_ = signing_.generation();
    stored_time_ = signing_.time();
    return true;
}

void Housekeeping::work(TimePoint now)
{
    if (std::unique_ptr<Areas> areas = background_.take_areas()) {
        coprocessor_.set_constraints(*areas, now);
        if (recorder_ != nullptr) {
            recorder_->areas(*areas, now);
        }
        background_.done(std::move(areas));
    }
    const app::Parameters& parameters = coprocessor_.parameters();
    if (parameters.generation() != stored_params_ && background_.store(parameters.values(), parameters.generation())) {
        stored_params_ = parameters.generation();
    }
    if (const auto generation = background_.stored_generation(); generation && generation != noted_params_) {
        coprocessor_.note_stored(*generation);
        noted_params_ = generation;
        if (recorder_ != nullptr) {
            recorder_->stored(*generation);
        }
    }
    if (endpoint_.parser_diagnostics().signed_unchecked > 0 && !reported_unchecked_) {
        background_.print(Stream::error,
                          "jinkd: frames on the link are signed and no key is set: signatures are not checked, and the "
                          "signer may refuse what jink sends (--signing-key)");
        reported_unchecked_ = true;
    }
    const bool is_due = signing_.has_key() && signing_.time() - stored_time_ >= link::mavlink::Signing::kStoreStep;
    if (is_due || signing_.generation() != stored_key_) {
        static_cast<void>(store_signing());
    }
}

void Housekeeping::store_all()
{
    const app::Parameters& parameters = coprocessor_.parameters();
    bool params_wait = parameters.generation() != stored_params_;
    bool signing_waits = signing_.has_key() || signing_.generation() != stored_key_;
    for (int i = 0; i < 100 && (params_wait || signing_waits); ++i) {  // the thread holds the lock for microseconds
        params_wait = params_wait && !background_.store(parameters.values(), parameters.generation());
        signing_waits = signing_waits && !store_signing();
        const timespec pause{0, 1'000'000};
        ::nanosleep(&pause, nullptr);
    }
}

}  // namespace jink::host
