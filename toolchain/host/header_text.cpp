// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/host/header_text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdio>
#include <filesystem>

#include "firmware/linux/param_store.hpp"
#include "toolchain/host/commands.hpp"

namespace jink::host {

std::string literal(float value)
{
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
    std::string out(text.data(), end);
    if (out.find_first_of(".e") == std::string::npos) {
        out.append(".0");
    }
    return out.append("F");
}

void append_array_of(std::string& out, const std::string& type, const std::string& name,
                     const std::vector<std::string>& items)
{
    constexpr std::size_t kWidth = 118;
    out.append("inline constexpr std::array<").append(type).append(", ").append(std::to_string(items.size()));
    const bool nested = !items.empty() && items.front().front() == '{';
    out.append("> ").append(name).append(nested ? "{{" : "{");
    std::string line = "\n    ";
    for (const std::string& item : items) {
        const std::string text = item + ",";
        if (line.size() + text.size() > kWidth) {
            out.append(line);
            line = "\n    ";
        } else if (line.size() > 5) {
            line.append(" ");
        }
        line.append(text);
    }
    out.append(line).append(nested ? "\n}};\n" : "\n};\n");
}

std::string identifier_of(const std::string& name)
{
    std::string out;
    bool starts = true;
    for (const char c : name) {
        const auto code = static_cast<unsigned char>(c);
        if (code >= 128 || std::isalnum(code) == 0) {
            starts = true;
            continue;
        }
        out.push_back(starts ? static_cast<char>(std::toupper(code)) : c);
        starts = false;
    }
    return out.empty() || std::isdigit(static_cast<unsigned char>(out.front())) != 0 ? std::string() : out;
}

bool names_tables(const std::string& name)
{
    return !identifier_of(name).empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
        return c < 128 && (std::isalnum(c) != 0 || c == ' ' || c == '-' || c == '_' || c == '.');
    });
}

[[noreturn]] void refuse(const std::string& command, const std::string& why)
{
    std::fprintf(stderr, "jink %s: %s\n", command.c_str(), why.c_str());
    throw CLI::RuntimeError(kExitBadInput);
}

files::Vehicle read_named_vehicle(const std::string& command, const std::string& file)
{
    files::Complaints complaints;
    auto vehicle = files::read_vehicle_file(file, complaints);
    for (const files::Complaint& complaint : complaints) {
        std::fprintf(stderr, "%s\n", files::to_string(complaint).c_str());
    }
    if (!vehicle) {
        throw CLI::RuntimeError(kExitBadInput);
    }
    if (!names_tables(vehicle->name)) {
        refuse(command, file + ": no C++ name can be made of the vehicle's name " + files::in_quotes(vehicle->name));
    }
    return *std::move(vehicle);
}

void write_whole(const std::string& command, const std::string& file, const std::string& text)
{
    if (const std::string wrong = files::replace_file(file, text); !wrong.empty()) {
        refuse(command, file + ": " + wrong);
    }
}

void check_outputs(const std::string& command, const std::vector<std::string>& inputs,
                   const std::vector<std::string>& outputs)
{
    for (const std::string& output : outputs) {
        std::error_code error;
        const std::filesystem::path folder = std::filesystem::path(output).parent_path();
        if (output.empty() || (std::filesystem::exists(output, error) && std::filesystem::is_other(output, error))) {
            continue;  // nothing, or a device
        }
        if (std::filesystem::is_directory(output, error) ||
            !std::filesystem::is_directory(folder.empty() ? "." : folder, error)) {
            refuse(command,
                   output + ": cannot be opened: " +
                       (std::filesystem::is_directory(output, error) ? "it is a folder" : "its folder does not exist"));
        }
    }
    if (const auto same = files::find_overwritten(inputs, outputs)) {
        refuse(command, same->output + ": cannot be written: it is the same file as " + same->other);
    }
}

}  // namespace jink::host
