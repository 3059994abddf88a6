#include "algorithms/error.h"

#include "algorithms/printable.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>

namespace hausbench {
namespace {

std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
            diagonal = row[j];
            row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
        }
    }
    return row[b.size()];
}

// The largest number of names in a hint, because a longer message would be hard to read.
constexpr std::size_t names_shown = 40;

}  // namespace

std::string nearest_hint(std::string_view wrong, const std::vector<std::string>& candidates) {
    if (candidates.empty()) return "";
    const std::string* nearest = nullptr;
    std::size_t least = std::numeric_limits<std::size_t>::max();
    for (const std::string& candidate : candidates) {
        const std::size_t distance = edit_distance(wrong, candidate);
        if (distance < least) {
            least = distance;
            nearest = &candidate;
        }
    }
    // If more than a third of the letters differ, the name is probably another word, not a typing error. Short names
    // may differ in two letters, and names of up to three letters in one.
    const std::size_t length = std::max(wrong.size(), nearest->size());
    const std::size_t allowed = length <= 3 ? 1 : std::max<std::size_t>(2, length / 3);
    if (least <= allowed) return fmt::format(" (did you mean '{}'?)", *nearest);

    std::string listed;
    for (std::size_t i = 0; i < candidates.size() && i < names_shown; ++i)
        listed += fmt::format("{}{}", i > 0 ? ", " : "", candidates[i]);
    if (candidates.size() > names_shown) listed += fmt::format(" and {} more", candidates.size() - names_shown);
    return fmt::format(" (known: {})", listed);
}

std::string one_line(std::string text) {
    text = printable(text);
    std::size_t most = std::min<std::size_t>(text.size(), 1000);
    // Do not cut a UTF-8 character in two: its bytes after the first are 10xxxxxx.
    while (most < text.size() && (static_cast<unsigned char>(text[most]) & 0xc0) == 0x80) --most;
    text.resize(most);
    return text;
}

}  // namespace hausbench
