#pragma once

#include "render/identity.h"
#include "render/sums.h"

#include <string>
#include <vector>

namespace tristim {

/// What a render has come to, all that is needed to go on with it or to add other passes of it.
struct Checkpoint {
    RenderSums sums;
    std::vector<float> initial_radii; ///< of each pixel, scene units: passes to come must use the same
    int width = 0;                    ///< of the whole image
    int height = 0;
    Region region;
    RenderIdentity identity;
    std::string scene;    ///< file, for people
    std::string devices;  ///< names of those that rendered, for people
    double seconds = 0.0; ///< of rendering so far
    std::string checksum; ///< of the file, where it was read from one
};

/// Writes one EXR file: each member of FilmPixel, the initial radius and the planes of error sums as a channel (32-bit
/// floats and unsigned integers, so that every bit is kept), the rest in the header; behind them a checksum over the
/// file, which is returned. It is replaced as a whole or not at all. Throws Error.
std::string write_checkpoint(const std::string& path, const Checkpoint& checkpoint);

/// Throws Error if the file is missing, is no checkpoint, is not what write_checkpoint wrote bit for bit, or was
/// written by a version that wrote others.
Checkpoint read_checkpoint(const std::string& path);

/// The checksum that stands in a file, be it right or not; empty if there is none.
std::string checksum_in(const std::string& path);

/// Whether there is such a file, be it damaged.
bool is_checkpoint(const std::string& path);

/// Throws Error if a checkpoint cannot be written at the path, or if a file stands there: saved work is never replaced
/// by other work.
void check_new_checkpoint(const std::string& path);

/// Adds the passes of another checkpoint of the same render. Throws Error, with both names, if it is another render's,
/// some passes are in both, or radii are not the same (other devices may have measured others) unless `any_radii`; then
/// those of `checkpoint` stay. Where radii follow each pixel's statistics, passes cannot be added.
void add_checkpoint(Checkpoint& checkpoint, const std::string& name, const Checkpoint& more,
                    const std::string& more_name, bool any_radii);

} // namespace tristim
