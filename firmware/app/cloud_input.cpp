// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/cloud_input.hpp"

#include <algorithm>

namespace jink::app {

void CloudInput::Tee::begin_scan(const link::CloudScan& scan) noexcept
{
    to.begin_scan(scan);
    also_open = also != nullptr;
    if (also_open) {
        also->begin_scan(scan);
    }
}

void CloudInput::Tee::add(link::Ray ray, const Vec3& point) noexcept
{
    to.add(ray, point);
    if (also_open) {
        also->add(ray, point);
    }
}

void CloudInput::Tee::end_scan(std::uint32_t points_lost) noexcept
{
    to.end_scan(points_lost);
    if (also_open) {
        also->end_scan(points_lost);
        also_open = false;
    }
}

void CloudInput::give_to(world::ObstacleTable& table) noexcept
{
    port_image_.give_to(table);
    link_image_.give_to(table);
}

void CloudInput::serve(TimePoint now, const CloudView& view) noexcept
{
    port_image_.look_from(view);
    link_image_.look_from(view);
    if (port_ == nullptr) {
        return;
    }
    const std::uint32_t scans_before = receiver_.diagnostics().scans;
    std::size_t left = kMaxCloudBytesPerStep;
    std::size_t n = 0;
    bool is_full = false;
    do {
        if (chunk_begin_ == chunk_end_) {
            chunk_begin_ = 0;
            chunk_end_ = port_->read(std::span(chunk_).first(std::min(chunk_.size(), left)));
            left -= chunk_end_;
        }
        n = std::min(kPiece, chunk_end_ - chunk_begin_);
        receiver_.receive({chunk_.data() + chunk_begin_, n}, now, port_tee_);
        chunk_begin_ += n;
        is_full = (left == 0 && chunk_begin_ == chunk_end_) ||
                  receiver_.diagnostics().scans - scans_before >= kMaxCloudScansPerStep;
    } while (n > 0 && !is_full);
    bytes_in_ += kMaxCloudBytesPerStep - left;
    full_steps_ += is_full ? 1U : 0U;
}

}  // namespace jink::app
