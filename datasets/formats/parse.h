// Lines, words and numbers, for the readers of files; private to datasets/.
#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace hausbench::readers {

// Throws InputError: "NAME: line 3: WHY".
[[noreturn]] void refuse(const std::string& name, std::uint32_t line, const std::string& why);

// Returns a word of a file for a message: its first 40 characters, on one line.
std::string shown(std::string_view word);

std::string lower_case(std::string_view text);  // changes only ASCII letters

constexpr std::string_view blanks = " \t\r\v\f";
std::string_view trimmed(std::string_view text);

// Removes the next word from `line` and returns it; empty at the end.
std::string_view next_word(std::string_view& line);

// Removes the first line, up to \n, \r\n or \r (old Macs), from `bytes` and returns it without the line end.
std::string_view next_line(std::string_view& bytes);

// Returns the double or float nearest to a decimal number; infinity if the number is too large. Returns nothing if the
// text is not a number.
template <class Real = double> std::optional<Real> decimal(std::string_view text);

// Returns an integer, or nothing if the text is not an integer or the integer does not fit the type.
template <class Integer> std::optional<Integer> whole(std::string_view text) {
    Integer value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

// The binary form of a number in a file: F(loat), I(nteger) or U(nsigned), as PCD calls them, with 1, 2, 4 or 8 bytes.
struct Stored {
    char kind = 'F';
    std::uint64_t size = 4;

    bool readable() const;  // whether value() can read it
    bool is_float32() const { return kind == 'F' && size == 4; }
    bool holds(double value) const;      // whether an integer type has this value; true for 'F'
    double value(const char* at) const;  // of the bytes at this address, in this machine's byte order
};

}  // namespace hausbench::readers
