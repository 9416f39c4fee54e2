#include "films/film_report.h"

#include <fmt/format.h>
#include <iterator>
#include <nlohmann/json.hpp>

namespace tristim {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Xyz& xyz) {
    const DisplayColour shown = display_colour(xyz);
    const auto xy = chromaticity(xyz);
    return {{"XYZ", xyz},
            {"xy", xy ? Json(*xy) : Json(nullptr)},
            {"sRGB", shown.rgb},
            {"hex", shown.hex()},
            {"clipped", shown.clipped}};
}

Json json_of(const FilmStack& stack) {
    Json layers = Json::array();
    for (const StackLayer& layer : stack.layers)
        layers.push_back({{"index", layer.name}, {"thickness_nm", layer.thickness}});
    return {{"outside", stack.outside.name}, {"layers", layers}, {"base", stack.base.name}};
}

std::string csv_colour(const Xyz& xyz) {
    const DisplayColour shown = display_colour(xyz);
    const auto xy = chromaticity(xyz);
    const std::string xy_text = xy ? fmt::format("{:.9g},{:.9g}", (*xy)[0], (*xy)[1]) : ",";
    return fmt::format("{:.9g},{:.9g},{:.9g},{},{},{}", xyz[0], xyz[1], xyz[2], xy_text, shown.hex(),
                       shown.clipped ? 1 : 0);
}

} // namespace

std::string FilmReport::title() const {
    if (!swept_layer)
        return stack.description();
    std::string text = stack.outside.name;
    for (std::size_t i = 0; i < stack.layers.size(); ++i) {
        const StackLayer& layer = stack.layers[i];
        if (i == *swept_layer)
            text += fmt::format(" | {} {} to {} nm", layer.name, thicknesses_nm.front(), thicknesses_nm.back());
        else
            text += fmt::format(" | {} {} nm", layer.name, layer.thickness);
    }
    return text + " | " + stack.base.name;
}

// Nine digits tell any two floats apart.
std::string film_csv(const FilmReport& report) {
    std::string text;
    const auto out = std::back_inserter(text);
    if (report.swept_layer) {
        text += "thickness_nm,angle_deg,X_R,Y_R,Z_R,x_R,y_R,sRGB_R,clipped_R,X_T,Y_T,Z_T,x_T,y_T,sRGB_T,clipped_T\n";
        for (const FilmColourRow& row : report.colours)
            fmt::format_to(out, "{:.10g},{:.10g},{},{}\n", row.thickness_nm, row.angle_deg,
                           csv_colour(row.colour.reflected), csv_colour(row.colour.transmitted));
        return text;
    }
    text += "wavelength_nm,angle_deg,R_s,R_p,R,T_s,T_p,T\n";
    for (const FilmSpectrumRow& row : report.spectrum) {
        const FilmResponse& r = row.response;
        fmt::format_to(out, "{:.10g},{:.10g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}\n", row.wavelength_nm,
                       row.angle_deg, r.reflected_s, r.reflected_p, r.reflected(), r.transmitted_s, r.transmitted_p,
                       r.transmitted());
    }
    return text;
}

std::string film_json(const FilmReport& report) {
    Json object{{"stack", json_of(report.stack)},
                {"illuminant", report.illuminant},
                {"white", json_of(report.white)},
                {"device", report.device},
                {"math", report.math},
                {"version", TRISTIM_VERSION}};
    if (report.swept_layer)
        object["swept_layer"] = *report.swept_layer + 1;
    else
        object["spectrum"] = Json::array();
    for (const FilmSpectrumRow& row : report.spectrum) {
        const FilmResponse& r = row.response;
        object["spectrum"].push_back({{"wavelength_nm", row.wavelength_nm},
                                      {"angle_deg", row.angle_deg},
                                      {"R_s", r.reflected_s},
                                      {"R_p", r.reflected_p},
                                      {"R", r.reflected()},
                                      {"T_s", r.transmitted_s},
                                      {"T_p", r.transmitted_p},
                                      {"T", r.transmitted()}});
    }
    object["colours"] = Json::array();
    for (const FilmColourRow& row : report.colours) {
        Json colour{{"angle_deg", row.angle_deg}};
        if (report.swept_layer)
            colour["thickness_nm"] = row.thickness_nm;
        colour["reflected"] = json_of(row.colour.reflected);
        colour["transmitted"] = json_of(row.colour.transmitted);
        object["colours"].push_back(std::move(colour));
    }
    return object.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

} // namespace tristim
