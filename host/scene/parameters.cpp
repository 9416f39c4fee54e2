#include "scene/parameters.h"

#include <algorithm>

namespace tristim {

void ParameterList::add(Parameter parameter) {
    if (has(parameter.name))
        fail_at(parameter.where, "the parameter \"{}\" of {} is given twice", parameter.name, owner_);
    parameters_.push_back(std::move(parameter));
}

const Parameter* ParameterList::find(const std::string& name) const {
    const auto it =
        std::find_if(parameters_.begin(), parameters_.end(), [&](const Parameter& p) { return p.name == name; });
    return it == parameters_.end() ? nullptr : &*it;
}

Parameter* ParameterList::find(const std::string& name) {
    return const_cast<Parameter*>(static_cast<const ParameterList*>(this)->find(name));
}

bool ParameterList::has(const std::string& name) const {
    return find(name) != nullptr;
}

SourceLocation ParameterList::where(const std::string& name) const {
    const Parameter* parameter = find(name);
    return parameter ? parameter->where : where_;
}

bool ParameterList::is_type(const std::string& name, const std::string& type) const {
    const Parameter* parameter = find(name);
    return parameter && parameter->type == type;
}

Parameter* ParameterList::typed(const std::string& name, std::initializer_list<const char*> types) {
    Parameter* parameter = find(name);
    if (!parameter)
        return nullptr;
    if (parameter->type == "texture")
        fail_at(parameter->where, "the parameter \"{}\" of {} is a texture, and only \"filmthickness\" may be one",
                name, owner_);
    if (std::find(types.begin(), types.end(), parameter->type) == types.end())
        fail_at(parameter->where, "the parameter \"{}\" of {} has type \"{}\" where \"{}\" is expected", name, owner_,
                parameter->type, *types.begin());
    parameter->used = true;
    return parameter;
}

namespace {

template <typename T>
const T& single(const Parameter& parameter, const std::vector<T>& values) {
    if (values.size() != 1)
        fail_at(parameter.where, "the parameter \"{}\" takes one value, but {} are given", parameter.name,
                values.size());
    return values.front();
}

} // namespace

double ParameterList::number(const std::string& name, double fallback) {
    const Parameter* parameter = typed(name, {"float"});
    return parameter ? single(*parameter, parameter->numbers) : fallback;
}

int ParameterList::integer(const std::string& name, int fallback) {
    const Parameter* parameter = typed(name, {"integer"});
    return parameter ? static_cast<int>(single(*parameter, parameter->numbers)) : fallback;
}

bool ParameterList::boolean(const std::string& name, bool fallback) {
    const Parameter* parameter = typed(name, {"bool"});
    if (!parameter)
        return fallback;
    if (parameter->bools.size() != 1)
        fail_at(parameter->where, "the parameter \"{}\" takes one value, but {} are given", name,
                parameter->bools.size());
    return parameter->bools.front();
}

std::string ParameterList::text(const std::string& name, const std::string& fallback) {
    const Parameter* parameter = typed(name, {"string"});
    return parameter ? single(*parameter, parameter->strings) : fallback;
}

V3d ParameterList::point(const std::string& name, const V3d& fallback) {
    return single_triple(name, points(name), fallback);
}

V3d ParameterList::vector(const std::string& name, const V3d& fallback) {
    return single_triple(name, triples(name, {"vector3"}), fallback);
}

V3d ParameterList::single_triple(const std::string& name, const std::vector<V3d>& values, const V3d& fallback) const {
    if (values.size() > 1)
        fail_at(where(name), "the parameter \"{}\" takes three numbers, but {} are given", name, 3 * values.size());
    return values.empty() ? fallback : values.front();
}

std::string ParameterList::texture(const std::string& name) {
    if (!is_type(name, "texture"))
        return {};
    Parameter* parameter = find(name);
    parameter->used = true;
    const std::string& texture = single(*parameter, parameter->strings);
    if (texture.empty())
        fail_at(parameter->where, "the parameter \"{}\" of {} names no texture", name, owner_);
    return texture;
}

std::vector<std::string> ParameterList::texts(const std::string& name) {
    const Parameter* parameter = typed(name, {"string"});
    return parameter ? parameter->strings : std::vector<std::string>{};
}

std::vector<double> ParameterList::numbers(const std::string& name) {
    const Parameter* parameter = typed(name, {"float"});
    return parameter ? parameter->numbers : std::vector<double>{};
}

std::vector<int> ParameterList::integers(const std::string& name) {
    std::vector<int> result;
    if (const Parameter* parameter = typed(name, {"integer"}))
        std::transform(parameter->numbers.begin(), parameter->numbers.end(), std::back_inserter(result),
                       [](double value) { return static_cast<int>(value); });
    return result;
}

std::vector<V3d> ParameterList::points(const std::string& name) {
    return triples(name, {"point3"});
}

std::vector<V3d> ParameterList::normals(const std::string& name) {
    return triples(name, {"normal", "normal3"});
}

std::vector<V2d> ParameterList::points2(const std::string& name) {
    std::vector<V2d> result;
    const Parameter* parameter = typed(name, {"point2"});
    if (!parameter)
        return result;
    const std::vector<double>& values = parameter->numbers;
    if (values.empty() || values.size() % 2 != 0)
        fail_at(parameter->where, "the parameter \"{}\" takes pairs of numbers, but {} are given", name, values.size());
    for (std::size_t i = 0; i < values.size(); i += 2)
        result.emplace_back(values[i], values[i + 1]);
    return result;
}

std::vector<V3d> ParameterList::triples(const std::string& name, std::initializer_list<const char*> types) {
    std::vector<V3d> result;
    const Parameter* parameter = typed(name, types);
    if (!parameter)
        return result;
    const std::vector<double>& numbers = parameter->numbers;
    if (numbers.empty() || numbers.size() % 3 != 0)
        fail_at(parameter->where, "the parameter \"{}\" takes groups of three numbers, but {} are given", name,
                numbers.size());
    for (std::size_t i = 0; i < numbers.size(); i += 3)
        result.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
    return result;
}

const Parameter* ParameterList::spectrum(const std::string& name) {
    return typed(name, {"spectrum", "rgb", "blackbody"});
}

bool ParameterList::ignore(const std::string& name) {
    Parameter* parameter = find(name);
    if (parameter)
        parameter->used = true;
    return parameter != nullptr;
}

void ParameterList::ignore_rest() {
    for (Parameter& parameter : parameters_)
        parameter.used = true;
}

void ParameterList::finish() const {
    for (const Parameter& parameter : parameters_) {
        if (!parameter.used)
            fail_at(parameter.where, "{} has no parameter \"{}\" here, or it is not supported", owner_, parameter.name);
    }
}

} // namespace tristim
