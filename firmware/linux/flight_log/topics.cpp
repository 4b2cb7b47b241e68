// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/flight_log/topics.hpp"

namespace jink::flightlog {
namespace {

template <class T>
std::string format_of(const char* name, std::span<const Counter<T>> counters)
{
    std::string text = std::string(name) + ":uint64_t timestamp;";
    for (const Counter<T>& counter : counters) {
        text += "uint32_t " + std::string(counter.name) + ";";
    }
    return text;
}

}  // namespace

std::vector<std::string> topic_formats()
{
    std::vector<std::string> formats{std::string(StepTopic::kFormat),
                                     std::string(OwnTopic::kFormat),
                                     std::string(TrackTopic::kFormat),
                                     std::string(DecisionTopic::kFormat),
                                     std::string(CandidateTopic::kFormat),
                                     format_of("jink_app_counters", app_counters()),
                                     format_of("jink_avoid_counters", avoid_counters()),
                                     std::string(LogTopic::kFormat),
                                     std::string(NominalTopic::kFormat),
                                     std::string(ObstacleTopic::kFormat),
                                     std::string(AreaTopic::kFormat)};
    for (const std::uint16_t size : kHalSizes) {
        formats.push_back("jink_hal_" + std::to_string(size) +
                          ":uint64_t timestamp;uint32_t sequence;uint16_t length;uint16_t flags;uint8_t[" +
                          std::to_string(size) + "] bytes;");
    }
    return formats;
}

}  // namespace jink::flightlog
