// Solver parameters: declared with type, unit, default and the paper's value; checked when given; read by name.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace hausbench {

using ParameterValue = std::variant<bool, std::int64_t, double, std::string>;

std::string to_string(const ParameterValue& value);

struct ParameterSpec {
    std::string name;
    ParameterValue default_value;  // its alternative is the parameter's type
    std::string unit = {};         // empty: none
    std::string paper_value = {};  // as printed in the paper; empty: the paper has no such parameter
    std::string description;
    std::vector<std::string> choices = {};  // allowed values of a string; empty: any
    double least = -1e300, most = 1e300;    // for numbers: the allowed range, ends included
    // For strings: returns the error in a value with its remedy, or empty. A parameter with an invalid default is required.
    std::string (*problem)(const std::string& value) = nullptr;
    // For strings: a shell command, whose programs and files belong to the identity of a case.
    bool command = false;

    bool required() const;
};

using ParameterMap = std::map<std::string, ParameterValue>;

// The parameter values of one solver; every declared parameter has one.
class Options {
public:
    // Throws InputError for an unknown name, a wrong type, a value outside the range or the choices, a value for
    // which `problem` returns a text, or a missing required parameter. Relative paths in the values are relative to
    // `folder`, which is absolute; if it is empty, to the current folder.
    Options(std::string_view solver, const std::vector<ParameterSpec>& specs, const ParameterMap& given,
            std::filesystem::path folder = {});

    // Return a value by name. Throw std::logic_error for a name that was not declared or is of another type.
    bool flag(const std::string& name) const;
    std::int64_t integer(const std::string& name) const;
    double real(const std::string& name) const;
    std::string text(const std::string& name) const;

    const ParameterMap& values() const { return values_; }
    const std::filesystem::path& folder() const { return folder_; }

    // Returns the declared parameters that have not been read yet; a solver's constructor must read all.
    std::vector<std::string> unread() const;

private:
    template <class T> const T& get(const std::string& name) const;

    std::string solver_;
    ParameterMap values_;
    std::filesystem::path folder_;
    mutable std::set<std::string> read_;
};

}  // namespace hausbench
