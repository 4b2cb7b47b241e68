// SPDX-License-Identifier: BSD-3-Clause
// jink report: a page about a demo run. toolchain/report/report.py does the work under Debian's own python3, which has
// matplotlib; another python3 earlier in PATH may lack it.
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>

#include "toolchain/host/commands.hpp"
#include "toolchain/host/header_text.hpp"
#include "toolchain/host/script.hpp"

namespace jink::host {
namespace {

namespace fs = std::filesystem;

struct ReportOptions {
    std::string folder;
    std::string run;
    std::string out;
    std::string python = "/usr/bin/python3";
};

void run_report(const ReportOptions& options)
{
    if (options.folder.empty() == options.run.empty()) {
        refuse("report", "give either a folder with run.json, or --run");
    }
    const std::string in = options.run.empty() ? (fs::path(options.folder) / "run.json").string() : options.run;
    const std::string out = !options.out.empty() ? options.out : (fs::path(in).parent_path() / "report.html").string();
    const std::string script = find_report_script("report.py").string();
    std::fflush(nullptr);
    // Replaces this program: its exit status is the script's. -I keeps PYTHONPATH and user packages out.
    execl(options.python.c_str(), options.python.c_str(), "-I", "-B", script.c_str(), "--run", in.c_str(), "--out",
          out.c_str(), static_cast<char*>(nullptr));
    refuse("report", options.python + " cannot be started: " + std::strerror(errno));
}

}  // namespace

void add_report(CLI::App& jink)
{
    auto options = std::make_shared<ReportOptions>();
    CLI::App* command = jink.add_subcommand("report", "make one self-contained HTML page of a demo run");
    command->add_option("folder", options->folder, "folder with run.json of jink-sim; the page is written beside it");
    command->add_option("--run", options->run, "the run itself, where it has another name");
    command->add_option("--out", options->out, "the page to write, default report.html beside the run");
    command->add_option("--python", options->python, "a Python 3 with matplotlib")->capture_default_str();
    command->callback([options] { run_report(*options); });
}

}  // namespace jink::host
