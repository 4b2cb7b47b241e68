// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/link/mavlink/catalogue.hpp"

#include <algorithm>

#include "firmware/link/mavlink/catalogue_table.hpp"

namespace jink::link::mavlink {

static_assert(kCatalogue.size() < 512, "find_message() promises 9 comparisons");
static_assert(std::is_sorted(kCatalogue.begin(), kCatalogue.end(),
                             [](const MessageInfo& a, const MessageInfo& b) { return a.id < b.id; }));

const MessageInfo* find_message(std::uint32_t id) noexcept
{
    const auto* found =
        std::lower_bound(kCatalogue.data(), kCatalogue.data() + kCatalogue.size(), id,
                         [](const MessageInfo& info, std::uint32_t wanted) { return info.id < wanted; });
    return found != kCatalogue.data() + kCatalogue.size() && found->id == id ? found : nullptr;
}

}  // namespace jink::link::mavlink
