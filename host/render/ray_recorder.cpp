#include "render/ray_recorder.h"

#include <algorithm>

namespace tristim {

RayRecorder::RayRecorder(const Device& device, std::size_t capacity)
    : rays_(device, "recorded rays", capacity), count_(device, "recorded ray counts", 2) {
    clear(device);
}

void RayRecorder::clear(const Device& device) const {
    count_.write(device, {0U, static_cast<std::uint32_t>(rays_.size())});
}

std::vector<Ray> RayRecorder::read(const Device& device) const {
    const std::size_t count = count_.read(device)[0];
    return rays_.read(device, std::min(count, rays_.size()));
}

} // namespace tristim
