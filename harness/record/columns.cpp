#include "record/columns.h"

#include "record/json.h"

#include <fmt/format.h>

#include <array>
#include <stdexcept>
#include <type_traits>
#include <utility>

namespace hausbench {

using nlohmann::json;

namespace {

template <class T>
constexpr bool is_json_text =
    std::is_same_v<T, ParameterMap> || std::is_same_v<T, std::map<std::string, double>> || std::is_same_v<T, Facts>;

template <class T> std::string json_text(const T& value) {
    if constexpr (std::is_same_v<T, ParameterMap>)
        return options_json(value).dump();
    else if constexpr (std::is_same_v<T, Facts>)
        return json(value).dump();
    else
        return extras_json(value).dump();
}

template <class T> T parsed_json_text(const std::string& text) {
    const json object = json::parse(text);
    if constexpr (std::is_same_v<T, ParameterMap>) {
        ParameterMap options;
        for (const auto& [name, value] : object.items()) options[name] = parameter_of(value);
        return options;
    } else if constexpr (std::is_same_v<T, Facts>) {
        return object.get<Facts>();
    } else {
        return extras_of(object);
    }
}

// Files hold the same text in row after row, so the last one is remembered.
template <class T> const T& from_json_text(const std::string& text) {
    thread_local std::string known = "{}";
    thread_local T value;
    if (text == known) return value;
    value = parsed_json_text<T>(text);
    known = text;
    return value;
}

template <class T> constexpr std::size_t width_of() {
    if constexpr (std::is_same_v<T, double>) return 1;
    if constexpr (std::is_same_v<T, Vec3>) return 3;
    if constexpr (std::is_same_v<T, Pose>) return 12;
    if constexpr (std::is_same_v<T, std::array<double, 6>>) return 6;
    return 0;
}

// The doubles of a value, in the order of the file: a rotation goes row by row.
template <class T, class F> void each_double(T& value, F take) {
    using Plain = std::remove_const_t<T>;
    if constexpr (std::is_same_v<Plain, double>) {
        take(value);
    } else if constexpr (std::is_same_v<Plain, Pose>) {
        for (int i = 0; i < 9; ++i) take(value.rotation(i / 3, i % 3));
        for (int i = 0; i < 3; ++i) take(value.translation[i]);
    } else {
        for (auto& v : value) take(v);
    }
}

template <class E> E named(const std::string& text) {
    for (int i = 0; i < count_of<E>; ++i) {
        if (text == to_string(E(i))) return E(i);
    }
    throw std::runtime_error(fmt::format("'{}' is not one of its values", text));
}

// `member` is a lambda that returns a reference to where the value is.
template <class Row, auto member>
Column<Row> at(std::string_view name, std::string_view meaning, Identity identity = Identity::no) {
    using T = std::remove_cvref_t<decltype(member(std::declval<Row&>()))>;
    if constexpr (std::is_same_v<T, std::string>) {
        return {name, meaning,
                typename Column<Row>::Text{[](const Row& row) { return member(row); },
                                           [](Row& row, const std::string& text) { member(row) = text; }},
                identity};
    } else if constexpr (is_json_text<T>) {
        return {name, meaning,
                typename Column<Row>::Text{
                    [](const Row& row) { return json_text<T>(member(row)); },
                    [](Row& row, const std::string& text) { member(row) = from_json_text<T>(text); }},
                identity};
    } else if constexpr (std::is_enum_v<T>) {
        return {name, meaning,
                typename Column<Row>::Text{[](const Row& row) { return std::string(to_string(member(row))); },
                                           [](Row& row, const std::string& text) { member(row) = named<T>(text); }},
                identity};
    } else if constexpr (width_of<T>() > 0) {
        return {name, meaning,
                typename Column<Row>::Real{
                    width_of<T>(),
                    [](const Row& row, double* out) { each_double(member(row), [&](const double& v) { *out++ = v; }); },
                    [](Row& row, const double* in) { each_double(member(row), [&](double& v) { v = *in++; }); }},
                identity};
    } else {
        static_assert(std::is_integral_v<T>);
        return {name, meaning,
                typename Column<Row>::Integer{[](const Row& row) { return std::int64_t(member(row)); },
                                              [](Row& row, std::int64_t value) {
                                                  if (std::int64_t(T(value)) != value)
                                                      throw std::runtime_error(fmt::format("holds {}", value));
                                                  member(row) = T(value);
                                              }},
                identity};
    }
}

#define MEMBER(where) \
    [](auto& row) -> auto& { return row.where; }

}  // namespace

const Columns<Case>& case_columns() {
    // Those of the identity stand first, in the order in which they are hashed.
    static const Columns<Case> columns = {
        at<Case, MEMBER(solver)>("solver", "registry name", Identity::always),
        at<Case, MEMBER(options)>("options", "JSON object of every parameter", Identity::always),
        at<Case, MEMBER(source)>("source", "model of the scene that is A", Identity::of_missing),
        at<Case, MEMBER(target)>("target", "model of the scene that is B", Identity::of_missing),
        at<Case, MEMBER(pose)>("pose", "of A: rotation row by row, then translation", Identity::always),
        at<Case, MEMBER(tolerance_of)>("tolerance_of",
                                       "what the tolerance is a fraction of: the `diagonal` or the `longest` side of "
                                       "the box of A as loaded, whatever the "
                                       "pose, or `lower`; or `absolute`: a length",
                                       Identity::always),
        at<Case, MEMBER(tolerance)>("tolerance", "as asked", Identity::always),
        at<Case, MEMBER(limits.case_seconds)>("case_seconds_limit", "for one answer", Identity::always),
        at<Case, MEMBER(limits.prepare_seconds)>("prepare_seconds_limit", "for loading and preparing",
                                                 Identity::always),
        at<Case, MEMBER(limits.memory_bytes)>("memory_limit_bytes", "of resident memory", Identity::always),
        at<Case, MEMBER(floor)>("floor", "a distance of at most this length is of no interest; 0: none",
                                Identity::where_given),
        at<Case, MEMBER(cutoff)>("cutoff", "a distance above this length is known well enough; infinity: none",
                                 Identity::where_given),
        at<Case, MEMBER(budget)>("budget", "of the solver's own unit of work, see its file; -1: none",
                                 Identity::where_given),
        at<Case, MEMBER(target_pose)>("target_pose", "of B, likewise", Identity::where_given),
        at<Case, MEMBER(quantity)>("quantity",
                                   "`directed`: h(A,B); `symmetric`: H(A,B), the larger of h(A,B) and h(B,A); or "
                                   "`penetration`: how deep A and B are in each other",
                                   Identity::where_given),
        at<Case, MEMBER(warm)>("warm", "1: the solver starts from what it kept of the pose before; 0: from nothing",
                               Identity::where_given),
        at<Case, MEMBER(chain)>(
            "chain",
            "of a warm case: the `identity` of the case of the pose before it; in a search: of the target before it; "
            "empty at the first",
            Identity::where_given),
        at<Case, MEMBER(threads)>("threads", "that the solver may use; 1 for a solver that offers no more",
                                  Identity::where_given),
        at<Case, MEMBER(program_sha256)>("program_sha256",
                                         "of the programs and files that the command line of `external` names; empty: "
                                         "there is none",
                                         Identity::where_given),
        at<Case, MEMBER(frame)>("frame", "of a recorded simulation; -1: the scene is none", Identity::where_given),
        at<Case, MEMBER(identity)>("identity", "SHA-256 of shapes, poses, solver, options, tolerance, limits"),
        at<Case, MEMBER(label)>("label", "name in figures: that of the solver unless the experiment gives one"),
        at<Case, MEMBER(variant)>("variant",
                                  "the parameters that the experiment sweeps, as in `samples=8, seed=1`; empty where "
                                  "it sweeps none, and in older files"),
        at<Case, MEMBER(profile)>("profile",
                                  "of the experiment, that asks for the case; several are joined by commas; empty in "
                                  "older files: that of `/meta`"),
        at<Case, MEMBER(certified)>("certified",
                                    "1: the solver's bounds hold under the rounding of its own arithmetic; 0: they "
                                    "hold in exact arithmetic, or it promises less; -1: unknown, since the solver is "
                                    "not built"),
        at<Case, MEMBER(scene)>("scene", "of the experiment"),
        at<Case, MEMBER(note)>("scene_note",
                               "the experiment's remark on the scene, such as the model that it stands in for"),
        at<Case, MEMBER(exact)>("exact", "the true distance, where the experiment gives it; else NaN"),
        at<Case, MEMBER(source_elements)>("source_elements", "points or triangles of A"),
        at<Case, MEMBER(target_elements)>("target_elements", "points or triangles of B"),
        at<Case, MEMBER(source_diagonal)>("source_diagonal", "length, of the box of A as loaded"),
        at<Case, MEMBER(source_longest)>("source_longest", "length of the longest side of that box; 0 in older files"),
        at<Case, MEMBER(pose_index)>("pose_index", "number in the motions"),
        {"tolerance_absolute", "as a length (NaN for `lower`)",
         Column<Case>::Real{1,
                            [](const Case& asked, double* out) {
                                const Tolerance t = asked.resolved_tolerance();
                                *out = t.of == Tolerance::Of::absolute ? t.value : unknown;
                            },
                            nullptr}},
    };
    return columns;
}

const Columns<Outcome>& outcome_columns() {
    static const Columns<Outcome> columns = {
        at<Outcome, MEMBER(status)>("status",
                                    "`ok`, `timeout`, `out_of_memory`, `signal`, `skipped`, `failed`, `unsound`, "
                                    "`not_built`, `floor`, `budget`: see the table below"),
        at<Outcome, MEMBER(reason)>("reason", "one line, where the status is not `ok`"),
        at<Outcome, MEMBER(solver_status)>("solver_status",
                                           "the status that the solver returned: `converged`, `time_limit`, ..."),
        {"answer",
         "what an `ok` row says: `gap` (upper less the larger of lower and floor is within the tolerance), `h <= "
         "floor` or `h > cutoff`; else empty",
         Column<Outcome>::Text{[](const Outcome& o) -> std::string {
                                   if (o.status != RowStatus::ok) return "";
                                   return o.solver_status == to_string(Status::below_floor)    ? "h <= floor"
                                          : o.solver_status == to_string(Status::above_cutoff) ? "h > cutoff"
                                                                                               : "gap";
                               },
                               nullptr}},
        at<Outcome, MEMBER(cutoff_used)>(
            "cutoff_used",
            "the cutoff that the answer was given: in a search the least upper bound of the answers to the targets "
            "before it, if that is less than `cutoff`, but above `floor`; else `cutoff`; infinity: none, or no answer"),
        at<Outcome, MEMBER(bounds.lower)>("lower", "lower <= h(A posed, B posed), or H where `quantity` says so"),
        at<Outcome, MEMBER(bounds.upper)>("upper", "upper >= that distance"),
        at<Outcome, MEMBER(witness.source_point)>(
            "witness_source", "a point on A posed: the one that proves the lower bound, or the closest to it"),
        at<Outcome, MEMBER(witness.target_point)>("witness_target", "likewise on B posed"),
        at<Outcome, MEMBER(witness.direction)>("witness_direction",
                                               "`source to target`: the point on A proves the lower bound; `target to "
                                               "source`: the one on B, where the distance is H"),
        at<Outcome, MEMBER(witness.source_element)>("witness_source_element", "point or triangle number, -1 unknown"),
        at<Outcome, MEMBER(witness.target_element)>("witness_target_element", "likewise"),
        at<Outcome, MEMBER(prepare_seconds)>("prepare_seconds",
                                             "all structures together; each round prepares once, and this is the "
                                             "median of the rounds. In a matrix, what those "
                                             "of its two shapes cost when they were built, for whatever pair"),
        at<Outcome, MEMBER(prepare_bytes)>("prepare_bytes", "all structures together"),
        at<Outcome, MEMBER(solve_seconds)>(
            "solve_seconds",
            "wall time of the first answer of round 0; those of all rounds are in `/answers`. Where `from_trace` is 1 "
            "and there is no row in `/answers`, of the sample of the trace"),
        at<Outcome, MEMBER(reported_seconds)>("reported_seconds",
                                              "the time that an outside program reports in round 0 (solver "
                                              "`external`), else NaN; `solve_seconds` and `/repeats` "
                                              "also include starting it and reading and writing files"),
        at<Outcome, MEMBER(peak_bytes)>(
            "peak_bytes",
            "what the solver took, as in `measure`: peak resident set while preparing and solving less the resident "
            "set before preparing; of an outside program its own peak; -1 unknown, as in a matrix, whose pairs share "
            "shapes"),
        at<Outcome, MEMBER(clock)>(
            "clock",
            "which of the times in `/answers` and `/repeats` is the time of the case: `cpu` where one thread works at "
            "a time, `wall` where several do (another thread of the process took more than a hundredth of its CPU "
            "time, or CPU time with children is more than 1.1 times wall time, in any round); empty without an "
            "answer. `solve_seconds` is wall time all the same"),
        at<Outcome, MEMBER(from_trace)>("from_trace",
                                        "1: not run; the answer is read from the trace of a finer tolerance"),
        at<Outcome, MEMBER(extras)>("extras",
                                    "JSON object of further numbers that the solver reports, such as `alpha` of "
                                    "`adaptive`; each solver's file says what they mean"),
        at<Outcome, MEMBER(facts)>("facts",
                                   "JSON object of texts that the solver reports, such as `chosen` of `adaptive`"),
        at<Outcome, MEMBER(fields_sha256)>("fields_sha256",
                                           "of the file that held the row's fields while it was run; empty: it has "
                                           "none"),
        at<Outcome, MEMBER(build)>("build",
                                   "as in `/meta`; a resumed file may hold several; for a solver of a plug-in, a hash "
                                   "of the program and the plug-in"),
        at<Outcome, MEMBER(machine)>("machine", "as in `/meta`"),
    };
    return columns;
}

const Columns<Check>& check_columns() {
    static const Columns<Check> columns = {
        at<Check, MEMBER(lower)>(
            "lower_check",
            "the harness's own check, not timed: `holds`, `unsound`, `no witness` (so not checked), `not checked`"),
        at<Check, MEMBER(upper)>("upper_check", "likewise"),
        at<Check, MEMBER(fields)>("fields_check", "likewise, on 100 vertices and 100 elements of A"),
    };
    return columns;
}

const Columns<ModelRecord>& model_columns() {
    static const Columns<ModelRecord> columns = {
        at<ModelRecord, MEMBER(name)>("name", "as in the catalogue"),
        at<ModelRecord, MEMBER(sha256)>("sha256", "of the float64 coordinates and indices"),
        at<ModelRecord, MEMBER(kind)>("kind", "`points`, `mesh` or `surface`"),
        at<ModelRecord, MEMBER(polynomial)>("polynomial", "of a surface: the surface is where it vanishes; else empty"),
        at<ModelRecord, MEMBER(box)>("box", "of a surface: from and to in x, y and z; else NaN"),
        at<ModelRecord, MEMBER(elements)>("elements", "points or triangles; of a surface 1"),
        at<ModelRecord, MEMBER(vertices)>("vertices", "of a surface the two corners of its box"),
        at<ModelRecord, MEMBER(diagonal)>("diagonal", "of the box of its points"),
        at<ModelRecord, MEMBER(longest_side)>("longest_side", "of that box; 0 in older files"),
        at<ModelRecord, MEMBER(precision)>("precision", "`float64`, or `float32` if the reader rounds to it"),
        at<ModelRecord, MEMBER(unreferenced)>("unreferenced", "vertices dropped; -1 unknown"),
        at<ModelRecord, MEMBER(source)>("source", "where it comes from"),
        at<ModelRecord, MEMBER(path)>(
            "path", "of a file, or in a package, as its table or the experiment gives it; else empty"),
        at<ModelRecord, MEMBER(file_sha256)>("file_sha256", "of the bytes of that file, or of the one in a package"),
        at<ModelRecord, MEMBER(licence)>("licence", "SPDX where there is one"),
        at<ModelRecord, MEMBER(note)>("note", "the catalogue's remark"),
    };
    return columns;
}

const Columns<FirstAnswer>& answer_columns() {
    static const Columns<FirstAnswer> columns = {
        at<FirstAnswer, MEMBER(round)>("round", "each in fresh processes"),
        at<FirstAnswer, MEMBER(wall_seconds)>("wall_seconds", ""),
        at<FirstAnswer, MEMBER(cpu_seconds)>(
            "cpu_seconds",
            "of the process, all its threads and its children that ended; it includes what the harness spends "
            "meanwhile, such as reading what an outside program prints"),
        at<FirstAnswer, MEMBER(reported_seconds)>("reported_seconds",
                                                  "the time that an outside program reports, else NaN"),
    };
    return columns;
}

const Columns<Repeat>& repeat_columns() {
    static const Columns<Repeat> columns = {
        at<Repeat, MEMBER(round)>("round", ""),
        at<Repeat, MEMBER(wall_seconds)>("wall_seconds", "of one solve"),
        at<Repeat, MEMBER(cpu_seconds)>("cpu_seconds", "of one solve, as in `/answers`"),
        at<Repeat, MEMBER(iterations)>("iterations", "number of solves in one timing"),
    };
    return columns;
}

const Columns<Preparation>& preparation_columns() {
    static const Columns<Preparation> columns = {
        at<Preparation, MEMBER(round)>("round", ""),
        at<Preparation, MEMBER(name)>("name", "of the structure, or `solver` for what the solver built itself"),
        at<Preparation, MEMBER(seconds)>("seconds", "wall time"),
        at<Preparation, MEMBER(bytes)>("bytes", ""),
        at<Preparation, MEMBER(shared)>("shared",
                                        "1: it was there already, for another pair of a matrix, or for the other "
                                        "direction of H; `seconds` is what it cost then"),
    };
    return columns;
}

const Columns<TraceSample>& trace_columns() {
    static const Columns<TraceSample> columns = {
        at<TraceSample, MEMBER(seconds)>("seconds", "since solve began"),
        at<TraceSample, MEMBER(lower)>("lower", ""),
        at<TraceSample, MEMBER(upper)>("upper", ""),
    };
    return columns;
}

const Columns<FieldRecord>& field_columns() {
    static const Columns<FieldRecord> columns = {
        at<FieldRecord, MEMBER(name)>(
            "name",
            "`distance`: of each vertex of A posed, its distance to B posed, a length; `nearest`: the number of the "
            "element of B that is as near; all others come from the solver, whose file says what they mean"),
        at<FieldRecord, MEMBER(of)>("of", "`vertices` of A or `elements` of A; a point is a vertex and an element"),
        at<FieldRecord, MEMBER(meaning)>(
            "meaning",
            "`lower`, `upper`: a bound of the largest distance to B posed of a point of the element, a length; "
            "`number`: anything else"),
        at<FieldRecord, MEMBER(begin)>("begin", "first value in `values`"),
        at<FieldRecord, MEMBER(end)>("end", "the one after the last"),
    };
    return columns;
}

const Columns<LedgerEntry>& ledger_columns() {
    static const Columns<LedgerEntry> columns = {
        at<LedgerEntry, MEMBER(kind)>(
            "kind", "`not_built`, `not_prepared`, `not_run`; `prepared_again`: what could not be left out"),
        at<LedgerEntry, MEMBER(subject)>("subject", "solver and scene"),
        at<LedgerEntry, MEMBER(what)>("what",
                                      "such as a structure. For motions, `structures for each pose` counts the poses "
                                      "that reused structures: one process prepares once and answers all poses; of "
                                      "kind `prepared_again`, the poses that could not"),
        at<LedgerEntry, MEMBER(reason)>("reason", "why this was safe; of `prepared_again`, why it had to be"),
        at<LedgerEntry, MEMBER(count)>("count", "cases, structures, or poses"),
        at<LedgerEntry, MEMBER(seconds_saved)>("seconds_saved", "NaN if unknown"),
        at<LedgerEntry, MEMBER(profile)>("profile", "in which the experiment was run"),
    };
    return columns;
}

template <class Row> json row_json(const Columns<Row>& columns, const Row& row) {
    json object = json::object();
    for (const Column<Row>& column : columns) {
        json& field = object[std::string(column.name)];
        if (const auto* text = std::get_if<typename Column<Row>::Text>(&column.value)) {
            field = text->get(row);
        } else if (const auto* integer = std::get_if<typename Column<Row>::Integer>(&column.value)) {
            field = integer->get(row);
        } else {
            const auto& real = std::get<typename Column<Row>::Real>(column.value);
            double values[12];
            real.get(row, values);
            if (real.width == 1)
                field = number(values[0]);
            else
                for (std::size_t k = 0; k < real.width; ++k) field.push_back(number(values[k]));
        }
    }
    return object;
}

template <class Row> void read_row(const Columns<Row>& columns, const json& object, Row& row) {
    for (const Column<Row>& column : columns) {
        const auto at = object.find(column.name);
        if (at == object.end()) continue;
        if (const auto* text = std::get_if<typename Column<Row>::Text>(&column.value)) {
            if (text->set) text->set(row, at->template get<std::string>());
        } else if (const auto* integer = std::get_if<typename Column<Row>::Integer>(&column.value)) {
            if (integer->set) integer->set(row, at->template get<std::int64_t>());
        } else {
            const auto& real = std::get<typename Column<Row>::Real>(column.value);
            double values[12];
            for (std::size_t k = 0; k < real.width; ++k) values[k] = number(real.width == 1 ? *at : at->at(k));
            if (real.set) real.set(row, values);
        }
    }
}

template json row_json(const Columns<Case>&, const Case&);
template json row_json(const Columns<Outcome>&, const Outcome&);
template json row_json(const Columns<FirstAnswer>&, const FirstAnswer&);
template json row_json(const Columns<Repeat>&, const Repeat&);
template json row_json(const Columns<Preparation>&, const Preparation&);
template json row_json(const Columns<TraceSample>&, const TraceSample&);
template json row_json(const Columns<Check>&, const Check&);
template json row_json(const Columns<FieldRecord>&, const FieldRecord&);
template json row_json(const Columns<ModelRecord>&, const ModelRecord&);
template json row_json(const Columns<LedgerEntry>&, const LedgerEntry&);
template void read_row(const Columns<Outcome>&, const json&, Outcome&);
template void read_row(const Columns<FirstAnswer>&, const json&, FirstAnswer&);
template void read_row(const Columns<Repeat>&, const json&, Repeat&);
template void read_row(const Columns<Preparation>&, const json&, Preparation&);
template void read_row(const Columns<TraceSample>&, const json&, TraceSample&);

namespace {

template <class Row> void describe(const Columns<Row>& columns, json& group) {
    const json usual = row_json(columns, Row{});
    for (const Column<Row>& column : columns) {
        const auto* real = std::get_if<typename Column<Row>::Real>(&column.value);
        const bool text = std::holds_alternative<typename Column<Row>::Text>(column.value);
        group.push_back({{"name", column.name},
                         {"type", real   ? "real"
                                  : text ? "text"
                                         : "integer"},
                         {"width", real ? real->width : 1},
                         {"meaning", column.meaning},
                         {"default", usual.at(std::string(column.name))},
                         {"identity", column.identity != Identity::no}});
    }
}

}  // namespace

json columns_json() {
    const auto integer = [](const char* name, const char* meaning) {
        return json{{"name", name},       {"type", "integer"}, {"width", 1},
                    {"meaning", meaning}, {"default", 0},      {"identity", false}};
    };
    json groups = json::object();
    describe(model_columns(), groups["models"]);
    json& cases = groups["cases"];
    describe(case_columns(), cases);
    describe(outcome_columns(), cases);
    cases.push_back(integer("trace_begin", "first row in `/trace`"));
    cases.push_back(integer("trace_end", "the row after the last; equal to `trace_begin` where there is none"));
    cases.push_back({{"name", "counter_*"},
                     {"type", "count"},
                     {"width", 1},
                     {"meaning", "work counters of one solve"},
                     {"default", 0},
                     {"identity", false}});
    describe(check_columns(), cases);
    for (const char* name : {"answers", "repeats", "preparation", "fields"})
        groups[name].push_back(integer("case", "row of `/cases`"));
    describe(answer_columns(), groups["answers"]);
    describe(repeat_columns(), groups["repeats"]);
    describe(preparation_columns(), groups["preparation"]);
    describe(trace_columns(), groups["trace"]);
    describe(field_columns(), groups["fields"]);
    describe(ledger_columns(), groups["ledger"]);
    return groups;
}

}  // namespace hausbench
