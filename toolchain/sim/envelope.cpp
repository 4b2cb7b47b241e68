// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/envelope.hpp"

#include <algorithm>
#include <iomanip>
#include <sstream>

namespace jink::sim {
namespace {

template <class T, class Name>
void check(const std::set<T>& seen, const T& value, const char* what, Name name, std::vector<std::string>& wrong)
{
    if (seen.count(value) != 0) {
        return;
    }
    std::ostringstream text;
    text << what << " is " << name(value) << ", in process";
    for (const T& other : seen) {
        text << " " << name(other);
    }
    wrong.push_back(text.str());
}

}  // namespace

void Envelope::add(const Record& record)
{
    ++flights;
    outcomes.insert(record.outcome);
    given_back.insert(record.given_back);
    final_modes.insert(record.final_mode);
    takeovers.insert(record.takeovers);
    least = std::min(least, record.closest.surface);
    most = std::max(most, record.closest.surface);
}

double envelope_slack(double separation) noexcept { return 0.15 + 0.03 * std::max(0.0, separation); }

std::vector<std::string> outside(const Envelope& envelope, const Record& record)
{
    std::vector<std::string> wrong;
    if (envelope.flights == 0) {
        wrong.emplace_back("nothing to compare with");
        return wrong;
    }
    check(
        envelope.outcomes, record.outcome, "outcome", [](Outcome o) { return to_string(o); }, wrong);
    check(
        envelope.given_back, record.given_back, "given back", [](bool b) { return b ? "yes" : "no"; }, wrong);
    check(
        envelope.final_modes, record.final_mode, "final mode", [](Mode m) { return to_string(m); }, wrong);
    check(
        envelope.takeovers, record.takeovers, "number of takeovers", [](unsigned n) { return n; }, wrong);
    const double here = record.closest.surface;
    const bool near = here >= envelope.least - envelope_slack(envelope.least);
    const bool far = here <= envelope.most + envelope_slack(envelope.most);
    if (!near || !far) {
        std::ostringstream text;
        text << std::fixed << std::setprecision(2) << "least separation is " << here << " m, in process "
             << envelope.least << " to " << envelope.most << " m";
        wrong.push_back(text.str());
    }
    return wrong;
}

std::vector<std::string> outside_phases(const Scenario& scenario, const Record& record)
{
    Envelope envelope;
    std::vector<std::string> wrong = outside(envelope, record);
    while (!wrong.empty() && envelope.flights < kEnvelopePhases) {
        for (const Record& inside : fly_phases(scenario, envelope.flights + 1, 1, kRealTime)) {
            envelope.add(inside);
        }
        wrong = outside(envelope, record);
    }
    return wrong;
}

}  // namespace jink::sim
