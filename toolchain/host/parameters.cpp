// SPDX-License-Identifier: BSD-3-Clause
// jink parameters: the parameters as files of ground stations.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

#include "firmware/linux/param_file.hpp"
#include "toolchain/host/commands.hpp"
#include "toolchain/host/header_text.hpp"
#include "toolchain/host/parameter_metadata.hpp"
#include "toolchain/sim/option_range.hpp"

namespace jink::host {
namespace {

struct ParametersOptions {
    std::string vehicle;
    std::string params;
    std::string format = "metadata";
    std::string out;
    int version = 1;
    unsigned system = 1;
};

std::string text_of(const ParametersOptions& options, const files::ParamValues& values)
{
    if (options.format == "metadata") {
        return parameter_metadata(values, options.version).dump(1) + "\n";
    }
    return options.format == "qgroundcontrol" ? files::qgroundcontrol_text(values, options.system)
                                              : files::param_file_text(values);
}

void run_parameters(const ParametersOptions& options)
{
    check_outputs("parameters", {options.vehicle, options.params}, {options.out});
    files::Complaints complaints;
    const auto parameters = files::load_parameters(options.vehicle, options.params, complaints);
    for (const files::Complaint& complaint : complaints) {
        std::fprintf(stderr, "%s\n", files::to_string(complaint).c_str());
    }
    if (!parameters) {
        throw CLI::RuntimeError(kExitBadInput);
    }
    const std::string text = text_of(options, parameters->values());
    if (options.out.empty()) {
        if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
            throw std::runtime_error("standard output: cannot be written");
        }
        return;
    }
    write_whole("parameters", options.out, text);
}

}  // namespace

void add_parameters(CLI::App& jink)
{
    auto options = std::make_shared<ParametersOptions>();
    CLI::App* command =
        jink.add_subcommand("parameters", "write all parameters, as metadata or as values, for ground stations");
    command->add_option("--vehicle", options->vehicle, "vehicle file (YAML) that the values come from");
    command->add_option("--params", options->params, "parameter file; wins over the vehicle file");
    command
        ->add_option("--format", options->format,
                     "metadata: MAVLink component metadata (JSON); qgroundcontrol: .params; ardupilot: NAME,VALUE")
        ->capture_default_str()
        ->check(CLI::IsMember({"metadata", "qgroundcontrol", "ardupilot"}));
    command
        ->add_option("--metadata-version", options->version,
                     "version named in the metadata: 1 as QGroundControl and PX4, 3 as the schema")
        ->capture_default_str()
        ->check(CLI::IsMember({1, 3}));
    command->add_option("--system", options->system, "system id of the vehicle in a .params file")
        ->capture_default_str()
        ->check(sim::whole(1, 255));
    command->add_option("--out", options->out, "file to write; default standard output");
    command->callback([options] { run_parameters(*options); });
}

}  // namespace jink::host
