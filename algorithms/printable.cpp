#include "algorithms/printable.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace hausbench {
namespace {

// The first character of a UTF-8 text: its code point and its length in bytes. The length is 0 if the text does not
// begin with a valid character.
struct Character {
    char32_t number = 0;
    std::size_t length = 0;
};

Character first_character(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned char lead = byte(0);
    if (lead < 0x80) return {lead, 1};
    const std::size_t length = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
    if (lead < 0xc2 || lead > 0xf4 || text.size() < length) return {};
    char32_t number = lead & (0xffu >> (length + 1));
    for (std::size_t i = 1; i < length; ++i) {
        if ((byte(i) & 0xc0) != 0x80) return {};
        number = number << 6 | (byte(i) & 0x3fu);
    }
    constexpr std::array<char32_t, 5> least = {0, 0, 0x80, 0x800, 0x10000};
    const bool surrogate = number >= 0xd800 && number < 0xe000;
    return number < least[length] || surrogate || number > 0x10ffff ? Character{} : Character{number, length};
}

bool is_control(char32_t c) { return c < 0x20 || (c >= 0x7f && c < 0xa0) || c == 0x2028 || c == 0x2029; }

// Returns whether the character is invisible: it has no width or only sets the direction of writing. Names that differ
// only in such characters look the same.
bool is_hidden(char32_t c) {
    return c == 0x61c || (c >= 0x200b && c <= 0x200f) || (c >= 0x202a && c <= 0x202e) || (c >= 0x2060 && c <= 0x2069) ||
           c == 0xfeff || (c >= 0xe0000 && c <= 0xe007f);
}

// Returns the length of the colour code at the beginning of a text, or 0 if there is none. Knows only the codes that
// coloured() in harness/commands/text_table.cpp writes.
std::size_t colour_at(std::string_view text) {
    for (const std::string_view colour : {"\033[31m", "\033[33m", "\033[90m", "\033[0m"}) {
        if (text.starts_with(colour)) return colour.size();
    }
    return 0;
}

std::string cleaned(std::string_view text, bool lines, bool colours) {
    std::string clean;
    while (!text.empty()) {
        const Character c = first_character(text);
        std::size_t length = std::max<std::size_t>(c.length, 1);
        if (const std::size_t colour = colours ? colour_at(text) : 0; colour > 0)
            clean += text.substr(0, length = colour);
        else if (c.length == 0 || is_hidden(c.number))
            clean += '?';
        else if (is_control(c.number) && !(lines && c.number == '\n'))
            clean += ' ';
        else
            clean += text.substr(0, length);
        text.remove_prefix(length);
    }
    return clean;
}

}  // namespace

std::string printable(std::string_view text) { return cleaned(text, false, false); }

std::string printable_lines(std::string_view text, bool colours) { return cleaned(text, true, colours); }

}  // namespace hausbench
