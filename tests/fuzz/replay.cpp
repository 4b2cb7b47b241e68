// SPDX-License-Identifier: BSD-3-Clause
// Replaces libFuzzer where unavailable: runs every given file, then mutations of them.
//   fuzz_<name> <file or folder> [<mutations> <seed>]
// An input that fails is left in ./failed_input for replay.
#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include "core/base/random.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using Input = std::vector<std::uint8_t>;

const Input* current = nullptr;

extern "C" void leave_input_behind(int signal)
{
    const int file = ::open("failed_input", O_WRONLY | O_CREAT | O_TRUNC, 0644);
    if (file >= 0 && ::write(file, current->data(), current->size()) == static_cast<ssize_t>(current->size())) {
        constexpr char kNote[] = "the input is in ./failed_input\n";
        static_cast<void>(!::write(STDERR_FILENO, kNote, sizeof kNote - 1));
    }
    std::signal(signal, SIG_DFL);
    std::raise(signal);
}

void run(const Input& input)
{
    current = &input;
    LLVMFuzzerTestOneInput(input.data(), input.size());
}

void mutate(jink::Random& random, Input& input, const std::vector<Input>& seeds)
{
    const auto place = [&] { return input.begin() + static_cast<std::ptrdiff_t>(random.below(input.size() + 1)); };
    const std::size_t steps = 1 + random.below(8);
    for (std::size_t i = 0; i < steps; ++i) {
        const Input& other = seeds[random.below(seeds.size())];
        switch (input.empty() ? 2 : random.below(6)) {
        case 0: input[random.below(input.size())] ^= static_cast<std::uint8_t>(1U << random.below(8)); break;
        case 1: input[random.below(input.size())] = static_cast<std::uint8_t>(random.below(256)); break;
        case 2: input.insert(place(), static_cast<std::uint8_t>(random.below(256))); break;
        case 3: input.erase(input.begin() + static_cast<std::ptrdiff_t>(random.below(input.size()))); break;
        case 4:
            if (input.size() + other.size() < 4096) {
                input.insert(place(), other.begin(), other.end());
            }
            break;
        default: input.resize(random.below(input.size() + 1)); break;
        }
    }
}

}  // namespace

int main(int argc, char** argv)
{
    if (argc != 2 && argc != 4) {
        std::fprintf(stderr, "usage: %s <file or folder> [<mutations> <seed>]\n", argv[0]);
        return 2;
    }
    for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL}) {
        std::signal(signal, leave_input_behind);
    }
    std::vector<std::filesystem::path> files;
    if (std::filesystem::is_directory(argv[1])) {
        for (const auto& entry : std::filesystem::directory_iterator(argv[1])) {
            files.push_back(entry.path());
        }
        std::sort(files.begin(), files.end());
    } else {
        files.emplace_back(argv[1]);
    }
    std::vector<Input> seeds;
    for (const auto& file : files) {
        std::ifstream stream(file, std::ios::binary);
        seeds.emplace_back(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
        run(seeds.back());
    }
    if (seeds.empty()) {
        std::fprintf(stderr, "no input in %s\n", argv[1]);
        return 2;
    }
    const unsigned long mutations = argc == 4 ? std::strtoul(argv[2], nullptr, 0) : 0;
    jink::Random random(argc == 4 ? std::strtoull(argv[3], nullptr, 0) : 0);
    for (unsigned long i = 0; i < mutations; ++i) {
        Input input = seeds[random.below(seeds.size())];
        mutate(random, input, seeds);
        run(input);
    }
    std::printf("%zu inputs and %lu mutations passed\n", seeds.size(), mutations);
    return 0;
}
