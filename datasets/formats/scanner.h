// Reads numbers one after the other, as text or binary; private to datasets/. For formats that store the same numbers in
// the same order in both forms.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace hausbench::readers {

class Scanner {
public:
    // `comment` starts a comment up to the end of the line, at the start of a word of text; '\0': there are none.
    Scanner(const std::string& name, std::string_view bytes, char comment = '\0')
        : name_(name), bytes_(bytes), comment_(comment) {}

    void set_binary(bool swapped) { binary_ = true, swapped_ = swapped; }  // swapped: of the other byte order
    bool binary() const { return binary_; }

    std::size_t at() const { return at_; }
    std::size_t left() const { return bytes_.size() - at_; }
    void move_to(std::size_t position) { at_ = position; }  // in a binary file, which has no lines
    // The line of the last word, from 1; 0 in a binary file.
    std::uint32_t line() const { return binary_ ? 0 : line_; }

    // Throws InputError that names the line of the last word, or the position of the last binary number.
    [[noreturn]] void refuse(const std::string& why) const;

    // The next word of text, whatever the form of the numbers. Empty at the end.
    std::string_view word();
    std::string_view peek();
    std::string_view rest_of_line();      // and moves to the start of the next line
    bool skip_to(std::string_view text);  // moves to the next occurrence of a text; false if there is none

    // The next number. In a binary file it takes `size` bytes; a text of size 4 is rounded to float. `what` names the
    // number in messages, such as "a coordinate of a vertex".
    std::int64_t integer(std::size_t size, std::string_view what);
    double real(std::size_t size, std::string_view what);

    // Reads a number of items. Throws InputError if the rest of the file is too small for so many, each of which takes
    // at least `numbers` numbers in text and `bytes` bytes in binary.
    std::uint64_t count(std::size_t size, std::string_view what, std::uint64_t numbers, std::uint64_t bytes);
    void check_count(std::int64_t count, std::string_view what, std::uint64_t numbers, std::uint64_t bytes) const;

    // The last number as text, for messages; empty in a binary file.
    std::string_view last_word() const { return last_; }

private:
    void skip_blanks();
    const char* take(std::size_t size, std::string_view what);

    const std::string& name_;
    std::string_view bytes_, last_;
    char comment_;
    bool binary_ = false, swapped_ = false;
    std::size_t at_ = 0;
    std::size_t number_at_ = 0;  // the position of the last binary number
    std::uint32_t line_ = 1;
    char buffer_[8] = {};
};

}  // namespace hausbench::readers
