#include "commands/merge.h"

#include "base/error.h"
#include "base/parse_number.h"
#include "base/tell.h"
#include "commands/image_output.h"
#include "commands/parse.h"
#include "render/checkpoint.h"
#include "render/image_metadata.h"

#include <fmt/ranges.h>
#include <memory>

namespace tristim {
namespace {

struct MergeCommand {
    std::vector<std::string> files;
    ImageOutput image;
    std::string checkpoint;
    bool any_radii = false;
    bool quiet = false;
};

ImageMetadata metadata_of(const Checkpoint& c) {
    const auto integer = [&](const std::string& setting) {
        return parse_number<std::int64_t>(value_of(c.identity, setting)).value_or(0);
    };
    const auto passes = static_cast<std::int64_t>(c.sums.passes.count());
    return with_passes({{"scene", c.scene},
                        {"method", value_of(c.identity, "method")},
                        {"sequence", value_of(c.identity, "sequence")},
                        {"passes", passes},
                        {"photons", passes * integer("photons per pass")},
                        {"seed", integer("seed")},
                        {"device", c.devices},
                        {"seconds_rendering", c.seconds},
                        {"non_finite_samples", static_cast<std::int64_t>(c.sums.non_finite.total())},
                        {"version", std::string(TRISTIM_VERSION)}},
                       c.sums.passes);
}

void merge(const MergeCommand& command) {
    if (command.image.outfiles.empty() && command.checkpoint.empty())
        fail("nothing to write: give --outfile or --checkpoint");
    check(command.image, command.checkpoint);
    if (!command.checkpoint.empty())
        check_new_checkpoint(command.checkpoint);
    Checkpoint sum = read_checkpoint(command.files.front());
    std::vector<std::string> without_error_sums;
    const auto look_for_error_sums = [&](const Checkpoint& part, const std::string& file) {
        if (part.sums.error.empty())
            without_error_sums.push_back(file);
    };
    look_for_error_sums(sum, command.files.front());
    for (std::size_t i = 1; i < command.files.size(); ++i) {
        const Checkpoint more = read_checkpoint(command.files[i]);
        look_for_error_sums(more, command.files[i]);
        add_checkpoint(sum, command.files.front(), more, command.files[i], command.any_radii);
    }
    if (!without_error_sums.empty() && without_error_sums.size() < command.files.size())
        tell(
            "warning: the error of all passes cannot be estimated: these were rendered without --aov error, --aov bias "
            "and --error-target: {}\n",
            fmt::join(without_error_sums, ", "));
    const FilmImage film = develop_film(sum.sums.film, sum.width, sum.height, sum.region);
    const ErrorEstimate estimate = estimate_error(sum.sums, sum.region.width);
    if (wants_error_estimate(command.image) && !estimate.complete)
        fail("--aov error and bias need checkpoints of renders that had --aov or --error-target too");
    if (!command.checkpoint.empty()) {
        check_new_checkpoint(command.checkpoint); // another process may have written it meanwhile
        write_checkpoint(command.checkpoint, sum);
    }
    write(command.image, xyz_image(film), metadata_of(sum), estimate, sum.sums.film);
    if (!command.quiet)
        tell("{} passes ({}); {}; {} non-finite values\n", sum.sums.passes.count(), sum.sums.passes.text(),
             describe(estimate), sum.sums.non_finite.total());
}

} // namespace

void add_merge_command(CLI::App& app) {
    auto command = std::make_shared<MergeCommand>();
    CLI::App* sub = app.add_subcommand("merge", "Add up passes of one image that were rendered apart, to EXR and PNG");
    sub->add_option("files", command->files,
                    "Checkpoints (render --checkpoint) of one render, no pass in two of them; one alone will do")
        ->required()
        ->type_name("CHECKPOINT.exr");
    add_image_output(*sub, command->image, "Image to write, may be repeated");
    sub->add_option("--checkpoint", command->checkpoint, "New file for the sums, for render --resume or another merge")
        ->type_name("FILE.exr")
        ->check(not_empty());
    sub->add_flag("--any-radii", command->any_radii,
                  "Add up passes although devices measured other initial radii. The image is as right, but not the "
                  "bits that one device would render");
    sub->add_flag("--quiet", command->quiet, "No summary; errors still show");
    sub->callback([command] { merge(*command); });
}

} // namespace tristim
