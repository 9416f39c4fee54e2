// The registry of methods in host/render/method.h: names, counts, and that every sampler is where the kernels find it.

#include "base/embedded_files.h"
#include "render/method.h"
#include "scene_folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cctype>
#include <map>
#include <regex>
#include <set>
#include <string>

namespace tristim::test {
namespace {

TEST(MethodNames, ParseAndPrintTheirNames) {
    for (const MethodKind& kind : method_kinds()) {
        for (const int count : {kind.least, (kind.least + kind.most) / 2, kind.most}) {
            const std::string text = kind.count_name == nullptr ? kind.name : fmt::format("{}:{}", kind.name, count);
            const Method method = parse_method(text);
            EXPECT_EQ(method.kind, kind.kind) << text;
            EXPECT_EQ(method.count, count) << text;
            EXPECT_EQ(method.name(), text);
            EXPECT_EQ(method.wavelengths(), count * kind.wavelengths) << text;
            EXPECT_EQ(method.unbiased(), kind.unbiased) << text;
            const WavelengthLayout layout = wavelength_layout(method);
            EXPECT_EQ(layout.w, method.wavelengths()) << text;
            EXPECT_GE(layout.padded(), layout.w) << text;
            EXPECT_LT(layout.padded() - layout.lanes, layout.w) << text << ": a block too many";
        }
    }
}

TEST(MethodNames, HaveNamesOfTheirOwnAndSayWhatTheyAre) {
    std::set<std::string> names;
    std::set<Method::Kind> kinds;
    for (const MethodKind& kind : method_kinds()) {
        EXPECT_TRUE(names.insert(kind.name).second) << kind.name;
        EXPECT_TRUE(kinds.insert(kind.kind).second) << kind.name;
        EXPECT_FALSE(std::string(kind.summary).empty()) << kind.name;
        EXPECT_FALSE(std::string(kind.source).empty()) << kind.name;
    }
}

void expect_refused(const std::string& text, const std::string& words) {
    const std::string message = error_of([&] { parse_method(text); });
    expect_message(message, "", fmt::format("'{}'", text));
    expect_message(message, "", words);
}

TEST(MethodNames, RefuseCountsOutOfRange) {
    for (const MethodKind& kind : method_kinds()) {
        const std::string name = kind.name;
        if (kind.count_name == nullptr) {
            expect_refused(name + ":", "nothing may follow " + name);
            expect_refused(fmt::format("{}:{}", name, kind.most), "nothing may follow " + name);
            continue;
        }
        const std::string pattern = fmt::format("{}:{}", name, kind.count_name);
        for (const std::string& end :
             {std::string(), std::string(":"), std::string(":0"), std::string(":-1"), std::string(":x"),
              std::string(":4x"), std::string(": 4"), std::string(":4:4"), std::string(":4.0"),
              std::string(":99999999999"), fmt::format(":{}", kind.least - 1), fmt::format(":{}", kind.most + 1)})
            expect_refused(name + end, pattern);
        if (kind.least < kind.most) {
            const std::string range = fmt::format("from {} to {}", kind.least, kind.most);
            expect_refused(fmt::format("{}:{}", name, kind.most + 1), range);
        }
    }
}

TEST(MethodNames, RefuseUnknownNamesWithAllThatThereAre) {
    for (const std::string text : {"", ":", ":4", "Hero:4", "hero 4", "heros:4", " hero:4", "xyz", "4", "auto:4"}) {
        for (const MethodKind& kind : method_kinds())
            expect_refused(text, kind.name);
    }
}

std::string embedded(const std::string& path) {
    const auto found = embedded_files().find(path);
    return found == embedded_files().end() ? "" : std::string(found->second);
}

/// From name to value of "#define SAMPLER_… value" in kernels/config.h.
std::map<std::string, std::string> sampler_macros() {
    std::map<std::string, std::string> macros;
    const std::string config = embedded("kernels/config.h");
    const std::regex definition("#define (SAMPLER_[A-Z_]+) (\\S+)");
    for (std::sregex_iterator match(config.begin(), config.end(), definition), end; match != end; ++match)
        macros[match->str(1)] = match->str(2);
    return macros;
}

/// A sampler is a macro with a number of its own, a file, and two lines in wavelengths.cl that join them.
TEST(MethodNames, SamplersAreAllInTheKernels) {
    const std::map<std::string, std::string> macros = sampler_macros();
    const std::string kernel = embedded("kernels/wavelengths.cl");
    std::set<std::string> used, numbers, files;
    for (const MethodKind& kind : method_kinds()) {
        const std::string sampler = kind.sampler;
        used.insert(sampler);
        EXPECT_EQ(macros.count(sampler), 1U) << sampler << " is not in kernels/config.h";
        std::string file = sampler.substr(std::string("SAMPLER_").size()) + ".h";
        for (char& c : file)
            c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        files.insert("kernels/samplers/" + file);
        EXPECT_NE(embedded("kernels/samplers/" + file).find("float sample_wavelength("), std::string::npos) << file;
        EXPECT_NE(kernel.find(fmt::format("if SAMPLER == {}\n#include \"samplers/{}\"\n", sampler, file)),
                  std::string::npos)
            << file << " is not in kernels/wavelengths.cl";
    }
    for (const auto& [name, number] : macros) {
        EXPECT_EQ(used.count(name), 1U) << name << " belongs to no method";
        EXPECT_TRUE(numbers.insert(number).second) << name << " shares its number with another sampler";
    }
    for (const auto& [path, text] : embedded_files()) {
        if (path.rfind("kernels/samplers/", 0) == 0) {
            EXPECT_EQ(files.count(path), 1U) << path << " belongs to no method";
        }
    }
}

} // namespace
} // namespace tristim::test
