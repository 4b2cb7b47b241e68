// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/host/nominal_log.hpp"

namespace jink::host {

void NominalLog::note(const LogFields& fields, double time)
{
    flightlog::NominalTopic topic;
    const auto take_vector = [&](const char* name, flightlog::Xyz& into) {
        for (std::size_t k = 0; k < into.size(); ++k) {
            into[k] = static_cast<float>(fields.number(name, k));
        }
    };
    take_vector("start", topic.start);
    take_vector("along", topic.along);
    take_vector("towards", topic.towards);
    topic.radius = static_cast<float>(fields.number("radius"));
    topic.length = static_cast<float>(fields.number("length"));
    topic.speed = static_cast<float>(fields.number("speed"));
    topic.segment = static_cast<std::uint8_t>(fields.code("segment"));
    if (all_.empty() || all_.back().time != time) {
        all_.emplace_back().time = time;
    }
    std::array<flightlog::NominalRoute, 2>& routes = all_.back().routes;
    const std::size_t path = fields.code("path");
    if (path < routes.size() && routes[path].segments.size() < kMaxRouteSegments &&
        flightlog::add_segment(routes[path], topic)) {
        routes[path].on_route = fields.code("on_route") != 0;
    }
}

std::vector<PageNominal> NominalLog::curves(const std::function<Vec3(double)>& own_at, Seconds lookahead) const
{
    std::vector<PageNominal> curves;
    for (const At& at : all_) {
        for (const flightlog::NominalRoute& route : at.routes) {
            if (!route.segments.empty()) {
                curves.push_back(
                    {at.time, route.on_route, flightlog::nominal_curve(route, own_at(at.time), lookahead)});
            }
        }
    }
    return curves;
}

}  // namespace jink::host
