#pragma once

#include "commands/render_arguments.h"
#include "commands/render_checkpoint.h"
#include "scene_folder.h"
#include "test_scenes.h"

#include <cstring>
#include <functional>
#include <string>
#include <vector>

namespace tristim::test {

/// A small scene in a folder of its own, rendered in this process and by the command with the same options.
class CheckpointRenders {
  public:
    std::string path(const std::string& name) const { return folder_.path(name); }

    /// `tristim render` of the scene, to image.exr; quick passes.
    std::vector<std::string> command(std::vector<std::string> more) const {
        more.insert(more.begin(),
                    {"render", scene_.path, "--photons=1024", "--space=xyz", "--outfile", path("image.exr")});
        return more;
    }

    RenderOptions options() const {
        RenderArguments arguments;
        arguments.photons = 1024;
        return resolve_options(arguments, scene_);
    }

    /// What that command does with these arguments, image aside. `see` is called now and then.
    RenderSums render(
        const CheckpointArguments& arguments, const RenderBudget& limits,
        const std::function<void()>& see = [] {}) const {
        RenderCheckpoint checkpoint(arguments);
        checkpoint.check(scene_, options());
        Team team(scene_, options(), {test_device()});
        checkpoint.begin(team);
        team.render(limits, [&](std::uint64_t) {
            see();
            checkpoint.update(team);
            return true;
        });
        RenderSums sums = team.outcome().sums;
        checkpoint.save(sums);
        return sums;
    }

    const Scene& scene() const { return scene_; }
    const SceneFolder& folder() const { return folder_; }

  private:
    SceneFolder folder_;
    Scene scene_ = folder_.load("Camera \"perspective\"\n"
                                "Film \"rgb\" \"integer xresolution\" [ 16 ] \"integer yresolution\" [ 8 ]\n"
                                "WorldBegin\n"
                                "LightSource \"point\" \"point3 from\" [ 0 1 0 ] \"spectrum I\" \"stdillum-A\"\n"
                                "Material \"diffuse\" \"rgb reflectance\" [ 0.7 0.3 0.1 ]\n"
                                "Shape \"bilinearmesh\" \"point3 P\" [ -20 -20 5  20 -20 5  -20 20 5  20 20 5 ]\n");
};

template <typename T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

} // namespace tristim::test
