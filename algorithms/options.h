// Parameters of solvers. A ParameterSpec declares one with type, unit and default. An Options object checks the values
// that a user gives; the solver's constructor then reads them by name.
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

// The declaration of one parameter.
struct ParameterSpec {
    std::string name;
    ParameterValue default_value;  // the alternative that it holds is the type of the parameter
    std::string unit = {};         // empty: none
    std::string paper_value = {};  // as printed in the paper; empty: the paper has no such parameter
    std::string description;
    std::vector<std::string> choices = {};  // allowed values of a string; empty: any
    double least = -1e300, most = 1e300;    // for numbers: the allowed range, ends included
    // For strings: checks a value. Returns the error, to be printed after the value, and how to correct it; or an empty
    // string if the value is valid. If it rejects the default value, the user must give the parameter.
    std::string (*problem)(const std::string& value) = nullptr;
    // For strings: the value is a shell command. The contents of the files that it names are then part of the identity
    // of a case, so results are measured again after a file has changed.
    bool command = false;

    // Returns whether the user must give the parameter; see `problem`.
    bool required() const;
};

using ParameterMap = std::map<std::string, ParameterValue>;

// The values of all parameters of one solver: the values given by the user, and defaults for the rest.
class Options {
public:
    // Throws InputError for an unknown name, a wrong type, a value outside the range or the choices, a value that
    // `problem` rejects, or a missing required parameter. An integer is accepted for a real parameter. Relative paths
    // in the values are relative to `folder`, which must be absolute, or to the current folder if `folder` is empty.
    Options(std::string_view solver, const std::vector<ParameterSpec>& specs, const ParameterMap& given,
            std::filesystem::path folder = {});

    // Return a value by name. Throw std::logic_error for a name that was not declared or is of another type.
    bool flag(const std::string& name) const;
    std::int64_t integer(const std::string& name) const;
    double real(const std::string& name) const;
    std::string text(const std::string& name) const;

    const ParameterMap& values() const { return values_; }
    const std::filesystem::path& folder() const { return folder_; }

    // Returns the names of the parameters that have not been read yet. A solver's constructor must read all of them, so
    // that no parameter is declared without effect.
    std::vector<std::string> unread() const;

private:
    template <class T> const T& get(const std::string& name) const;

    std::string solver_;
    ParameterMap values_;
    std::filesystem::path folder_;
    mutable std::set<std::string> read_;
};

}  // namespace hausbench
