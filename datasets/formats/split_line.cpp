// Splits lines of a table into fields.
#include "datasets/formats/split_line.h"

#include "datasets/formats/parse.h"

#include <algorithm>

namespace hausbench::readers {
namespace {

std::string_view unquoted(std::string_view text) {
    const bool quoted = text.size() >= 2 && text.front() == '"' && text.back() == '"';
    return quoted ? trimmed(text.substr(1, text.size() - 2)) : text;
}

// Returns the position after the quoted field at the start of `text`, or npos if the field does not end. Two quotes in
// it stand for one.
std::size_t end_of_quotes(std::string_view text) {
    for (std::size_t i = 1; i < text.size(); ++i) {
        if (text[i] != '"') continue;
        if (i + 1 == text.size() || text[i + 1] != '"') return i + 1;
        ++i;
    }
    return std::string_view::npos;
}

// Calls `outside(i)` for each character that is not in a quoted field, until it returns true. Quotes begin a field only
// at the start of the line, or after a separator or white space. Returns false if a quoted field does not end.
template <class Outside> bool scan(std::string_view line, const Outside& outside) {
    bool begins = true;
    for (std::size_t i = 0; i < line.size();) {
        if (begins && line[i] == '"') {
            const std::size_t size = end_of_quotes(line.substr(i));
            if (size == std::string_view::npos) return false;
            i += size;
            begins = false;
            continue;
        }
        if (outside(i)) return true;
        begins = line[i] == ',' || line[i] == ';' || blanks.find(line[i]) != std::string_view::npos;
        ++i;
    }
    return true;
}

// Splits a line at a separator, or at white space if the separator is ' '.
void split_at(std::string_view line, char separator, std::vector<std::string_view>& fields) {
    fields.clear();
    std::size_t start = 0;
    const auto add = [&](std::size_t end) {
        const std::string_view field = trimmed(line.substr(start, end - start));
        if (separator != ' ' || !field.empty()) fields.push_back(unquoted(field));
        start = end + 1;
    };
    scan(line, [&](std::size_t i) {
        if (separator == ' ' ? blanks.find(line[i]) != std::string_view::npos : line[i] == separator) add(i);
        return false;
    });
    add(line.size());
}

bool all_numbers(std::string_view field) {
    for (auto word = next_word(field); !word.empty(); word = next_word(field))
        if (!decimal(word)) return false;
    return true;
}

// Appends units in brackets, which blanks separate from their names, to the names: "x", "[US", "ft]" becomes
// "x [US ft]".
void join_units(std::vector<std::string_view>& fields) {
    std::vector<std::string_view> joined;
    for (const std::string_view field : fields) {
        const auto opens = [](std::string_view text) {
            const std::size_t open = text.find_last_of("[(");
            return open != std::string_view::npos && text.find_first_of("])", open) == std::string_view::npos;
        };
        const auto brackets = [](std::string_view text) { return text.starts_with('[') || text.starts_with('('); };
        const bool unit = !joined.empty() && brackets(field) && !brackets(joined.back());
        if (!joined.empty() && joined.back().end() <= field.begin() && (unit || opens(joined.back())))
            joined.back() = {joined.back().begin(), field.end()};
        else
            joined.push_back(field);
    }
    fields = std::move(joined);
}

}  // namespace

bool several_numbers(std::string_view field) {
    return field.find_first_of(blanks) != std::string_view::npos && all_numbers(field);
}

std::string_view without_comment(std::string_view line) {
    std::size_t end = line.size();
    scan(line, [&](std::size_t i) {
        if (line[i] != '#' || (i > 0 && blanks.find(line[i - 1]) == std::string_view::npos)) return false;
        end = i;
        return true;
    });
    return line.substr(0, end);
}

bool split_fields(std::string_view line, std::vector<std::string_view>& fields, bool& by_blanks) {
    bool semicolon = false, comma = false, tab = false;
    if (!scan(line, [&](std::size_t i) {
            semicolon = semicolon || line[i] == ';';
            comma = comma || line[i] == ',';
            tab = tab || line[i] == '\t';
            return false;
        }))
        return false;
    by_blanks = false;
    // A separator at the end alone is the end of a row of MATLAB: "1 2 3;"
    const std::string_view row = trimmed(line);
    if ((semicolon || comma) && row.find_first_of(";,") + 1 == row.size() && row.find_first_of(blanks) < row.size()) {
        line = trimmed(row.substr(0, row.size() - 1));
        semicolon = comma = false;
    }
    if (semicolon || comma) {
        split_at(line, semicolon ? ';' : ',', fields);
        return true;
    }
    if (tab) {
        split_at(line, '\t', fields);
        // Words that blanks separate within tabs are fields of their own if they are numbers.
        if (fields.size() > 2 && std::any_of(fields.begin(), fields.end(), [](std::string_view field) {
                return field.empty() || (field.find(' ') != std::string_view::npos && !all_numbers(field));
            }))
            return true;
    }
    split_at(line, ' ', fields);
    if (line.find_first_of("[(") != std::string_view::npos) join_units(fields);
    by_blanks = true;
    return true;
}

}  // namespace hausbench::readers
