// Parameters of solvers. A ParameterSpec declares the type, unit and default of one parameter. An Options object checks
// the values that the user gives; the solver's constructor then reads them by name.
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
    ParameterValue default_value;  // its type is the type of the parameter
    std::string unit = {};         // empty: none
    std::string paper_value = {};  // as printed in the paper; empty: the paper has no such parameter
    std::string description;
    std::vector<std::string> choices = {};  // allowed values of a string; empty: any
    double least = -1e300, most = 1e300;    // for numbers: the allowed range, ends included
    // For strings: checks a value. Returns an error message to print after the value, or an empty string if the value
    // is valid. A parameter whose default is not valid must be given by the user.
    std::string (*problem)(const std::string& value) = nullptr;
    // For strings: the value is a shell command. If a file that the command names changes, earlier results of the
    // command are not reused.
    bool command = false;

    // Returns whether `problem` rejects the default, so that the user must give a value.
    bool required() const;
};

using ParameterMap = std::map<std::string, ParameterValue>;

// The values of all parameters of one solver: the values given by the user, and defaults for the rest.
class Options {
public:
    // Checks the values that the user gave, and adds the defaults. Throws InputError for an unknown name, an invalid
    // value, or a missing required parameter. An integer is accepted for a real parameter. Relative paths in values
    // start at `folder`, an absolute path, or at the current folder if `folder` is empty.
    Options(std::string_view solver, const std::vector<ParameterSpec>& specs, const ParameterMap& given,
            std::filesystem::path folder = {});

    // Return the value of a parameter. Throw std::logic_error if it was not declared or has another type.
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
