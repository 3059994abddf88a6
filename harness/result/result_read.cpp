#include "harness/result/result_file.h"

#include "algorithms/error.h"
#include "algorithms/printable.h"
#include "datasets/hdf5.h"
#include "datasets/seal.h"
#include "harness/record/columns.h"
#include "harness/result/guard.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <stdexcept>
#include <string_view>
#include <unordered_map>
#include <utility>

namespace hausbench {

namespace fs = std::filesystem;

namespace {

// Reads the columns of a group. `whole` has one entry per row; part(entry) returns the struct that receives the
// columns, such as the outcome of a row. Members of missing columns keep their defaults, because older files lack some
// columns; `needed`, below, lists the columns that must be there. `only` has the names of the columns to read; null: all.
template <class Row, class Whole, class Part>
void read_columns(const h5::File& file, const std::string& group, const Columns<Row>& columns,
                  std::vector<Whole>& whole, Part part, const std::set<std::string>* only = nullptr) {
    for (const Column<Row>& column : columns) {
        const std::string name = group + "/" + std::string(column.name);
        if (only && !only->contains(std::string(column.name))) continue;
        if (!file.has(name)) continue;
        const auto checked = [&](auto values, std::size_t width) {
            if (values.size() != whole.size() * width) {
                throw std::runtime_error(
                    fmt::format("{} has {} values instead of {}", name, values.size(), whole.size() * width));
            }
            return values;
        };
        const auto each = [&](const auto& set) {
            for (std::size_t i = 0; i < whole.size(); ++i) {
                try {
                    set(i);
                } catch (const std::exception& error) {
                    throw std::runtime_error(fmt::format("{} {}", name, error.what()));
                }
            }
        };
        if (const auto* text = std::get_if<typename Column<Row>::Text>(&column.value)) {
            const auto values = checked(file.read_texts(name), 1);
            if (text->set) each([&](std::size_t i) { text->set(part(whole[i]), values[i]); });
        } else if (const auto* integer = std::get_if<typename Column<Row>::Integer>(&column.value)) {
            const auto values = checked(file.read_integers(name), 1);
            if (integer->set) each([&](std::size_t i) { integer->set(part(whole[i]), values[i]); });
        } else {
            const auto& real = std::get<typename Column<Row>::Real>(column.value);
            const auto values = checked(file.read_doubles(name), real.width);
            if (real.set) each([&](std::size_t i) { real.set(part(whole[i]), values.data() + i * real.width); });
        }
    }
}

// Reads the columns that /cases and /references share. `only`: as in read_columns().
std::vector<Row> read_answers(const h5::File& file, const std::string& group,
                              const std::set<std::string>* only = nullptr) {
    std::vector<Row> rows(file.read_texts(group + "/identity").size());
    read_columns(
        file, group, case_columns(), rows, [](Row& r) -> Case& { return r.spec; }, only);
    read_columns(
        file, group, outcome_columns(), rows, [](Row& r) -> Outcome& { return r.outcome; }, only);
    read_columns(
        file, group, check_columns(), rows, [](Row& r) -> Check& { return r.check; }, only);
    return rows;
}

std::vector<Row> read_references(const h5::File& file) {
    if (!file.has("references")) return {};  // an older program wrote the file
    std::vector<Row> rows = read_answers(file, "references");
    for (Row& row : rows) row.is_reference = true;
    return rows;
}

std::vector<Row> read_cases(const h5::File& file) {
    std::vector<Row> rows = read_answers(file, "cases");
    read_columns(file, "cases", row_columns(), rows, std::identity{});
    for (const std::string& child : file.children("cases")) {
        constexpr std::string_view prefix = "counter_";
        if (!child.starts_with(prefix)) continue;
        const auto counts = file.read_unsigned("cases/" + child);
        if (counts.size() != rows.size())
            throw std::runtime_error(
                fmt::format("cases/{} has {} values instead of {}", child, counts.size(), rows.size()));
        const std::string name = child.substr(prefix.size());
        const auto position = std::find_if(counter_fields.begin(), counter_fields.end(),
                                           [&](const CounterField& field) { return field.name == name; });
        for (std::size_t i = 0; i < rows.size(); ++i) {
            if (position != counter_fields.end())
                rows[i].outcome.counters.*position->member = counts[i];
            else
                rows[i].outcome.other_counters[name] = counts[i];
        }
    }
    return rows;
}

// Reads a group with several rows per case, and appends each row to the outcome of its case.
template <class Detail>
void read_details(const h5::File& file, const std::string& group, const Columns<Detail>& columns,
                  std::vector<Row>& rows, std::vector<Detail> Outcome::*member) {
    if (!file.has(group)) return;  // an older program wrote the file
    const auto of = file.read_integers(group + "/case");
    std::vector<Detail> all(of.size());
    read_columns(file, group, columns, all, std::identity{});
    for (std::size_t i = 0; i < of.size(); ++i) {
        if (of[i] < 0 || std::size_t(of[i]) >= rows.size())
            throw std::runtime_error(fmt::format("a row of {} belongs to no case", group));
        (rows[std::size_t(of[i])].outcome.*member).push_back(all[i]);
    }
}

void read_traces(const h5::File& file, std::vector<Row>& rows) {
    std::vector<TraceSample> all(file.read_doubles("trace/seconds").size());
    read_columns(file, "trace", trace_columns(), all, std::identity{});
    const auto begins = file.read_integers("cases/trace_begin"), ends = file.read_integers("cases/trace_end");
    if (begins.size() != rows.size() || ends.size() != rows.size())
        throw std::runtime_error("cases/trace_begin and trace_end are not as many as the cases");
    std::int64_t used = 0;  // traces must not share samples, otherwise a small file could fill the memory
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (begins[i] >= ends[i]) continue;
        if (begins[i] < used) throw std::runtime_error("two cases share samples of a trace");
        if (std::size_t(ends[i]) > all.size()) throw std::runtime_error("a trace reaches past the samples");
        used = ends[i];
        rows[i].outcome.trace.assign(all.begin() + begins[i], all.begin() + ends[i]);
    }
}

void read_fields(const h5::File& file, std::vector<Row>& rows) {
    if (!file.has("fields")) return;  // an older program wrote the file
    const auto of = file.read_integers("fields/case");
    const auto values = file.read_doubles("fields/values");
    std::vector<FieldRecord> all(of.size());
    read_columns(file, "fields", field_columns(), all, std::identity{});
    std::int64_t used = 0;  // fields must not share values, as in read_traces()
    for (std::size_t i = 0; i < of.size(); ++i) {
        const FieldRecord& record = all[i];
        if (of[i] < 0 || std::size_t(of[i]) >= rows.size())
            throw std::runtime_error("a row of fields belongs to no case");
        if (record.begin < used || record.end < record.begin || std::size_t(record.end) > values.size())
            throw std::runtime_error("two fields share values, or one reaches past them");
        used = record.end;
        rows[std::size_t(of[i])].fields.push_back(
            {record.name, record.of, record.meaning, {values.begin() + record.begin, values.begin() + record.end}});
    }
}

template <class Row>
std::vector<Row> read_group(const h5::File& file, const std::string& group, const Columns<Row>& columns,
                            const std::string& counted) {
    std::vector<Row> rows(file.read_texts(group + "/" + counted).size());
    read_columns(file, group, columns, rows, std::identity{});
    return rows;
}

// Columns that every file must have, whichever version wrote it.
constexpr const char* needed[] = {"cases/solver", "cases/scene",     "cases/status", "cases/lower",
                                  "cases/upper",  "cases/tolerance", "models/sha256"};

constexpr const char* meta_texts[] = {"stem",     "title",    "paper",      "profile",   "experiment_toml",
                                      "started",  "finished", "commit",     "dirty",     "build",
                                      "compiler", "flags",    "build_type", "libraries", "machine",
                                      "cpu",      "caches",   "kernel",     "system",    "hausbench_version"};
constexpr const char* later_texts[] = {"plugins", "titles", "shard", "experiment_file"};  // older files have none
constexpr const char* meta_integers[] = {"cores", "memory_bytes"};

void expect_result(const fs::path& file, const h5::File& in) {
    if (!in.has("meta") || !in.has_attribute("meta", "schema_version")) {
        throw InputError(
            fmt::format("{}: is not a result of hausbench: name a file that `hausbench run` wrote", file.string()));
    }
    const auto schema = in.integer_attribute("meta", "schema_version");
    if (schema > result_schema)
        throw NewerResult(
            fmt::format("{}: has schema version {}, this program reads 1 to {}: use a newer hausbench, or another "
                        "folder for results",
                        file.string(), schema, result_schema));
    if (schema < 1)
        throw InputError(fmt::format("{}: has schema version {}, but the first is 1: run its experiment again",
                                     file.string(), schema));
}

void expect_columns(const h5::File& in) {
    for (const char* column : needed) {
        if (!in.has(column)) throw std::runtime_error(fmt::format("it has no {}", column));
    }
}

// Returns a result with the attributes of /meta and nothing else. The next functions read without protection: the HDF5
// library crashes on some damaged files, see read_in_a_copy().
ResultFile read_meta(const fs::path& file, const h5::File& in) {
    expect_result(file, in);
    expect_columns(in);
    ResultFile result;
    for (const char* name : meta_texts) result.texts[name] = in.text_attribute("meta", name);
    for (const char* name : later_texts)
        result.texts[name] = in.has_attribute("meta", name) ? in.text_attribute("meta", name) : "";
    for (const char* name : meta_integers) result.integers[name] = in.integer_attribute("meta", name);
    return result;
}

void read_times(const h5::File& in, ResultFile& result) {
    read_details(in, "answers", answer_columns(), result.rows, &Outcome::answers);
    read_details(in, "repeats", repeat_columns(), result.rows, &Outcome::repeats);
    read_details(in, "preparation", preparation_columns(), result.rows, &Outcome::preparation);
}

void set_profiles(std::vector<Row>& rows, const ResultFile& result) {
    for (Row& row : rows)
        if (row.spec.profile.empty()) row.spec.profile = result.texts.at("profile");
}

ResultFile read_part_trusting(const fs::path& file, const ResultPart& part) {
    const h5::File in(file, h5::Open::read);
    ResultFile result = read_meta(file, in);
    result.rows = read_answers(in, "cases", &part.columns);
    set_profiles(result.rows, result);
    if (part.times) read_times(in, result);
    if (part.models) result.models = read_group(in, "models", model_columns(), "name");
    return result;
}

ResultFile read_trusting(const fs::path& file) {
    const h5::File in(file, h5::Open::read);
    ResultFile result = read_meta(file, in);
    result.models = read_group(in, "models", model_columns(), "name");
    result.rows = read_cases(in);
    result.references = read_references(in);
    read_times(in, result);
    read_traces(in, result.rows);
    read_fields(in, result.rows);
    result.ledger = read_group(in, "ledger", ledger_columns(), "kind");
    for (LedgerEntry& entry : result.ledger) {
        if (entry.profile.empty()) entry.profile = result.texts["profile"];
    }
    std::unordered_map<std::string_view, std::string_view> hashes;
    for (const ModelRecord& model : result.models) hashes[model.name] = model.sha256;
    for (auto* rows : {&result.rows, &result.references}) {
        set_profiles(*rows, result);
        for (Row& row : *rows) {
            for (auto [name, hash] : {std::pair(&row.spec.source, &row.spec.source_hash),
                                      std::pair(&row.spec.target, &row.spec.target_hash)}) {
                if (const auto at = hashes.find(*name); at != hashes.end()) *hash = at->second;
            }
        }
    }
    return result;
}

// Calls read() in another process. If that survives, this process can call it, too, and gets the same result or error.
template <class Read> void read_and_drop(const fs::path& file, const Read& read) {
    read_in_a_copy(file, [&] {
        static_cast<void>(read());
        return std::string();
    });
}

// Calls read() for a result, first in another process. Throws as read_result() does.
template <class Read> auto read_guarded(const fs::path& file, const Read& read) {
    std::error_code gone;
    const fs::file_status status = fs::status(file, gone);
    if (fs::is_directory(status))
        throw InputError(fmt::format("{}: is a folder: name a result file (.h5)", file.string()));
    if (!fs::exists(status))
        throw InputError(fmt::format("{}: does not exist: run its experiment first", file.string()));
    if (!fs::is_regular_file(status))
        throw InputError(fmt::format("{}: is not a regular file: name a result file (.h5)", file.string()));
    try {
        h5::check_seal(file);
        read_and_drop(file, read);
        return read();
    } catch (const InputError&) {
        throw;
    } catch (const std::exception& error) {
        std::string why = error.what();
        if (why.starts_with(file.string() + ": ")) why.erase(0, file.string().size() + 2);
        throw InputError(
            fmt::format("{}: damaged, or not a result of hausbench ({}): write it again by running its experiment",
                        file.string(), printable(why)));
    }
}

}  // namespace

ResultFile read_result(const fs::path& file) {
    return read_guarded(file, [&] { return read_trusting(file); });
}

ResultFile read_part(const fs::path& file, const ResultPart& part) {
    return read_guarded(file, [&] { return read_part_trusting(file, part); });
}

EarlierExperiment experiment_of(const fs::path& result) {
    std::error_code gone;
    if (!fs::is_regular_file(result, gone)) return {};
    EarlierExperiment of;
    const auto look = [&] {
        const h5::File in(result, h5::Open::read);
        expect_result(result, in);
        of.toml = in.text_attribute("meta", "experiment_toml");
        if (in.has_attribute("meta", "experiment_file")) of.file = in.text_attribute("meta", "experiment_file");
    };
    try {
        h5::check_seal(result);
        read_and_drop(result, look);
        look();
    } catch (const NewerResult&) {
        throw;
    } catch (const std::exception&) {  // the damaged file is put aside when the result is written
        return {};
    }
    return of;
}

}  // namespace hausbench
