// SPDX-License-Identifier: BSD-3-Clause
// jink check: reports all errors in files, by line.
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "toolchain/host/commands.hpp"
#include "toolchain/host/file_kind.hpp"

namespace jink::host {
namespace {

struct CheckOptions {
    std::vector<std::string> files;
    std::string as;
};

bool is_good(const std::string& path, std::optional<FileKind> kind)
{
    files::Complaints complaints;
    if (!kind) {
        kind = guess_kind(path, complaints);
    }
    if (kind) {
        complaints = check_file(path, *kind);
    }
    for (const files::Complaint& complaint : complaints) {
        std::fprintf(stderr, "%s\n", files::to_string(complaint).c_str());
    }
    if (complaints.empty()) {
        std::printf("%s: good (%s)\n", path.c_str(), std::string(name_of(*kind)).c_str());
    }
    return complaints.empty();
}

void run_check(const CheckOptions& options)
{
    bool good = true;
    for (const std::string& path : options.files) {
        good = is_good(path, file_kind(options.as)) && good;
    }
    if (!good) {
        throw CLI::RuntimeError(kExitBadInput);
    }
}

}  // namespace

void add_check(CLI::App& jink)
{
    auto options = std::make_shared<CheckOptions>();
    CLI::App* command =
        jink.add_subcommand("check", "say what is wrong with files, by line; exit status 2 when something is");
    command->add_option("files", options->files, "vehicles, planning problems, scenarios (YAML) and parameter files")
        ->required();
    command->add_option("--as", options->as, "what the files are, where name and keys do not tell")
        ->check(CLI::IsMember({"vehicle", "problem", "scenario", "params"}));
    command->callback([options] { run_check(*options); });
}

}  // namespace jink::host
