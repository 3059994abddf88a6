#include "harness/commands/text_table.h"

#include <fmt/format.h>

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <sstream>

namespace hausbench {

namespace {

constexpr std::size_t between = 2, least = 8;  // blanks between columns; least width of a shortened column

bool begins_character(char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }  // in UTF-8

std::size_t characters(const std::string& text) {
    std::size_t count = 0;
    for (const char c : text) count += begins_character(c);
    return count;
}

std::string shortened(const std::string& text, std::size_t width) {
    if (characters(text) <= width) return text;
    std::size_t bytes = 0;
    for (std::size_t seen = 0; bytes < text.size(); ++bytes) {
        if (begins_character(text[bytes]) && ++seen == width) break;
    }
    return text.substr(0, bytes) + "…";
}

std::string padded(const std::string& text, std::size_t width, bool right) {
    const std::string blanks(width - std::min(width, characters(text)), ' ');
    return right ? blanks + text : text + blanks;
}

}  // namespace

Paper paper_of_output() {
    Paper paper;
    const bool terminal = ::isatty(STDOUT_FILENO);
    if (const char* columns = std::getenv("COLUMNS")) paper.width = std::size_t(std::max(0, std::atoi(columns)));
    winsize size{};
    if (terminal && paper.width == 0 && ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0) paper.width = size.ws_col;
    const char *refused = std::getenv("NO_COLOR"), *kind = std::getenv("TERM");
    paper.colour = terminal && (!refused || !*refused) && kind && std::string(kind) != "dumb";
    return paper;
}

std::string coloured(const std::string& text, Colour colour, const Paper& paper) {
    if (!paper.colour || colour == Colour::none) return text;
    return fmt::format("\033[{}m{}\033[0m", colour == Colour::red ? 31 : colour == Colour::yellow ? 33 : 90, text);
}

std::string wrapped(const std::string& text, std::size_t indent, std::size_t width) {
    const std::string blanks(indent, ' ');
    std::istringstream in(printable(text));
    std::string out, line;
    for (std::string word; in >> word;) {
        if (!line.empty() && width > 0 && indent + characters(line) + 1 + characters(word) > width) {
            out += blanks + line + '\n';
            line.clear();
        }
        line += (line.empty() ? "" : " ") + word;
    }
    return line.empty() ? out : out + blanks + line + '\n';
}

TextTable::Layout TextTable::layout(const Paper& paper) const {
    Layout layout;
    for (std::size_t c = 0; c < columns_.size(); ++c) {
        std::size_t width = characters(columns_[c].title);
        for (const Row& row : rows_) width = std::max(width, characters(row.cells[c]));
        layout.columns.push_back(c);
        layout.widths.push_back(width);
    }
    const auto needed = [&] {
        return std::accumulate(layout.widths.begin(), layout.widths.end(), between * (layout.widths.size() - 1));
    };
    const auto rank = [&](std::size_t a, std::size_t b) { return columns_[a].rank < columns_[b].rank; };
    while (paper.width > 0 && needed() > paper.width) {
        const auto at = std::max_element(layout.columns.begin(), layout.columns.end(), rank);
        if (columns_[*at].rank == 0) break;
        layout.widths.erase(layout.widths.begin() + (at - layout.columns.begin()));
        layout.columns.erase(at);
    }
    // Repeatedly takes one character from the widest column that may be shortened.
    while (paper.width > 0 && needed() > paper.width) {
        std::size_t* widest = nullptr;
        for (std::size_t i = 0; i < layout.columns.size(); ++i) {
            if (!columns_[layout.columns[i]].shorten || layout.widths[i] <= least) continue;
            if (!widest || layout.widths[i] > *widest) widest = &layout.widths[i];
        }
        if (!widest) break;
        --*widest;
    }
    layout.fits = paper.width == 0 || needed() <= paper.width;
    return layout;
}

std::string TextTable::as_running_text(const Paper& paper) const {
    std::string out;
    for (const Row& row : rows_) {
        std::string rest;
        for (std::size_t c = 1; c < columns_.size(); ++c) {
            if (!row.cells[c].empty()) rest += (rest.empty() ? "" : "; ") + columns_[c].title + " " + row.cells[c];
        }
        out += coloured(row.cells[0], row.colour, paper) + '\n' + wrapped(rest, 2, paper.width) +
               wrapped(row.below, 4, paper.width);
    }
    return out;
}

std::string TextTable::text(const Paper& paper, std::vector<std::string>* left_out) const {
    const Layout layout = this->layout(paper);
    if (!layout.fits) return as_running_text(paper);
    for (std::size_t c = 0; left_out && c < columns_.size(); ++c) {
        if (std::find(layout.columns.begin(), layout.columns.end(), c) == layout.columns.end())
            left_out->push_back(columns_[c].title);
    }
    const auto line = [&](const auto& cell) {
        std::string out;
        for (std::size_t i = 0; i < layout.columns.size(); ++i) {
            const Column& column = columns_[layout.columns[i]];
            out += (i > 0 ? std::string(between, ' ') : "") +
                   padded(shortened(cell(layout.columns[i]), layout.widths[i]), layout.widths[i], column.right);
        }
        return out.erase(out.find_last_not_of(' ') + 1);
    };
    std::string out = coloured(line([&](std::size_t c) { return columns_[c].title; }), Colour::grey, paper) + '\n';
    for (const Row& row : rows_) {
        out += coloured(line([&](std::size_t c) { return row.cells[c]; }), row.colour, paper) + '\n';
        out += wrapped(row.below, 4, paper.width);
    }
    return out;
}

}  // namespace hausbench
