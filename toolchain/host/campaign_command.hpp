// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "toolchain/host/campaign.hpp"

namespace jink::host {

/// The command `campaign` of jink and jink-sim-mpi.
struct CampaignOptions {
    std::string csv;
    bool json = false;
};

CLI::App& add_campaign_options(CLI::App& cli, CampaignOptions& options);

/// Prints the merged study and writes its rows. @return exit status: kExitStop when a figure that must agree does not,
/// kExitBadInput when the rows cannot be written
/// @param seconds  duration of the study, printed but not compared
int conclude_campaign(const CampaignOptions& options, const std::vector<StudyBlock>& blocks, double seconds);

}  // namespace jink::host
