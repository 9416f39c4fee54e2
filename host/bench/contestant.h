#pragma once

#include "bench/reference.h"
#include "bench/results.h"
#include "render/renderer.h"

#include <optional>
#include <string>
#include <vector>

namespace tristim {

/// One render of a race, and what was measured of it.
class Contestant {
  public:
    /// `times` are those of the checkpoints, ascending, in seconds of rendering, to which the seconds that went into
    /// choosing the method count.
    Contestant(Renderer renderer, std::vector<double> times, double trial_seconds = 0.0);

    /// Renders passes, at least one, for at most about `slice` seconds and not beyond the next checkpoint's time.
    void render(double slice);

    bool at_checkpoint() const { return seconds() >= next_time(); }

    /// Notes the error against the reference in each region, and goes on to the next checkpoint.
    void measure(const XyzImage& reference, const std::vector<NamedRegion>& regions);

    double seconds() const { return repeat_.trial_seconds + renderer_.statistics().render_seconds; }
    bool finished() const { return repeat_.finished; }
    const Repeat& repeat() const { return repeat_; }
    MemoryUse memory() const;
    XyzImage image() const { return xyz_image(renderer_.film()); }

    /// Writes the state of the render. Throws Error.
    void save(const std::string& path) const;

    /// Goes on from a saved state and the measurements that belong to it: those of later passes are dropped. Starts
    /// anew if there is no such file. Throws Error if the file is damaged or of another image.
    void restore(const std::string& path, const Repeat& measured);

  private:
    double next_time() const { return times_[std::min(next_, times_.size() - 1)]; }
    void skip_passed_times();

    Renderer renderer_;
    std::vector<double> times_;
    std::size_t next_ = 0; ///< checkpoint
    Repeat repeat_;
};

/// Times of checkpoints: eight in each factor of ten, the last at `seconds`, the first at 10 ms or above.
std::vector<double> checkpoint_times(double seconds);

} // namespace tristim
