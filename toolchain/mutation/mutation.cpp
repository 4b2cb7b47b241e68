// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/mutation/mutation.hpp"

#include <cstddef>
#include <cstdio>
#include <cstdlib>

// JINK_MUTANTS: how many there are, numbered from 1 (set by the build).

namespace jink_mutation {

namespace {

int number_from(const char* name)
{
    const char* const given = std::getenv(name);
    return given == nullptr ? 0 : std::atoi(given);
}

/// Writes the differing mutants at the end of the program: one byte per mutant, the first byte for none.
struct Record {
    ~Record()
    {
        const char* const path = std::getenv("JINK_MUTATION_RECORD");
        std::FILE* const file = path == nullptr ? nullptr : std::fopen(path, "wb");
        if (file != nullptr) {
            std::fwrite(differs, 1, std::size_t{JINK_MUTANTS} + 1, file);
            std::fclose(file);
        }
    }
};

}  // namespace

unsigned char differs[JINK_MUTANTS + 1] = {};
const int active = number_from("JINK_MUTANT");
const bool recording = std::getenv("JINK_MUTATION_RECORD") != nullptr;
const Record record;

}  // namespace jink_mutation
