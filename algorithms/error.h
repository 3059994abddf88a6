// Errors that a user can fix: one line that names the file or key, the place in it, and the remedy.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace hausbench {

// An error that ends the program with exit code 2 and its message on standard error.
class InputError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

// Returns " (did you mean 'x'?)" for the candidate nearest to `wrong` by edit distance, else " (known: a, b, c)".
std::string nearest_hint(std::string_view wrong, const std::vector<std::string>& candidates);

// Returns untrusted text as one line of at most 1000 characters; control characters become spaces.
std::string one_line(std::string text);

}  // namespace hausbench
