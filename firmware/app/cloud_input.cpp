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
    std::size_t left = kMaxCloudBytesPerStep;
    std::size_t n = 0;
    do {
        n = port_->read(std::span(chunk_).first(std::min(chunk_.size(), left)));
        receiver_.receive({chunk_.data(), n}, now, port_tee_);
        left -= n;
    } while (n > 0 && left > 0);
    bytes_in_ += kMaxCloudBytesPerStep - left;
    full_steps_ += left == 0 ? 1U : 0U;
}

}  // namespace jink::app
