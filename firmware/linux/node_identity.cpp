// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/node_identity.hpp"

#include <cstring>
#include <fstream>
#include <random>
#include <span>

#include "firmware/link/mavlink/sha256.hpp"

namespace jink::host {

NodeIdentity node_identity(const std::string& machine_id_file, const std::string& interface)
{
    std::string machine;
    std::ifstream(machine_id_file) >> machine;
    NodeIdentity identity;
    identity.lasting = !machine.empty();
    if (machine.empty()) {
        std::random_device device;
        for (int i = 0; i < 8; ++i) {
            machine.append(std::to_string(device())).append(" ");
        }
    }
    const std::string text = std::string("jink node ").append(machine).append(" ").append(interface);
    link::mavlink::Sha256 hash;
    hash.add(std::as_bytes(std::span(text)));
    const link::mavlink::Sha256::Digest digest = hash.finish();
    for (std::size_t i = 0; i < identity.unique_id.size(); ++i) {
        identity.unique_id[i] = std::to_integer<std::uint8_t>(digest[i]);
    }
    std::memcpy(&identity.seed, digest.data() + identity.unique_id.size(), sizeof identity.seed);
    return identity;
}

}  // namespace jink::host
