#pragma once

#include "opencl/buffer.h"
#include "render/device_scene.h"
#include "render/film.h"
#include "render/photon_sorter.h"
#include "render/ray_recorder.h"
#include "render/statistics.h"
#include "render/sums.h"

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace tristim {

/// What the random numbers of a pass come from: its wavelengths depend on `wavelength_seed` and `pass`, its paths on
/// `seed` and `pass`. It searches with the radius of pass `radius_pass`.
struct PassSeeds {
    std::uint32_t pass = 0;
    std::uint32_t seed = 0;
    std::uint32_t radius_pass = 0;
    std::uint32_t wavelength_seed = 0;
};

/// Renders passes of a scene on a device. The image is the mean of the passes, each of which depends on the scene, the
/// options and its number alone, so any passes may be rendered in any order (with --radius statistics: in ascending
/// order from 0, since radii then depend on the passes before).
class Renderer {
  public:
    /// Builds buffers and kernels, and runs a pilot pass, which makes drivers compile what they compile at the
    /// first launch and measures initial radii if the options give none. Throws Error if the options cannot be
    /// rendered or the scene was made for others, a kernel does not build or the device has too little memory.
    Renderer(std::shared_ptr<const DeviceScene> scene, const RenderOptions& options, const Device& device);

    /// Puts the scene on the device for this renderer alone.
    Renderer(const Scene& scene, const RenderOptions& options, const Device& device);

    void render_pass(std::uint32_t pass) { render_pass({pass, options_.seed, pass, options_.seed}); }
    void render_pass(const PassSeeds& seeds);

    /// Forgets all passes.
    void reset();

    /// Puts its programs into the cache (opencl/program_cache.h), as far as that was not done when they were built. On
    /// PoCL this takes half as long as building them anew: something for the end of a render.
    void keep_programs() const;

    /// Its rejected samples are non_finite().total().
    FilmImage film() const;

    /// All that the passes have added up to; which these are is not known here.
    RenderSums sums() const;

    /// The running sums, which another renderer of the same scene, options and device goes on from.
    std::vector<FilmPixel> film_pixels() const { return film_.read(device_); }

    /// The sums of kernels/error_sums.cl, and going on from them; none unless options().error_estimate.
    std::vector<float> error_sums() const {
        return error_sums_.read(device_, options_.error_estimate ? error_sums_.size() : 0);
    }
    void restore_error_sums(const std::vector<float>& sums) { error_sums_.write(device_, sums); }

    /// Goes on from the sums after `passes` passes that took `seconds`, as if this renderer had rendered them.
    void restore(const std::vector<FilmPixel>& film, std::uint64_t passes, double seconds);

    /// Rays traced so far, those of the pilot left out.
    RayTotals rays() const { return sums().rays; }

    /// Values that were not finite so far, those of the pilot left out.
    NonFiniteCounts non_finite() const { return sums().non_finite; }

    /// The search radius of each pixel in pass 0. Renderers that share the passes of an image must agree in it; on
    /// devices that round differently pilots may not.
    std::vector<float> initial_radii() const { return radius0_.read(device_); }
    void set_initial_radii(const std::vector<float>& radii);

    const RenderStatistics& statistics() const { return statistics_; }
    const RenderOptions& options() const { return options_; }
    const Effects& effects() const { return scene_->effects(); }
    const Device& device() const { return device_; }
    const Bvh& bvh() const { return scene_->buffers().bvh(); }

    /// The rays of the last pass, nearest-hit ones and shadow rays (Ray::unused = 1), if options().record_rays.
    std::vector<Ray> recorded_rays() const { return recorder_.read(device_); }

    /// The pass's data as the kernels left them, for tests.
    std::vector<VisiblePoint> visible_points() const { return visible_points_.read(device_); }
    std::vector<Photon> photons() const;
    std::vector<float> pass_table() const { return pass_table_.read(device_); }
    std::vector<cl_float4> gathered_flux() const { return gathered_flux_.read(device_); }

  private:
    void build_kernels();
    void allocate_photons(std::uint32_t capacity_per_item);
    void run_pilot();
    void clear_film();

    void fill_wavelengths(const PassSeeds& seeds);
    void trace_eye_paths(const PassSeeds& seeds, float scale);
    void trace_photons(const PassSeeds& seeds);
    void sort_photons();
    void gather_photons();
    /// Throws Error if the device ended a work-item's loops early (kernels/loops.h).
    void check_loops() const;
    void add_to_film();
    void add_to_error_sums(std::uint32_t pass);

    void enqueue(Step step, const ::cl::Kernel& kernel, std::size_t items, std::size_t group);
    PhotonSorter::Enqueue enqueue_grid();
    void collect_times();

    Device device_;
    RenderOptions options_;
    std::shared_ptr<const DeviceScene> scene_;
    WavelengthLayout layout_;
    RayRecorder recorder_;
    RenderStatistics statistics_;
    std::vector<std::pair<Step, ::cl::Event>> events_;

    Buffer<float> sampler_table_;
    Buffer<float> spectra_;
    Buffer<std::int32_t> spectrum_is_smooth_;
    int spectrum_rows_ = 0;
    int film_table_rows_ = 0; ///< of the material that has most
    Buffer<float> pass_table_;

    Buffer<float> radius0_;
    float largest_radius0_ = 0.0F;
    float largest_floor_ = 0.0F; ///< no search radius is raised beyond it
    Buffer<VisiblePoint> visible_points_;
    Buffer<VisibleSurface> visible_surfaces_;
    Buffer<float> eye_spectra_;
    Buffer<std::uint32_t> largest_radius_;
    Buffer<cl_float4> gathered_flux_;
    Buffer<cl_float4> inner_flux_; ///< for error estimates: of photons within the radius over √2
    Buffer<float> error_sums_;     ///< for error estimates
    Buffer<FilmPixel> film_;
    Buffer<std::uint32_t> non_finite_;

    std::uint32_t photon_items_ = 0;
    std::uint32_t capacity_per_item_ = 0;
    std::uint32_t photon_count_ = 0; ///< stored in the last pass
    Buffer<Photon> photons_;
    Buffer<PhotonSurface> photon_surfaces_;
    Buffer<float> photon_spectra_;
    Buffer<std::uint32_t> item_counts_;
    Buffer<std::uint64_t> item_rays_;
    PhotonSorter sorter_;

    ::cl::Kernel wavelengths_;
    ::cl::Kernel film_tables_;
    ::cl::Kernel eye_pass_;
    ::cl::Kernel photon_pass_;
    ::cl::Kernel gather_;
    ::cl::Kernel film_clear_;
    ::cl::Kernel film_largest_radius_;
    ::cl::Kernel film_add_;
    ::cl::Kernel error_add_;
};

} // namespace tristim
