#include "datasets/formats/scanner.h"

#include "algorithms/error.h"
#include "datasets/formats/parse.h"

#include <fmt/format.h>

#include <algorithm>

namespace hausbench::readers {
namespace {

bool is_blank(char c) { return c == '\n' || blanks.find(c) != std::string_view::npos; }

std::string shown_or_end(std::string_view word) {
    return word.empty() ? "the end of the file" : fmt::format("'{}'", shown(word));
}

}  // namespace

void Scanner::refuse(const std::string& why) const {
    if (!binary_) readers::refuse(name_, line_, why);
    throw InputError(fmt::format("{}: at byte {}: {}", name_, number_at_, why));
}

void Scanner::skip_blanks() {
    while (at_ < bytes_.size()) {
        const char c = bytes_[at_];
        if (comment_ != '\0' && c == comment_) {
            while (at_ < bytes_.size() && bytes_[at_] != '\n' && bytes_[at_] != '\r') ++at_;
            continue;
        }
        if (!is_blank(c)) return;
        ++at_;
        const bool ends_line = c == '\n' || (c == '\r' && (at_ == bytes_.size() || bytes_[at_] != '\n'));
        line_ += ends_line ? 1 : 0;
    }
}

std::string_view Scanner::word() {
    skip_blanks();
    number_at_ = at_;
    const std::size_t start = at_;
    while (at_ < bytes_.size() && !is_blank(bytes_[at_])) ++at_;
    return bytes_.substr(start, at_ - start);
}

std::string_view Scanner::peek() {
    skip_blanks();
    const std::size_t start = at_;
    const std::string_view next = word();
    at_ = start;
    return next;
}

std::string_view Scanner::rest_of_line() {
    std::string_view rest = bytes_.substr(at_);
    const std::string_view line = next_line(rest);
    at_ = bytes_.size() - rest.size();
    ++line_;
    return line;
}

bool Scanner::skip_to(std::string_view text) {
    const std::size_t where = bytes_.find(text, at_);
    if (where == std::string_view::npos) return false;
    if (!binary_)
        line_ += static_cast<std::uint32_t>(std::count(bytes_.begin() + static_cast<std::ptrdiff_t>(at_),
                                                       bytes_.begin() + static_cast<std::ptrdiff_t>(where), '\n'));
    at_ = where;
    return true;
}

const char* Scanner::take(std::size_t size, std::string_view what) {
    number_at_ = at_;
    if (left() < size) refuse(fmt::format("expected {}, found the end of the file: it is truncated", what));
    std::copy_n(bytes_.data() + at_, size, buffer_);
    if (swapped_) std::reverse(buffer_, buffer_ + size);
    at_ += size;
    return buffer_;
}

std::int64_t Scanner::integer(std::size_t size, std::string_view what) {
    if (binary_) {
        // Stored::value() returns a double, which does not hold all integers of 8 bytes.
        const char* const bytes = take(size, what);
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < size; ++i) value |= std::uint64_t{static_cast<unsigned char>(bytes[i])} << (8 * i);
        return size == 4 ? static_cast<std::int32_t>(static_cast<std::uint32_t>(value))
                         : static_cast<std::int64_t>(value);
    }
    last_ = word();
    const auto value = whole<std::int64_t>(last_);
    if (!value) refuse(fmt::format("expected {}, found {}", what, shown_or_end(last_)));
    return *value;
}

double Scanner::real(std::size_t size, std::string_view what) {
    if (binary_) return Stored{'F', size}.value(take(size, what));
    last_ = word();
    const auto value = size == 4 ? std::optional<double>(decimal<float>(last_)) : decimal(last_);
    if (!value) refuse(fmt::format("expected {}, found {}", what, shown_or_end(last_)));
    return *value;
}

void Scanner::check_count(std::int64_t count, std::string_view what, std::uint64_t numbers, std::uint64_t bytes) const {
    if (count < 0) refuse(fmt::format("announces {} {}", count, what));
    // In text, a number takes a character and a blank, which the last may lack.
    const std::uint64_t each = std::max<std::uint64_t>(binary_ ? bytes : 2 * numbers, 1);
    if (static_cast<std::uint64_t>(count) > (left() + 1) / each)
        refuse(fmt::format("announces {} {}, but the rest of the file has {} bytes: it is truncated or damaged", count,
                           what, left()));
}

std::uint64_t Scanner::count(std::size_t size, std::string_view what, std::uint64_t numbers, std::uint64_t bytes) {
    const std::int64_t value = integer(size, fmt::format("the number of {}", what));
    check_count(value, what, numbers, bytes);
    return static_cast<std::uint64_t>(value);
}

}  // namespace hausbench::readers
