// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/outbox.hpp"

namespace jink::app {

void Outbox::say(link::Severity severity, std::string_view text) noexcept
{
    link_.send_text(severity, text);
    if (bus_ != nullptr) {
        bus_->send_text(severity, text);
    }
    if (log_ != nullptr) {
        log_->note_text(severity, text);
    }
}

void Outbox::send_notices() noexcept
{
    for (const Notice& notice : notices_) {
        say(notice.severity, notice.text.view());
    }
    notices_.clear();
}

std::uint32_t Outbox::write() noexcept
{
    last_written_ = write_pending();
    is_line_empty_ = link_.pending().empty();
    return last_written_;
}

std::uint32_t Outbox::write_pending() noexcept
{
    if (port_.health().state != hal::PortState::open) {
        link_.discard_pending();
        return 0;
    }
    std::uint32_t written = 0;
    for (int part = 0; part < 2 && !link_.pending().empty(); ++part) {
        const std::size_t n = port_.write(link_.pending());
        link_.consume(n);
        written += static_cast<std::uint32_t>(n);
        if (n == 0) {
            break;
        }
    }
    return written;
}

}  // namespace jink::app
