// SPDX-License-Identifier: BSD-3-Clause
// jink check: says what is wrong with files, all of it, by line.
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "firmware/linux/param_file.hpp"
#include "firmware/linux/vehicle_file.hpp"
#include "toolchain/host/commands.hpp"

namespace jink::host {
namespace {

struct Options {
    std::vector<std::string> files;
    std::string as;
};

/// What a file is meant to be, by its name and its keys.
std::string kind_of(const std::string& path)
{
    const std::string extension = std::filesystem::path(path).extension().string();
    return extension == ".yaml" || extension == ".yml" ? "vehicle" : "params";
}

void check(const std::string& path, const std::string& kind, files::Complaints& complaints)
{
    if (kind == "params") {
        app::Parameters parameters;
        if (const auto values = files::apply_param_file(path, parameters.values(), complaints)) {
            files::apply_together(*values, path, parameters, complaints);
        }
        return;
    }
    static_cast<void>(files::read_vehicle_file(path, complaints));
}

void run(const Options& options)
{
    bool good = true;
    for (const std::string& path : options.files) {
        const std::string kind = options.as.empty() ? kind_of(path) : options.as;
        files::Complaints complaints;
        check(path, kind, complaints);
        for (const files::Complaint& complaint : complaints) {
            std::fprintf(stderr, "%s\n", files::to_string(complaint).c_str());
        }
        if (complaints.empty()) {
            std::printf("%s: good (%s)\n", path.c_str(), kind.c_str());
        }
        good = good && complaints.empty();
    }
    if (!good) {
        throw CLI::RuntimeError(kExitBadInput);
    }
}

}  // namespace

void add_check(CLI::App& jink)
{
    auto options = std::make_shared<Options>();
    CLI::App* command = jink.add_subcommand(
        "check", "say what is wrong with files, all of it, by line; exit status 1 when something is");
    command->add_option("files", options->files, "vehicle files (YAML) and parameter files")->required();
    command->add_option("--as", options->as, "what the files are, where name and keys do not tell")
        ->check(CLI::IsMember({"vehicle", "params"}));
    command->callback([options] { run(*options); });
}

}  // namespace jink::host
