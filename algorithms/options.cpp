#include "algorithms/options.h"

#include "algorithms/error.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace hausbench {
namespace {

std::string type_name(const ParameterValue& value) {
    constexpr const char* names[] = {"true or false", "an integer", "a number", "a text"};
    return names[value.index()];
}

// Returns a value that the user gave, after checking it. An integer that was given for a real parameter is converted to
// double.
ParameterValue checked(std::string_view solver, const ParameterSpec& spec, const ParameterValue& value) {
    const std::string where = fmt::format("solver '{}', parameter '{}'", solver, spec.name);
    ParameterValue result = value;
    if (std::holds_alternative<double>(spec.default_value) && std::holds_alternative<std::int64_t>(value)) {
        result = static_cast<double>(std::get<std::int64_t>(value));
    }
    if (result.index() != spec.default_value.index()) {
        const std::string example = to_string(spec.default_value);
        throw InputError(fmt::format("{}: {} is not {}; give {}{}", where, to_string(value),
                                     type_name(spec.default_value), type_name(spec.default_value),
                                     example.empty() ? "" : fmt::format(", as the default {} is", example)));
    }
    double number = 0;
    if (const auto* integer = std::get_if<std::int64_t>(&result)) number = static_cast<double>(*integer);
    if (const auto* real = std::get_if<double>(&result)) number = *real;
    if (!(spec.least <= number && number <= spec.most) && result.index() != 0 && result.index() != 3) {
        throw InputError(fmt::format("{}: {} is outside [{}, {}]; give a value inside", where, to_string(result),
                                     spec.least, spec.most));
    }
    if (const auto* text = std::get_if<std::string>(&result); text && !spec.choices.empty()) {
        if (std::find(spec.choices.begin(), spec.choices.end(), *text) == spec.choices.end()) {
            throw InputError(
                fmt::format("{}: '{}' is not one of its choices{}", where, *text, nearest_hint(*text, spec.choices)));
        }
    }
    if (const auto* text = std::get_if<std::string>(&result); text && spec.problem) {
        if (const std::string problem = spec.problem(*text); !problem.empty()) {
            throw InputError(fmt::format("{}: '{}' {}", where, *text, problem));
        }
    }
    return result;
}

}  // namespace

std::string to_string(const ParameterValue& value) {
    if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
    if (const auto* integer = std::get_if<std::int64_t>(&value)) return fmt::format("{}", *integer);
    if (const auto* real = std::get_if<double>(&value)) return fmt::format("{}", *real);
    return std::get<std::string>(value);
}

bool ParameterSpec::required() const {
    const auto* text = std::get_if<std::string>(&default_value);
    return text && problem && !problem(*text).empty();
}

Options::Options(std::string_view solver, const std::vector<ParameterSpec>& specs, const ParameterMap& given,
                 std::filesystem::path folder)
    : solver_(solver), folder_(std::move(folder)) {
    std::vector<std::string> names;
    for (const ParameterSpec& spec : specs) {
        names.push_back(spec.name);
        values_[spec.name] = spec.default_value;
    }
    for (const auto& [key, value] : given) {
        const std::string& name = key;
        const auto spec =
            std::find_if(specs.begin(), specs.end(), [&](const ParameterSpec& s) { return s.name == name; });
        if (spec == specs.end()) {
            const std::string hint = names.empty() ? " (it has none)" : nearest_hint(name, names);
            throw InputError(fmt::format("solver '{}' has no parameter '{}'{}", solver, name, hint));
        }
        values_[name] = checked(solver, *spec, value);
    }
    for (const ParameterSpec& spec : specs) {
        if (!given.contains(spec.name) && spec.required()) {
            throw InputError(
                fmt::format("solver '{}' needs its parameter '{}': {}", solver, spec.name, spec.description));
        }
    }
}

template <class T> const T& Options::get(const std::string& name) const {
    const auto entry = values_.find(name);
    if (entry == values_.end())
        throw std::logic_error("solver '" + solver_ + "' reads undeclared parameter '" + name + "'");
    const T* value = std::get_if<T>(&entry->second);
    if (!value) throw std::logic_error("solver '" + solver_ + "' reads parameter '" + name + "' as another type");
    read_.insert(name);
    return *value;
}

bool Options::flag(const std::string& name) const { return get<bool>(name); }
std::int64_t Options::integer(const std::string& name) const { return get<std::int64_t>(name); }
double Options::real(const std::string& name) const { return get<double>(name); }
std::string Options::text(const std::string& name) const { return get<std::string>(name); }

std::vector<std::string> Options::unread() const {
    std::vector<std::string> names;
    for (const auto& [name, value] : values_) {
        if (!read_.contains(name)) names.push_back(name);
    }
    return names;
}

}  // namespace hausbench
