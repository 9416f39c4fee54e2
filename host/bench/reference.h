#pragma once

#include "bench/results.h"
#include "image/image.h"
#include "render/device_scene.h"
#include "render/scene_identity.h"

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace tristim {

/// A reference is the mean of two renders that differ in the seed. Passes within a render are stratified against each
/// other, so that its error cannot be told from their spread, which overstates it up to fourfold where direct light
/// dominates. The two renders are independent, and their difference tells it. The price is that passes are stratified
/// within a half alone: up to √2 more noise than a single render of as many passes has.
struct ReferenceHalf {
    std::uint64_t passes = 0;
    std::vector<std::array<float, 3>> xyz;      ///< mean XYZ of its passes
    std::vector<std::array<float, 3>> snapshot; ///< of its first Reference::snapshot_passes; empty if none
};

/// A long render that others are measured against.
struct Reference {
    XyzImage image;
    std::vector<std::array<float, 3>> variance; ///< of image.xyz, from the spread over the passes: see ReferenceHalf
    std::array<ReferenceHalf, 2> halves;
    std::uint64_t snapshot_passes = 0; ///< of each half, to tell what the search radius still blurs; 0: none
    std::string scene;                 ///< file, as it was given
    std::string method;
    std::uint64_t passes = 0;           ///< of both halves
    std::uint64_t photons = 0;          ///< photon paths
    double seconds = 0.0;               ///< of rendering, kernel builds excluded
    std::uint32_t seed = 0;             ///< of the first half
    std::uint64_t rejected_samples = 0; ///< that were not finite
    SceneIdentity identity;
    /// Names and values of the other options that shape a pass.
    std::vector<std::pair<std::string, std::string>> settings;
};

/// The seeds of the halves of a reference with this seed.
constexpr std::array<std::uint32_t, 2> half_seeds(std::uint32_t seed) {
    return {seed, ~seed};
}

/// The seed of references unless the user says otherwise: one that renders hardly have, since passes of equal seed
/// would share their noise with the reference's halves.
inline constexpr std::uint32_t reference_seed = 0x52454631U;

/// Throws Error if the file is missing, damaged, not written by `tristim reference`, or holds values that are no
/// numbers.
Reference read_reference(const std::string& path);

/// Throws Error, which says what differs, unless the reference shows the wanted scene with the wanted camera,
/// resolution, region and depth, and has a pass in each half.
void check_reference(const Reference& reference, const std::string& path, const SceneIdentity& wanted);

/// Noise, bias and floor of each region; `file` is left to the caller. The bias is what the search radius blurs, told
/// from what it blurred more after fewer passes, in proportion to r² (Knaus & Zwicker 2011, section 4): so of smooth
/// light; at edges that are blurred over several pixels, where it shrinks more slowly, the estimate is up to two and a
/// half times too small. Throws Error for a region that is not within the reference's.
ReferenceSummary summarise_reference(const Reference& reference, const std::vector<NamedRegion>& regions);

/// Called before each pass with the passes and seconds of rendering so far, those of an earlier run included; false
/// ends the rendering.
using ReferenceProgress = std::function<bool(std::uint64_t passes, double seconds)>;

/// Renders passes until the reference at `path` has `seconds` of rendering, kernel builds excluded. If the file exists
/// it is continued, and returned as it is if it has them already. Writes the file at the end, also if `progress` ended
/// it, and every few minutes before. Throws Error if a file there is no reference of this scene with these options, if
/// it cannot be written, for --radius statistics, and if `progress` ends it before there is a pass.
Reference render_reference(DeviceScenes& scenes, const std::string& scene_file, const RenderOptions& options,
                           const Device& device, double seconds, const std::string& path,
                           const ReferenceProgress& progress, double seconds_between_writes = 180.0);

/// The same of a scene that nothing else renders.
Reference render_reference(const Scene& scene, const std::string& scene_file, const RenderOptions& options,
                           const Device& device, double seconds, const std::string& path,
                           const ReferenceProgress& progress, double seconds_between_writes = 180.0);

} // namespace tristim
