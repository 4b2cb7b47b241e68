// SPDX-License-Identifier: BSD-3-Clause
// jink report: one page about flights, from a run of jink-sim or a flight log of jinkd.
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "toolchain/host/commands.hpp"
#include "toolchain/host/flight_page.hpp"
#include "toolchain/host/header_text.hpp"
#include "toolchain/host/script.hpp"

namespace jink::host {
namespace {

namespace fs = std::filesystem;

struct ReportOptions {
    std::vector<std::string> inputs;
    std::string out;
};

bool is_flight_log(const fs::path& file)
{
    std::string magic(4, '\0');
    std::ifstream(file, std::ios::binary).read(magic.data(), 4);
    return magic == "ULog" || file.extension() == ".ulg";
}

/// The file that an input names: of a folder its run.json. A FIFO is refused: its writer may never come.
fs::path file_of(const fs::path& input)
{
    const fs::path file = (fs::is_directory(input) ? input / "run.json" : input).lexically_normal();
    if (fs::exists(file) && !fs::is_regular_file(file)) {
        throw BadFlight(file.string() + ": is not a regular file");
    }
    return file;
}

PageSource read(const fs::path& file) { return is_flight_log(file) ? read_flight_log(file) : read_run(file); }

fs::path page_beside(const fs::path& file)
{
    return is_flight_log(file) ? fs::path(file).replace_extension(".html") : file.parent_path() / "report.html";
}

std::string viewer()
{
    const fs::path file = find_viewer();
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    if (!in || !(text << in.rdbuf())) {
        refuse("report", file.string() + " cannot be read: run toolchain/viewer/setup.sh, then build the target jink");
    }
    return text.str();
}

void run_report(const ReportOptions& options)
{
    std::vector<PageSource> sources;
    try {
        std::vector<std::string> files;
        for (const std::string& input : options.inputs) {
            files.push_back(file_of(input).string());
            sources.push_back(read(files.back()));
        }
        const fs::path out = options.out.empty() ? page_beside(files.front()) : fs::path(options.out);
        check_outputs("report", files, {out.string()});
        write_whole("report", out.string(), make_page(viewer(), sources));
        std::cout << "Written: " << out.string() << "\n";
    } catch (const BadFlight& error) {
        refuse("report", error.what());
    }
}

}  // namespace

void add_report(CLI::App& jink)
{
    auto options = std::make_shared<ReportOptions>();
    CLI::App* command = jink.add_subcommand(
        "report", "make one self-contained HTML page of flights: replay, candidates, charts; two inputs are compared");
    command
        ->add_option("inputs", options->inputs,
                     "flight log of jinkd (ULog), run.json of jink-sim, or the folder of a run.json; one or two")
        ->required()
        ->expected(1, 2);
    command->add_option("--out", options->out,
                        "the page to write, default report.html beside a run, NAME.html beside NAME.ulg");
    command->callback([options] { run_report(*options); });
}

}  // namespace jink::host
