// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string>

#include <CLI/CLI.hpp>

// How a program with subcommands ends.

namespace jink::sim {

/// Exit status for a wrong command line, a malformed file, and what else keeps a command from its work.
inline constexpr int kRefused = 2;

/// Prints the error of a command line, or the help that it asks for. @return the exit status
[[nodiscard]] inline int end_of_parse(const CLI::App& app, const std::string& program, const CLI::ParseError& error)
{
    // Without a subcommand CLI11 only says that one is missing, and leaves the word in its place unsaid.
    if (const auto unknown = app.remaining(true);
        !unknown.empty() && dynamic_cast<const CLI::RequiredError*>(&error) != nullptr) {
        std::cerr << program << ": unknown word '" << unknown.front() << "'\n";
    }
    return app.exit(error) == 0 ? EXIT_SUCCESS : kRefused;
}

/// The exit status `status`, unless standard output was lost, as on a full disk.
[[nodiscard]] inline int with_output(const std::string& program, int status)
{
    const bool written = std::cout.flush().good();
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && written) {
        return status;
    }
    std::cerr << program << ": standard output cannot be written\n";
    return kRefused;
}

}  // namespace jink::sim
