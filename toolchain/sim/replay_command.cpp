// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/replay_command.hpp"

#include <cstdlib>
#include <iomanip>
#include <ostream>
#include <vector>

#include <CLI/CLI.hpp>

#include "firmware/link/mavlink/messages.hpp"
#include "firmware/link/mavlink/text.hpp"
#include "firmware/linux/param_file.hpp"
#include "toolchain/sim/replay.hpp"

namespace jink::sim {
namespace {

constexpr int kBadInput = 2;  ///< exit status

struct SpokenText {
    double time = 0.0;
    std::string text;
};

/// STATUSTEXTs of the recorded jinkd.
std::vector<SpokenText> texts_of(const std::vector<WireRecord>& records)
{
    std::vector<SpokenText> texts;
    link::mavlink::Parser parser;
    for (const WireRecord& record : records) {
        std::span<const std::byte> bytes(record.bytes);
        if (record.direction != WireDirection::from_jink) {
            continue;
        }
        while (const auto frame = parser.next(bytes)) {
            link::mavlink::Statustext text;
            if (link::mavlink::decode(*frame, text)) {
                texts.push_back({record.time, files::printable(link::mavlink::text_of(text.text))});
            }
        }
    }
    return texts;
}

}  // namespace

CLI::App& add_replay(CLI::App& cli, ReplayOptions& options)
{
    CLI::App* command = cli.add_subcommand(
        "replay", "a recorded stream of an autopilot through the co-processor: what it believed in each second");
    command->add_option("file", options.file, "recording, NAME.wire or NAME.wire.xz")
        ->required()
        ->check(CLI::ExistingFile);
    command->add_flag("--json", options.json, "one JSON object per line");
    command->add_option("--vehicle", options.vehicle, "vehicle file (YAML)")->check(CLI::ExistingFile);
    command->add_option("--params", options.params, "parameter file, over the vehicle file")->check(CLI::ExistingFile);
    return *command;
}

int run_replay(const ReplayOptions& options, std::ostream& out, std::ostream& errors)
{
    files::Complaints complaints;
    const auto parameters = files::load_parameters(options.vehicle, options.params, complaints);
    if (!parameters) {
        for (const files::Complaint& complaint : complaints) {
            errors << "jink-sim: " << to_string(complaint) << "\n";
        }
        return kBadInput;
    }
    const WireFile file = read_wire_file(options.file);
    const std::vector<SpokenText> texts = options.json ? std::vector<SpokenText>() : texts_of(file.records);
    std::size_t said = 0;
    replay(file.records, *parameters, [&](const Belief& belief) {
        for (; said < texts.size() && texts[said].time <= belief.time; ++said) {
            out << std::fixed << std::setprecision(2) << std::setw(8) << texts[said].time << "  recorded: \""
                << texts[said].text << "\"\n";
        }
        out << (options.json ? to_json(belief) : to_text(belief)) << "\n";
    });
    out.flush();
    if (!file.fault.empty()) {
        const double end = file.records.empty() ? 0.0 : file.records.back().time;
        errors << "jink-sim: " << options.file << ": " << file.fault << "; read until there: " << file.records.size()
               << " records, " << end << " s\n";
        return kBadInput;
    }
    return EXIT_SUCCESS;
}

}  // namespace jink::sim
