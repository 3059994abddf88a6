#include "harness/commands/measurement_pairs.h"

#include "algorithms/error.h"
#include "harness/commands/row_texts.h"
#include "harness/commands/verb.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <glob.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>

namespace hausbench {

namespace fs = std::filesystem;

namespace {

std::vector<std::string> matches_of(const std::string& pattern) {
    glob_t matches{};
    std::vector<std::string> files;
    if (::glob(pattern.c_str(), 0, nullptr, &matches) == 0)
        files.assign(matches.gl_pathv, matches.gl_pathv + matches.gl_pathc);
    ::globfree(&matches);
    if (files.empty()) throw InputError(fmt::format("{}: no file matches", pattern));
    return files;
}

std::string number_field(double value) {
    return std::isnan(value) ? "" : std::isinf(value) ? "inf" : fmt::format("{:.17g}", value);
}

std::string trimmed(const std::string& text) {
    const auto begin = text.find_first_not_of(" \t\r"), end = text.find_last_not_of(" \t\r");
    return begin == std::string::npos ? "" : text.substr(begin, end - begin + 1);
}

bool in_quotes(const std::string& text, std::size_t at) {
    return std::count(text.begin(), text.begin() + std::ptrdiff_t(at), '"') % 2 == 1;
}

// Removes the quotes around a CSV field; inside them, "" stands for one quote.
std::string unquoted(const std::string& text) {
    if (text.size() < 2 || text.front() != '"' || text.back() != '"') return text;
    std::string name;
    for (std::size_t i = 1; i + 1 < text.size(); ++i) {
        name += text[i];
        if (text[i] == '"' && text[i + 1] == '"') ++i;
    }
    return name;
}

std::size_t find_outside_quotes(const std::string& text, const char* separators, std::size_t from) {
    auto at = text.find_first_of(separators, from);
    while (at != std::string::npos && in_quotes(text, at)) at = text.find_first_of(separators, at + 1);
    return at;
}

// Splits a line at its only comma or tab outside quotes, or at the first blank if it has neither. Returns empty names
// if the line has none of these, or more than one comma or tab.
std::pair<std::string, std::string> two_of(const std::string& line) {
    const std::string text = trimmed(line);
    for (const char* separators : {",\t", " "}) {
        const auto at = find_outside_quotes(text, separators, 0);
        if (at == std::string::npos) continue;
        if (*separators == ',' && find_outside_quotes(text, separators, at + 1) != std::string::npos) return {};
        return {unquoted(trimmed(text.substr(0, at))), unquoted(trimmed(text.substr(at + 1)))};
    }
    return {};
}

// Returns the CSV fields for the witness and for the bounds of both directions. Unknown values are empty.
std::string more_fields(const Measured& m, bool answered) {
    std::vector<std::string> fields;
    const Witness& witness = m.answer.result.witness;
    const bool shown = answered && m.answer.result.witness.source_point.allFinite() &&
                       m.answer.result.witness.target_point.allFinite();
    fields.emplace_back(answered ? to_string(witness.direction) : "");
    for (const Vec3* point : {&witness.source_point, &witness.target_point})
        for (const double x : *point) fields.push_back(shown ? number_field(x) : "");
    for (const auto* answer : {&m.answer.forward, &m.answer.backward})
        for (const double bound :
             {(*answer ? **answer : Result{}).bounds.lower, (*answer ? **answer : Result{}).bounds.upper})
            fields.push_back(*answer ? number_field(bound) : "");
    fields.push_back(answered ? number_field(m.answer.result.bounds.gap()) : "");
    fields.push_back(m.tolerance_of == "lower" ? "" : number_field(m.tolerance_absolute));
    fields.emplace_back(m.certified ? "yes" : "no");
    fields.push_back(csv_field(fmt::format("{}", fmt::join(m.notes, "; "))));
    return fmt::format("{}", fmt::join(fields, ","));
}

constexpr const char* columns_of_pairs =
    "A,B,quantity,lower,upper,status,above_cutoff,seconds,solver,warnings,error,witness_direction,source_x,source_y,"
    "source_z,target_x,target_y,target_z,lower_a_to_b,upper_a_to_b,lower_b_to_a,upper_b_to_a,gap,"
    "tolerance_absolute,certified,notes";
const std::string no_more_fields(14, ',');

// The statistics that have columns. Those of a pair are the same or, where nothing can be pooled, the first of these.
std::vector<Statistic> columns_of_statistics(const MeasureRequest& request) {
    return asked_statistics(request, CountedBy::area, CountedBy::area);
}

std::string statistics_fields(const MeasureRequest& request, const std::vector<Bounds>& bounds) {
    std::string text;
    for (std::size_t i = 0; i < columns_of_statistics(request).size(); ++i)
        text += i < bounds.size() ? fmt::format(",{},{}", number_field(bounds[i].lower), number_field(bounds[i].upper))
                                  : ",,";
    return text;
}

}  // namespace

bool is_pattern(const std::string& name) { return name.find_first_of("*?") != std::string::npos && !fs::exists(name); }

NamedPairs pairs_of_patterns(const std::string& a, const std::string& b) {
    NamedPairs pairs;
    const auto sources = is_pattern(a) ? matches_of(a) : std::vector{a};
    if (!is_pattern(b)) {
        for (const std::string& source : sources) pairs.emplace_back(source, b);
        return pairs;
    }
    std::map<std::string, std::string> targets;
    for (const std::string& target : matches_of(b)) {
        if (!targets.emplace(fs::path(target).stem(), target).second)
            throw InputError(fmt::format("{}: two files are called {}: give a list with --pairs", b,
                                         fs::path(target).stem().string()));
    }
    if (!is_pattern(a)) {
        for (const auto& [stem, target] : targets) pairs.emplace_back(a, target);
        return pairs;
    }
    std::map<std::string, std::string> names;
    for (const std::string& source : sources) {
        const auto [before, fresh] = names.emplace(fs::path(source).stem(), source);
        if (!fresh)
            throw InputError(
                fmt::format("{} and {} have the same name: give a list with --pairs", before->second, source));
        const auto at = targets.find(fs::path(source).stem());
        pairs.emplace_back(source, at == targets.end() ? "" : at->second);
        if (at != targets.end()) targets.erase(at);
    }
    const auto has_partner = [](const auto& pair) { return !pair.second.empty(); };
    if (std::none_of(pairs.begin(), pairs.end(), has_partner))
        throw InputError(fmt::format("{}: no file of {} has the name of one of these: give a list with --pairs", a, b));
    for (const auto& [stem, target] : targets) pairs.emplace_back("", target);
    return pairs;
}

NamedPairs read_pairs(const fs::path& list) {
    std::ifstream in(list);
    if (!in || fs::is_directory(list))
        throw InputError(
            fmt::format("{}: cannot be opened: name a list of pairs, with a line \"A, B\" for each", list.string()));
    NamedPairs pairs;
    std::string line;
    const auto place = [&](const std::string& name) {
        const bool file = names_a_file(name) || fs::exists(list.parent_path() / name);
        return file ? (list.parent_path() / name).string() : name;  // otherwise a model
    };
    for (int number = 1; std::getline(in, line); ++number) {
        if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
        if (line.find('\0') != std::string::npos)
            throw InputError(fmt::format("{}:{}: has a NUL byte: save the list as UTF-8 text", list.string(), number));
        for (std::size_t at = line.find('#'); at != std::string::npos; at = line.find('#', at + 1)) {
            if (in_quotes(line, at)) continue;
            if (at == 0 || line[at - 1] == ' ' || line[at - 1] == '\t') line.resize(at);
        }
        if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
        const auto [a, b] = two_of(line);
        if (pairs.empty() && a == "A" && b == "B" && !fs::exists(list.parent_path() / "A"))
            continue;  // the header of a table
        if (a.empty() || b.empty())
            throw InputError(
                fmt::format("{}:{}: write A, then a comma, then B, and no more; a name with a comma in \"quotes\"",
                            list.string(), number));
        pairs.emplace_back(place(a), place(b));
    }
    if (pairs.empty()) throw InputError(fmt::format("{}: has no pairs: write a line \"A, B\" for each", list.string()));
    return pairs;
}

int measure_pairs(const NamedPairs& pairs, const MeasureRequest& request) {
    int code = 0;
    std::string header = columns_of_pairs;
    for (const Statistic& statistic : columns_of_statistics(request)) {
        std::string name = to_string(statistic);
        std::replace(name.begin(), name.end(), ' ', '_');
        header += fmt::format(",{0}_lower,{0}_upper", name);
    }
    print(header + "\n");
    for (const auto& [a, b] : pairs) {
        MeasureRequest pair_request = request;
        pair_request.source = a;
        pair_request.target = b;
        std::string line = fmt::format("{},{},{},", csv_field(a), csv_field(b), to_string(request.quantity()));
        try {
            if (a.empty() || b.empty())
                throw InputError(
                    "no file of the other pattern has this name: give the pairs that you mean with --pairs");
            const Measured measured = measure(pair_request);
            const int its_code = exit_code(measured, pair_request);
            if (its_code != 0) code = 1;
            const std::string why = no_answer(measured);
            const bool answered = why.empty();
            const std::string above = !request.cutoff ? "" : its_code == 0 ? "no" : its_code == 1 ? "yes" : "open";
            line += fmt::format(
                "{},{},{},{},{:.6f},{},{},{},{}{}\n", answered ? number_field(measured.answer.result.bounds.lower) : "",
                answered ? number_field(measured.answer.result.bounds.upper) : "",
                measured.failed ? to_string(row_status(measured.failed->why))
                                : to_string(measured.answer.result.status),
                above, measured.answer.prepare_seconds + measured.answer.solve_seconds, measured.solver,
                csv_field(fmt::format("{}", fmt::join(measured.warnings, "; "))), csv_field(why),
                more_fields(measured, answered),
                statistics_fields(pair_request, answered ? measured.answer.result.statistics : std::vector<Bounds>()));
        } catch (const InputError& error) {
            if (std::string(error.what()) == "interrupted") throw;
            code = 1;
            line += fmt::format(",,error,,,,,{},{}{}\n", csv_field(error.what()), no_more_fields,
                                statistics_fields(pair_request, {}));
        } catch (const fs::filesystem_error& error) {
            code = 1;
            line += fmt::format(",,error,,,,,{},{}{}\n", csv_field(error.what()), no_more_fields,
                                statistics_fields(pair_request, {}));
        }
        print(line);
        std::fflush(stdout);
    }
    return code;
}

}  // namespace hausbench
