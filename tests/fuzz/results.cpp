// Reads changed result files with a valid seal (a hash of the file at its end). The bytes choose which
// columns of a small file are missing or have another type, length or other values. If the first byte
// is 255, the other bytes are the file without its seal.
#include "datasets/hdf5.h"
#include "harness/result/result_file.h"
#include "tests/fuzz/target.h"
#include "tests/support/seal.h"
#include "tests/support/temporary_folder.h"

#include <bit>
#include <fstream>
#include <limits>
#include <variant>
#include <vector>

namespace hausbench::fuzz {
namespace {

using Column = std::variant<std::vector<std::string>, std::vector<std::int64_t>, std::vector<double>>;

Row row(int number) {
    Row made;
    made.spec.solver = made.spec.label = "guthe";
    made.spec.options = {{"split", std::string("midpoint")}, {"certify", true}};
    made.spec.scene = "scene", made.spec.source = "a", made.spec.target = "b";
    made.spec.pose_index = number;
    Outcome& outcome = made.outcome;
    outcome.status = number == 0 ? RowStatus::ok : RowStatus::timeout;
    outcome.bounds = {1, 2};
    outcome.extras = {{"share", 0.5}};
    outcome.facts = {{"why", "so"}};
    outcome.repeats = {{0, 1, 1, 1}, {0, 2, 2, 1}};
    outcome.answers = {{0, 1, 1, 1}};
    outcome.preparation = {{0, "octree", 1, 100, 0}};
    outcome.trace = {{}, {}};
    if (number == 0)
        made.fields = {{"upper", Field::Of::elements, Field::Meaning::upper, {1, 2, 3}},
                       {"distance", Field::Of::vertices, Field::Meaning::lower, {0, 0}}};
    return made;
}

ResultFile small_result() {
    ResultFile result;
    for (const char* name :
         {"stem",    "title", "paper",          "profile",  "experiment_toml", "started",           "finished",
          "commit",  "dirty", "build",          "compiler", "flags",           "build_type",        "libraries",
          "machine", "cpu",   "caches",         "kernel",   "system",          "hausbench_version", "plugins",
          "titles",  "shard", "experiment_file"})
        result.texts[name] = "text";
    result.integers = {{"cores", 2}, {"memory_bytes", 1000}};
    for (const char* name : {"a", "b"}) {
        ModelRecord model;
        model.name = name, model.sha256 = std::string("hash of ") + name, model.kind = "mesh";
        result.models.push_back(model);
    }
    result.rows = {row(0), row(1)};
    result.ledger = {{"not_run", "cgal", "case", "because"}};
    return result;
}

void read_all(const h5::File& file, const std::string& group, std::map<std::string, Column>& columns) {
    for (const std::string& child : file.children(group)) {
        const std::string name = group.empty() ? child : group + "/" + child;
        const auto take = [&](auto values) { columns[name] = std::move(values); };
        try {
            take(file.read_texts(name));
            continue;
        } catch (const std::exception&) {  // another type, or a group
        }
        try {
            take(file.read_integers(name));
            continue;
        } catch (const std::exception&) {
        }
        try {
            take(file.read_doubles(name));
            continue;
        } catch (const std::exception&) {
        }
        if (name != "meta") read_all(file, name, columns);
    }
}

std::map<std::string, Column> template_columns() {
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "small.h5";
    write_result(file, small_result());
    expect(read_result(file).rows.size() == 2, "the file that is changed cannot be read");
    std::map<std::string, Column> columns;
    read_all(h5::File(file, h5::Open::read), "", columns);
    expect(columns.size() > 100, "the file that is changed lacks columns");
    return columns;
}

std::int64_t integer(Bytes& in) {
    switch (in.below(4)) {
        case 0:
            return in.next<std::int64_t>();
        case 1:
            return std::int64_t{1} << in.below(63);
        default:
            return in.next<std::int8_t>();
    }
}

double real(Bytes& in) {
    switch (in.below(4)) {
        case 0:
            return std::numeric_limits<double>::quiet_NaN();
        case 1:
            return -std::numeric_limits<double>::infinity();
        case 2:
            return std::bit_cast<double>(in.next<std::uint64_t>());
        default:
            return in.next<std::int8_t>();
    }
}

void change_values(Column& column, Bytes& in) {
    if (auto* texts = std::get_if<std::vector<std::string>>(&column)) {
        for (std::string& text : *texts)
            if (in.below(2)) text = in.text(in.below(64));
    } else if (auto* integers = std::get_if<std::vector<std::int64_t>>(&column)) {
        for (std::int64_t& value : *integers)
            if (in.below(2)) value = integer(in);
    } else {
        for (double& value : std::get<std::vector<double>>(column))
            if (in.below(2)) value = real(in);
    }
}

void change(std::map<std::string, Column>& columns, Bytes& in) {
    if (columns.empty()) return;
    const auto at = std::next(columns.begin(), static_cast<std::ptrdiff_t>(in.next<std::uint16_t>() % columns.size()));
    Column& column = at->second;
    const std::uint32_t what = in.below(8), count = what < 5 ? in.below(9) : 0;
    switch (what) {
        case 0:
            columns.erase(at);
            return;
        case 1:
            std::visit([&](auto& values) { values.resize(count); }, column);
            return;
        case 2:
            column = std::vector<std::string>(count, std::string(in.text(in.below(20))));
            return;
        case 3:
            column = std::vector<std::int64_t>(count, integer(in));
            return;
        case 4:
            column = std::vector<double>(count, real(in));
            return;
        default:
            change_values(column, in);
    }
}

// Writes the changed file and returns how many values its fields have.
std::size_t write_changed(const std::filesystem::path& path, Bytes& in) {
    static const std::map<std::string, Column> original = template_columns();
    static const ResultFile meta = small_result();
    std::map<std::string, Column> columns = original;
    const std::uint32_t schema = in.byte();
    for (int i = 0; i < 6 && !in.empty(); ++i) change(columns, in);
    h5::File out(path, h5::Open::create);
    out.attribute("meta", "schema_version", schema < 4 ? schema : result_schema);
    for (const auto& [name, value] : meta.texts) out.attribute("meta", name, value);
    for (const auto& [name, value] : meta.integers) out.attribute("meta", name, value);
    for (const auto& [name, column] : columns)
        std::visit([&, &path_of = name](const auto& values) { out.write(path_of, values); }, column);
    out.close();
    const auto values = columns.find("fields/values");
    return values == columns.end() ? 0 : std::visit([](const auto& all) { return all.size(); }, values->second);
}

void results(std::string_view bytes) {
    Bytes in(bytes);
    const bool whole = !bytes.empty() && bytes[0] == '\xff';
    static const TemporaryFolder folder;  // not a MemoryFile, because HDF5 resolves paths
    const std::filesystem::path file = folder.path() / "changed.h5";
    if (whole) std::ofstream(file, std::ios::binary) << sealed(bytes.substr(1));
    std::size_t values = bytes.size();
    if (!whole) {
        try {
            values = write_changed(file, in);
        } catch (const std::runtime_error&) {  // HDF5 cannot write a text in this file
            return;
        }
    }
    try {
        const ResultFile result = read_result(file);
        std::size_t held = 0;
        for (const Row& row : result.rows) {
            expect(static_cast<int>(row.outcome.status) < count_of<RowStatus>, "a status that is none");
            for (const Field& field : row.fields) held += field.values.size();
        }
        expect(held <= values, "more values of fields than the file holds");
    } catch (const InputError& error) {
        expect_one_line(error);
    }
}

}  // namespace
}  // namespace hausbench::fuzz

HAUSBENCH_FUZZ_TARGET(results)
