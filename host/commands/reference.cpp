#include "commands/reference.h"

#include "base/error.h"
#include "base/tell.h"
#include "bench/reference.h"
#include "commands/interrupt.h"
#include "commands/parse.h"
#include "commands/progress.h"
#include "commands/render_arguments.h"
#include "image/write_image.h"

#include <memory>
#include <optional>

namespace tristim {
namespace {

struct ReferenceCommand {
    RenderArguments arguments;
    std::string out;
    double seconds = 0.0;
    bool quiet = false;
};

void print_summary(const ReferenceCommand& command, const Reference& reference) {
    tell("{}{}: {} passes in {:.1f} s", interrupted() ? "interrupted: " : "", command.out, reference.passes,
         reference.seconds);
    if (reference.passes < 2) {
        tell("; one pass does not tell its error\n");
        return;
    }
    const ReferenceSummary summary = summarise_reference(reference, {{"image", reference.image.region}});
    tell("; error {:.3g} in XYZ (noise {:.3g}, blur of the search radius {:.3g})\n", summary.floor[0], summary.noise[0],
         summary.bias[0]);
}

void run(const ReferenceCommand& command) {
    check_seconds(command.seconds, "--time");
    if (!command.out.ends_with(".exr"))
        fail("cannot write \"{}\": a reference is an .exr file", command.out);
    check_writable(command.out);
    const Scene scene = load_scene(command.arguments.scene, command.arguments.rgb_upsampling);
    RenderOptions options = resolve_options(command.arguments, scene);
    options.seed = command.arguments.seed.value_or(reference_seed);
    if (!command.quiet)
        print_notes(scene);

    catch_interrupts();
    const Device device = open_device(command.arguments.device);
    std::optional<Progress> bar;
    std::uint64_t before = 0;
    const auto progress = [&](std::uint64_t passes, double seconds) {
        if (!bar) {
            if (passes > 0 && !command.quiet)
                tell("continuing {}: {} passes, {:.1f} s\n", command.out, passes, seconds);
            before = passes;
            bar.emplace(RenderBudget{{}, command.seconds - seconds}, options.photons_per_pass, command.quiet);
        }
        bar->update(passes - before);
        return !interrupted();
    };
    const Reference reference =
        render_reference(scene, command.arguments.scene, options, device, command.seconds, command.out, progress);
    if (bar)
        bar->finish(reference.passes - before);
    else if (!command.quiet)
        tell("nothing to do: {} has {:.1f} s of rendering already\n", command.out, reference.seconds);
    if (reference.rejected_samples > 0)
        tell("warning: {} values were not finite and left out\n", reference.rejected_samples);
    if (!command.quiet)
        print_summary(command, reference);
}

} // namespace

void add_reference_command(CLI::App& app) {
    auto command = std::make_shared<ReferenceCommand>();
    command->arguments.method = "spectral:400";
    CLI::App* sub = app.add_subcommand(
        "reference", "Render a reference image with its error, or continue one that was begun with the same options");
    add_render_arguments(*sub, command->arguments);
    sub->get_option("--seed")->description(
        fmt::format("Seed of all random numbers; renders to be measured must have another [{}]", reference_seed));
    sub->add_option("--time", command->seconds,
                    "Seconds of rendering that the reference is to have in all, those of earlier runs included; "
                    "kernel builds do not count")
        ->required();
    sub->add_option("--out", command->out,
                    "File to write or to continue. Ctrl-C writes what is done; it is also written every three minutes")
        ->type_name("REF.exr")
        ->required();
    sub->add_flag("--quiet", command->quiet, "No progress, notes or summary; errors still show");
    sub->callback([command] { run(*command); });
}

} // namespace tristim
