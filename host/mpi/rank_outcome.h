#pragma once

#include "render/team.h"

#include <string>

namespace tristim {

/// What ranks tell each other of a render beside the film, as text: all of sums but the film and the passes, and the
/// passes that the rank was given but that its film does not hold.
std::string counts_text(const RenderSums& sums, const PassRanges& missing);

/// Adds the counts to those of `sums`, and takes the missing passes from its passes.
void add_counts(const std::string& text, RenderSums& sums);

/// An outcome's shares and statistics.
std::string outcome_text(const RenderOutcome& outcome);

/// Adds the shares, as those of a rank, and the statistics; buffers stay as they are.
void add_outcome(const std::string& text, int rank, RenderOutcome& outcome);

} // namespace tristim
