// Errors that the user can correct. Each message is one line that says where the error is, what is wrong, and how to
// correct it.
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

// Returns a hint to append to an error about an unknown name: " (did you mean 'x'?)" if a candidate is similar to
// `wrong`, and otherwise " (known: a, b, c)" with the first 40 candidates. Returns an empty string if there are no
// candidates.
std::string nearest_hint(std::string_view wrong, const std::vector<std::string>& candidates);

// Returns text from outside this program as one line of at most 1000 bytes that is safe to print (see printable()).
std::string one_line(std::string text);

}  // namespace hausbench
