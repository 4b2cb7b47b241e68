// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace jink::test {

/// What the receivers of PX4's logs do with the parts (Tools/mavlink_ulog_streaming.py, QGroundControl's
/// MAVLinkLogProcessor): the first 16 bytes are the file's header; after a gap what is incomplete is dropped, a dropout
/// message is written, and the reading goes on with the message at first_message.
class StreamReceiver {
public:
    /// @return false: a part that was received before
    bool take(std::uint16_t sequence, std::uint8_t first_message, std::span<const std::byte> bytes, bool acknowledged)
    {
        const int ahead = last_ ? static_cast<std::int16_t>(sequence - *last_) : 1;
        if (ahead <= 0) {
            return false;
        }
        last_ = sequence;
        std::string data(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        std::size_t first = first_message;
        if (file.empty()) {
            file = data.substr(0, 16);
            data.erase(0, 16);
        }
        in_data = in_data || !acknowledged;
        if (ahead > 1) {
            lost += ahead - 1;
            rest_.clear();
            file += std::string{'\2', '\0', 'O', static_cast<char>(std::min(ahead - 1, 25) * 10), '\0'};
            if (first == 255) {
                return true;
            }
            data.erase(0, first);
            first = 0;
        }
        if (first == 255) {
            rest_ += data;
            return true;
        }
        file += rest_.empty() ? std::string() : rest_ + data.substr(0, first);
        rest_ = whole_messages(data.substr(first));
        return true;
    }

    std::string file;
    bool in_data = false;
    int lost = 0;  ///< parts

private:
    /// Writes the whole messages. @return the rest
    std::string whole_messages(std::string data)
    {
        const auto byte = [&](std::size_t i) { return static_cast<std::size_t>(static_cast<unsigned char>(data[i])); };
        while (data.size() > 2 && byte(0) + 256 * byte(1) + 3 <= data.size()) {
            const std::size_t size = byte(0) + 256 * byte(1) + 3;
            file += data.substr(0, size);
            data.erase(0, size);
        }
        return data;
    }

    std::optional<std::uint16_t> last_;
    std::string rest_;
};

}  // namespace jink::test
