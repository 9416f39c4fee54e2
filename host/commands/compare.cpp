#include "commands/compare.h"

#include "base/region.h"
#include "image/compare_images.h"
#include "image/read_image.h"

#include <cmath>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

namespace tristim {
namespace {

struct CompareOptions {
    std::string a;
    std::string b;
    std::string region;
    bool json = false;
};

std::string describe_psnr(double psnr) {
    if (std::isnan(psnr))
        return "undefined (B is black)";
    return std::isinf(psnr) ? "infinite (no difference in Y)" : fmt::format("{:.4g} dB", psnr);
}

void print_table(const ImageDifference& d) {
    const auto print_mean = [](const char* name, const Xyz& mean) {
        fmt::print("{:<11} {:.6g}, {:.6g}, {:.6g}\n", name, mean[0], mean[1], mean[2]);
    };
    fmt::print("{:<11} {:.6g}  (XYZ, white of radiance 1: Y = 1)\n", "RMSE", d.rmse);
    fmt::print("{:<11} {:.6g}  (of (A-B)^2 / (B^2 + {}), no unit)\n", "relMSE", d.rel_mse, rel_mse_epsilon);
    fmt::print("{:<11} {}\n", "PSNR of Y", describe_psnr(d.psnr));
    print_mean("mean XYZ, A", d.mean_xyz_a);
    print_mean("mean XYZ, B", d.mean_xyz_b);
    fmt::print("{:<11} {}\n", "pixels", d.pixels);
}

void print_json(const ImageDifference& d) {
    const nlohmann::ordered_json object{{"rmse", d.rmse},
                                        {"relmse", d.rel_mse},
                                        {"psnr", d.psnr},
                                        {"mean_xyz_a", d.mean_xyz_a},
                                        {"mean_xyz_b", d.mean_xyz_b},
                                        {"pixels", d.pixels}};
    fmt::print("{}\n", object.dump(2));
}

void compare(const CompareOptions& options) {
    const Region region = options.region.empty() ? Region{} : parse_region(options.region);
    const XyzImage a = read_exr(options.a);
    const XyzImage b = read_exr(options.b);
    const ImageDifference difference = options.region.empty() ? compare_images(a, b) : compare_images(a, b, region);
    options.json ? print_json(difference) : print_table(difference);
}

} // namespace

void add_compare_command(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("compare", "Error of image A against reference B: RMSE in XYZ, relMSE, PSNR");
    const auto options = std::make_shared<CompareOptions>();
    command->add_option("a", options->a, "Image (EXR with channels R, G, B in linear sRGB, or X, Y, Z)")
        ->required()
        ->type_name("A.exr");
    command->add_option("b", options->b, "Reference")->required()->type_name("B.exr");
    command->add_option("--region", options->region, "Compare only pixels X0 <= x < X1, Y0 <= y < Y1 [all]")
        ->type_name("X0,Y0,X1,Y1");
    command->add_flag("--json", options->json,
                      "Print a JSON object; psnr is null where it is infinite (equal Y) or B is black");
    command->callback([options] { compare(*options); });
}

} // namespace tristim
